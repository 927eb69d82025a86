// SPDX-License-Identifier: Apache-2.0
// Rig texts and rig files, read without opening what they name.
#include "fuzz.hpp"
#include "hal/rig_text.hpp"

namespace {

/// Reads every value in every way: the getters are parsers too.
void read_values(const fathom::RigPart& part) {
  using fathom::fuzz::accepted;
  fathom::fuzz::require(part.driver != nullptr, "a part names a driver");
  for (const auto& entry : part.settings.values()) {
    const std::string& key = entry.first;
    accepted([&] {
      const double number = part.settings.number(key, 0, -1e6, 1e6);
      fathom::fuzz::require(number >= -1e6 && number <= 1e6, "numbers are within their limits");
    });
    accepted([&] { part.settings.integer(key, 0, -1000, 1000); });
    accepted([&] { part.settings.flag(key, false); });
  }
  part.settings.require_all_used();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::accepted([&] { read_values(parse_rig_options(text)); });
  fuzz::accepted([&] {
    const RigRequest request = parse_rig_file(text, "folder/rig.toml");
    read_values(request.camera);
    if (request.lens) read_values(*request.lens);
  });
  return 0;
}
