// SPDX-License-Identifier: Apache-2.0
// The profiles of profiles/, as bytes.
#include <iterator>

#include "hal/drivers/serial/profile.hpp"

namespace fathom::serial {
namespace {

constexpr char kGrbl[] = {
#include "grbl.toml.text"
};
constexpr char kMarlin[] = {
#include "marlin.toml.text"
};
constexpr char kZaber[] = {
#include "zaber.toml.text"
};
constexpr char kPi[] = {
#include "pi.toml.text"
};
constexpr char kAsi[] = {
#include "asi.toml.text"
};
constexpr char kPrior[] = {
#include "prior.toml.text"
};
constexpr char kMoonlite[] = {
#include "moonlite.toml.text"
};
constexpr char kSketch[] = {
#include "sketch.toml.text"
};

template <std::size_t kSize>
constexpr std::string_view text_of(const char (&bytes)[kSize]) {
  return {bytes, kSize};
}

}  // namespace

std::span<const KnownProfile> known_profiles() {
  static constexpr KnownProfile kProfiles[] = {
      {"grbl", text_of(kGrbl)},         {"marlin", text_of(kMarlin)},
      {"zaber", text_of(kZaber)},       {"pi", text_of(kPi)},
      {"asi", text_of(kAsi)},           {"prior", text_of(kPrior)},
      {"moonlite", text_of(kMoonlite)}, {"sketch", text_of(kSketch)},
  };
  return kProfiles;
}

}  // namespace fathom::serial
