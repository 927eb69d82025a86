// SPDX-License-Identifier: Apache-2.0
// What fathom depth made of a stack, before it is written and shown.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "depth/mapper.hpp"
#include "depth/sharp.hpp"

namespace fathom::mapping {

inline constexpr std::size_t kDepthClasses = 6;
/// Of every DepthClass, in their order.
inline constexpr std::array<DepthClass, kDepthClasses> kAllDepthClasses = {
    DepthClass::known,      DepthClass::filled, DepthClass::no_texture,
    DepthClass::two_depths, DepthClass::at_end, DepthClass::outside};

/// Focus curves of a coarse grid of places, for those who look.
struct CurveGrid {
  int columns = 0, rows = 0;
  std::vector<std::vector<float>> frames;  ///< [frame][row * columns + column]; energy of detail.
};

struct DepthResult {
  DepthMaps maps;  ///< In `unit`.
  Sharp sharp;
  CurveGrid curves;
  std::vector<double> positions;  ///< Of the frames that were seen, in the lens's unit, as added.
  std::vector<Seen> seen;         ///< How each of them lies on the first one.
  std::string lens_unit;          ///< Of positions.
  std::string unit;               ///< Of the maps: the lens's, or mm.
  std::optional<BlurModel> blur;  ///< That the map was made with.
  std::string rig;                ///< Its text.
  std::optional<double> spacing_um;  ///< From one frame to the next, where both are known.

  bool is_metric() const { return unit == "mm"; }
  std::size_t pixels() const { return maps.classes.size(); }
};

/// How a map is spread: its class counts, and between which depths most of it lies.
struct DepthSummary {
  std::array<std::size_t, kDepthClasses> counts = {};  ///< Pixels, by DepthClass.
  double low = 0, high = 0;  ///< 2 % and 98 % of the depths that are numbers.
  double nearest = 0, farthest = 0;
  double median_sigma = 0;
  std::size_t numbers = 0;  ///< Pixels that have a depth.

  double part(DepthClass value, std::size_t pixels) const {
    return static_cast<double>(counts[static_cast<std::size_t>(value)]) /
           static_cast<double>(pixels);
  }
};
DepthSummary summary_of(const DepthMaps& maps);

/// Turns positions into distances: mm, with the calibration's own uncertainty in sigma. What the
/// calibration does not cover becomes `outside`.
void make_metric(DepthMaps& maps, const Calibration& calibration);

}  // namespace fathom::mapping
