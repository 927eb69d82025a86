// SPDX-License-Identifier: Apache-2.0
// fathom_honesty: random searches of many kinds, and whether what they say is true.
//   fathom_honesty [--runs N] [--seed N] [--kind PART] [--metric TEXT] [--search NAME]
//                  [--moving | --halting] [--stays] [--list] [--check]
// --moving takes pictures while the lens travels, of rigs that can; --stays leaves the lens at the
// focus, as `fathom focus` does, where it goes back otherwise, as for `fathom range`; --list prints every run; --check ends with 1 where an answer is wrong that pictures could have
// told, or where errors are far from their sigmas.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/honesty/kinds.hpp"
#include "session/session.hpp"

namespace fathom::honesty {
namespace {

struct Wishes {
  int runs = 300;
  unsigned seed = 1;
  std::string kind, metric;
  std::optional<SearchMethod> search;
  std::optional<bool> moving;  ///< While the lens travels, or with halts; else as it comes.
  bool stays = false;          ///< At the focus, as `fathom focus` leaves it.
  bool list = false;
  bool check = false;
};

struct Tally {
  int runs = 0, focused = 0, wrong = 0, declined = 0, beyond = 0;
  double squares = 0;
  double worst_confidence = 0;
  std::vector<double> sigmas, errors, ratios;
  std::size_t evaluations = 0;
};

void add(Tally& tally, const Focus& focus, const Scene& scene, const Wishes& wishes) {
  ++tally.runs;
  tally.evaluations += focus.evaluations.size();
  const auto truth = scene.truth();
  const bool is_focused = focus.result() == FocusResult::focused;
  const double error = truth ? focus.position() - *truth : INFINITY;
  if (wishes.list) {
    if (!focus.evaluations.empty())
      fmt::print("sat {:.3f} sp {:.2f} ", best_of(focus.evaluations).picture.saturated,
                 focus.depths.spread);
    fmt::print("{:6.1f} {} {}pts r2 {:.4f} hw {:.2f} ", error / focus.peak.sigma,
               to_string(focus.peak.shape), focus.peak.points, focus.peak.r_squared,
               focus.peak.half_width);
    if (const auto& look = focus.first_look)
      fmt::print("look {:.2f} {:.2f} {:.4f} {:.2f} {:.2f} ", look->foretold_px, look->seen_px,
                 look->unexplained, look->evidence, look->evidence_beside);
    if (const auto& fit = focus.spectral; fit && truth && !focus.lobes.empty())
      fmt::print("by scores {:.2f} +- {:.2f} by spectra {:.2f} +- {:.2f} misfit {:.2f} ",
                 focus.lobes[0].position - *truth, focus.lobes[0].sigma, fit->position - *truth,
                 fit->sigma, fit->misfit);
    fmt::print("{} {}: {} {:.4f} +- {:.4f} true {:.4f} confidence {:.2f} {}\n", scene.text,
               scene.metric, to_string(focus.result()), focus.position(), focus.peak.sigma,
               truth.value_or(NAN), focus.verdict.confidence, to_string(focus.verdict.reason.why));
  }
  if (!is_focused) return void(++tally.declined);
  ++tally.focused;
  if (std::abs(error) > scene.wrong) {
    ++tally.wrong;
    tally.worst_confidence = std::max(tally.worst_confidence, focus.verdict.confidence);
  }
  if (!truth) return;
  const double ratio = error / focus.peak.sigma;
  tally.squares += ratio * ratio;
  tally.beyond += std::abs(ratio) > 4 ? 1 : 0;
  tally.ratios.push_back(std::abs(ratio));
  tally.sigmas.push_back(focus.peak.sigma);
  tally.errors.push_back(std::abs(error));
}

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Tally run(const Kind& kind, const std::string& metric, const Wishes& wishes) {
  Tally tally;
  std::mt19937 random(wishes.seed);
  for (int i = 0; i < wishes.runs; ++i) {
    Scene scene = kind.make(random, metric);
    RigOptions options;
    options.rig = scene.text;
    options.metric = scene.metric;
    options.window = scene.window;
    Rig rig(options, std::move(scene.hardware));
    Observer nobody;
    FocusRequest request = scene.request;
    request.returns = !wishes.stays;
    request.moving = wishes.moving;
    if (wishes.search) request.search = *wishes.search;
    add(tally, *Session(rig).focus(request, nobody).focus, scene, wishes);
  }
  return tally;
}

void print(const Kind& kind, const std::string& metric, const Tally& t) {
  const double counted = static_cast<double>(t.ratios.size());
  fmt::print("{:34} {:28} {:5} {:7} {:8} {:6} {:6.2f}", kind.name, metric, t.runs, t.focused,
             t.declined, t.wrong, t.worst_confidence);
  if (kind.judges_sigma) {
    fmt::print(" {:8.2f} {:8.1f} % {:10.4g} {:10.4g}", std::sqrt(t.squares / counted),
               100 * t.beyond / counted, median(t.errors), median(t.sigmas));
  }
  fmt::print("  {:.1f}\n", static_cast<double>(t.evaluations) / t.runs);
  std::fflush(stdout);
}

[[noreturn]] void refuse(const std::string& what) {
  fmt::print(
      stderr,
      "fathom_honesty: {}\nusage: fathom_honesty [--runs N] [--seed N] [--kind PART] "
      "[--metric TEXT] [--search NAME] [--moving | --halting] [--stays] [--list] [--check]\n",
      what);
  std::exit(2);
}

unsigned whole(const std::string& name, std::string_view text) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end) refuse(name + " takes a whole number");
  return value;
}

bool is_kind(const std::string& part) {
  return std::any_of(kinds().begin(), kinds().end(), [&](const Kind& kind) {
    return std::string(kind.name).find(part) != std::string::npos;
  });
}

/// Takes an option that has a value.
void take(Wishes& wishes, const std::string& name, const std::string& value) {
  if (name == "--runs") {
    wishes.runs = static_cast<int>(whole(name, value));
  } else if (name == "--seed") {
    wishes.seed = whole(name, value);
  } else if (name == "--kind") {
    if (!is_kind(value)) refuse("there is no kind \"" + value + "\"");
    wishes.kind = value;
  } else if (name == "--metric") {
    wishes.metric = value;
  } else if (name == "--search") {
    wishes.search = parse_search_method(value);
  } else {
    refuse("there is no option " + name);
  }
}

Wishes wishes_of(int count, char** arguments) {
  Wishes wishes;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    if (name == "--list") {
      wishes.list = true;
    } else if (name == "--check") {
      wishes.check = true;
    } else if (name == "--moving" || name == "--halting") {
      wishes.moving = name == "--moving";
    } else if (name == "--stays") {
      wishes.stays = true;
    } else {
      take(wishes, name, i + 1 < count ? arguments[++i] : "");
    }
  }
  return wishes;
}

/// Few runs tell an rms roughly: bounds are wide.
bool is_true(const Kind& kind, const Tally& tally) {
  constexpr std::size_t kEnough = 15;
  constexpr double kBoasts = 2;
  if (kind.is_told && tally.wrong > 0 && tally.worst_confidence >= kind.passes_below) return false;
  if (!kind.judges_sigma || tally.ratios.size() < kEnough) return true;
  return std::sqrt(tally.squares / static_cast<double>(tally.ratios.size())) < kBoasts;
}

int measure(const Wishes& wishes) {
  fmt::print("{:34} {:28} {:>5} {:>7} {:>8} {:>6} {:>6} {:>8} {:>10} {:>10} {:>10}  {}\n", "kind",
             "metric", "runs", "focused", "declined", "wrong", "conf.", "err/sig", "> 4 sigma",
             "error", "sigma", "evaluations");
  bool all_true = true;
  std::vector<std::string> metrics = {"fft", "walsh-sequency"};
  if (!wishes.metric.empty()) metrics = {wishes.metric};
  for (const Kind& kind : kinds()) {
    if (std::string(kind.name).find(wishes.kind) == std::string::npos) continue;
    for (const std::string& metric : metrics) {
      const Tally tally = run(kind, metric, wishes);
      print(kind, metric, tally);
      all_true = all_true && is_true(kind, tally);
    }
  }
  return wishes.check && !all_true ? 1 : 0;
}

}  // namespace
}  // namespace fathom::honesty

int main(int count, char** arguments) {
  try {
    return fathom::honesty::measure(fathom::honesty::wishes_of(count, arguments));
  } catch (const std::exception& error) {
    fmt::print(stderr, "fathom_honesty: {}\n", error.what());
    return 1;
  }
}
