// SPDX-License-Identifier: Apache-2.0
// Calibrations and the points that they are fitted to.
#include "calibration/calibration.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::accepted([&] { parse_calibration_points(text, "points.csv"); });
  fuzz::accepted([&] {
    const Calibration calibration = Calibration::parse(text, "c.json");
    const std::string json = calibration.json();
    fuzz::require(Calibration::parse(json, "c.json").json() == json,
                  "a calibration comes back as it was");
  });
  return 0;
}
