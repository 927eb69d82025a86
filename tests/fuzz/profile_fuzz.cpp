// SPDX-License-Identifier: Apache-2.0
// Profiles of devices on a serial port.
#include "fuzz.hpp"
#include "hal/drivers/serial/profile.hpp"

namespace {

using namespace fathom;

void read(std::string_view text) {
  fuzz::accepted([&] {
    const serial::Variables variables = serial::variables_of(text, "p.toml");
    const serial::Profile profile = serial::read_profile(text, "p.toml", variables);
    fuzz::require(profile.move.text({1.5e9, -3}).size() < 70'000, "a command is no book");
    fuzz::require(profile.state.has_value() != profile.arrive.has_value(), "one of the two");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read(fathom::fuzz::text_of(data, size));
  return 0;
}
