// SPDX-License-Identifier: Apache-2.0
// A manifest that was read is written and read back the same.
#include "hal/drivers/replay/manifest.hpp"

#include <cmath>

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  Manifest manifest;
  if (!fuzz::accepted([&] { manifest = parse_manifest(fuzz::text_of(data, size), "m.csv"); })) {
    return 0;
  }
  fuzz::require(!manifest.entries.empty(), "it lists something");
  const std::string text = manifest_text(manifest);
  const Manifest back = parse_manifest(text, "m.csv");
  fuzz::require(back.unit == manifest.unit, "the unit comes back");
  fuzz::require(back.coarse_spacing == manifest.coarse_spacing, "the spacing comes back");
  fuzz::require(back.entries.size() == manifest.entries.size(), "every entry comes back");
  for (std::size_t i = 0; i < back.entries.size(); ++i) {
    const ManifestEntry& a = manifest.entries[i];
    const ManifestEntry& b = back.entries[i];
    fuzz::require(std::isfinite(a.position), "positions are numbers");
    fuzz::require(a.file == b.file && a.position == b.position && a.page == b.page,
                  "an entry comes back as it was");
  }
  return 0;
}
