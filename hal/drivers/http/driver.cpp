// SPDX-License-Identifier: Apache-2.0
// The driver "http": the rig of a fathom serve, on this computer or another.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <memory>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/http/camera.hpp"
#include "hal/drivers/http/lens.hpp"

namespace fathom {
namespace {

using namespace http;

constexpr std::array<std::string_view, 2> kTrailingKeys{"timeout_s", "token"};

/// The environment keeps the token off the list of processes, and out of the files of runs.
std::string token_from(const RigSettings& settings, const std::string& of_address) {
  const char* const kept = std::getenv("FATHOM_TOKEN");
  const std::string usual = of_address.empty() && kept != nullptr ? kept : of_address;
  return settings.text("token", usual);
}

class HttpDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "http"; }

  const char* summary() const noexcept override {
    return "the rig of a running fathom serve: http://HOST:PORT?token=TOKEN (port 8470, token "
           "$FATHOM_TOKEN), timeout_s=S";
  }

  const char* bare_key() const noexcept override { return "url"; }
  std::span<const std::string_view> trailing_keys() const noexcept override {
    return kTrailingKeys;
  }

  /// Whoever serves on this computer wants a token for everything, so it tells no more of itself.
  std::vector<FoundHardware> find() const override {
    constexpr std::int64_t kLongest_ns = 500'000'000;
    const Place place{.address = {.host = "127.0.0.1", .port = kUsualPort}, .token = ""};
    try {
      Client client(place, "fathom");
      const Answer answer =
          client.ask({.path = "/api/v1/state"}, monotonic_now_ns() + kLongest_ns, never_stop);
      if (refusal_from(answer.body).code != "no_token") return {};
    } catch (const Error&) {  // nobody serves here
      return {};
    }
    return {{.text = fmt::format("http://{}", place.address.text()),
             .description = "the rig of a fathom serve on this computer",
             .has_camera = true,
             .has_lens = true,
             .problem = "needs the token that it printed: FATHOM_TOKEN, or ?token=TOKEN"}};
  }

  Hardware open(const RigSettings& settings, const OpenOptions& options) const override {
    constexpr double kSecond_ns = 1e9;
    Place place = parse_place(settings.text("url", "http://localhost"));
    place.token = token_from(settings, place.token);
    const double timeout_s = settings.number("timeout_s", 10, 0.1, 600);
    settings.require_all_used();
    const auto link = std::make_shared<Link>(
        LinkOptions{.place = place,
                    .timeout_ns = static_cast<std::int64_t>(timeout_s * kSecond_ns),
                    .is_pair = options.camera && options.lens,
                    .stop_requests = options.stop_requests});
    Hardware hardware;
    if (options.camera) hardware.camera = std::make_unique<HttpCamera>(link);
    if (options.lens) hardware.lens = std::make_unique<HttpLens>(link);
    if (options.lens && link->facts().has_stage) hardware.stage = std::make_unique<HttpStage>(link);
    return hardware;
  }
};

}  // namespace

const RigDriver& http_driver() {
  static const HttpDriver driver;
  return driver;
}

}  // namespace fathom
