// SPDX-License-Identifier: Apache-2.0
#include "session/blur_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <system_error>

#include "calibration/blur_json.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/json.hpp"
#include "focus/blur_fit.hpp"
#include "focus/spectral_verdict.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-blur";
constexpr int kVersion = 1;
constexpr std::uintmax_t kLargest = 1 << 16;

/// Keys of rig texts that do not change how a lens blurs.
constexpr std::string_view kOfTheScene[] = {"target", "distance",    "speed",   "seed",  "noise",
                                            "drift",  "exposure_ms", "gain",    "start", "rate",
                                            "lose",   "settle_ms",   "backlash"};

bool is_of_the_scene(std::string_view option) {
  const std::string_view key = option.substr(0, option.find('='));
  return std::find(std::begin(kOfTheScene), std::end(kOfTheScene), key) != std::end(kOfTheScene);
}

/// "sim:target=usaf,fnumber=8" is "sim:fnumber=8".
std::string lasting_part(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::string(text);
  std::string lasting(text.substr(0, colon));
  for (std::size_t at = colon + 1; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view option = text.substr(at, end - at);
    if (!is_of_the_scene(option)) lasting += "," + std::string(option);
    at = end + 1;
  }
  return lasting;
}

/// A rig file by its place, whatever folder it is named from.
std::string named(const std::string& rig) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(rig, ignored)) return lasting_part(rig);
  const std::filesystem::path whole = std::filesystem::weakly_canonical(rig, ignored);
  return whole.empty() ? rig : whole.string();
}

/// FNV-1a, 64 bits: a name for a file; the key stands in it.
std::uint64_t digest_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3U;
  }
  return hash;
}

double half_width_of(const Focus& focus) {
  return focus.lobes.empty() ? 0 : focus.lobes[0].half_width;
}

/// Whether a sweep, which nobody has judged, has its peak where the focus was fitted: far above both
/// of its ends.
bool is_sharpest(std::span<const Evaluation> evaluations, const BlurFit& fit) {
  constexpr double kNearPx = 3, kAboveEnds = 1.3;
  const auto [low, high] = std::minmax_element(
      evaluations.begin(), evaluations.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  const Evaluation& best = best_of(evaluations);
  const double away = std::abs(best.position - fit.position);
  return away * fit.model.px_per_unit < kNearPx &&
         best.score > kAboveEnds * std::max(low->score, high->score);
}

LearnedBlur parsed(const std::string& text, const std::string& key) {
  const Json json = parse_json(text);
  if (json.at("format") != kFormat || json.at("version") != kVersion)
    throw Error(ErrorCode::bad_data, "it is no blur of this version");
  if (json.at("rig") != key) throw Error(ErrorCode::bad_data, "it is of another rig");
  return {.model = blur_from(json.at("blur")),
          .pictures = whole_from<int>(json.at("pictures")),
          .learned = json.at("learned")};
}

}  // namespace

std::optional<LearnedBlur> blur_of(const Run& run) {
  BlurFitOptions options;
  if (run.focus) {
    if (run.focus->result() != FocusResult::focused) return std::nullopt;
    options.focus = run.focus->position();
  }
  const std::vector<Evaluation> all = run.focus ? run.evaluations_at_rest() : run.evaluations();
  const auto fit = fit_blur(all, options);
  if (!fit ||
      !(run.focus ? could_make(half_width_of(*run.focus), fit->model) : is_sharpest(all, *fit)))
    return std::nullopt;
  return LearnedBlur{.model = fit->model, .pictures = fit->pictures, .learned = {}};
}

std::optional<LearnedBlur> blur_of(std::span<const Run> runs) {
  std::optional<LearnedBlur> best;
  for (const Run& run : runs) {
    const auto one = blur_of(run);
    if (one && (!best || one->model.uncertainty < best->model.uncertainty)) best = one;
  }
  return best;
}

std::string blur_key(Rig& rig) {
  const CameraSettings picture = rig.camera().settings();
  return fmt::format("{}; {} x {} px; {}", named(rig.options().rig), picture.width_px,
                     picture.height_px, rig.lens().info().unit);
}

std::filesystem::path BlurStore::path_of(const std::string& key) const {
  return folder_ / fmt::format("{:016x}.json", digest_of(key));
}

std::optional<LearnedBlur> BlurStore::find(const std::string& key) const {
  const std::filesystem::path path = path_of(key);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  try {
    return parsed(read_file(path, kLargest), key);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is damaged", path.string()));
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", path.string(), error.what()));
  }
}

void BlurStore::keep(const std::string& key, const LearnedBlur& blur) const {
  const Json json = {
      {"format", kFormat},       {"version", kVersion},       {"rig", key},
      {"learned", blur.learned}, {"pictures", blur.pictures}, {"blur", to_json(blur.model)}};
  write_file(path_of(key), json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace fathom
