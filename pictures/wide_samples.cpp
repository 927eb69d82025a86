// SPDX-License-Identifier: Apache-2.0
#include "pictures/wide_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "engine/error.hpp"

namespace fathom::pictures {
namespace {

constexpr double kHighestLevel = 65535;

struct Range {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  bool has_nan = false;
  bool is_whole = true;  // no sample has a fraction
};

template <class Sample>
Range range_of(std::span<const Sample> samples) {
  Range range;
  for (const Sample sample : samples) {
    const auto value = static_cast<double>(sample);
    if (std::isnan(value)) {
      range.has_nan = true;
      continue;
    }
    range.lowest = std::min(range.lowest, value);
    range.highest = std::max(range.highest, value);
    range.is_whole = range.is_whole && value == std::floor(value);
  }
  return range;
}

/// The scale that people would take: of 1, or else of the next power of two, so that the other
/// pictures of a stack fit too.
double fitting_scale(const Range& range) {
  const double whole = std::exp2(std::max(0.0, std::ceil(std::log2(range.highest))));
  return kHighestLevel / whole;
}

[[noreturn]] void refuse(const std::string& name, const Range& range, double scale,
                         std::string_view why) {
  const std::string factor = scale > 0 ? fmt::format(" (times scale={:g})", scale) : "";
  const bool can_be_scaled =
      !range.has_nan && range.lowest >= 0 && range.highest > 0 && std::isfinite(range.highest);
  const std::string advice =
      can_be_scaled ? fmt::format("read it with a scale: scale={0:.6g}, or --scale {0:.6g}",
                                  fitting_scale(range))
                    : std::string("save it as 8- or 16-bit grey");
  throw Error(ErrorCode::bad_data,
              fmt::format("{} holds samples from {:g} to {:g}{}{}; {}; {}", name, range.lowest,
                          range.highest, range.has_nan ? " and some that are no numbers" : "",
                          factor, why, advice));
}

}  // namespace

template <class Sample>
std::vector<std::uint16_t> grey_levels(std::span<const Sample> samples, double scale,
                                       const std::string& name) {
  constexpr double kFewestLevels = 256;
  const Range range = range_of(samples);
  const double factor = scale > 0 ? scale : 1;
  const bool fits =
      !range.has_nan && range.lowest * factor >= 0 && range.highest * factor < kHighestLevel + 0.5;
  if (!fits) refuse(name, range, scale, "grey levels are 0 to 65535");
  const bool is_coarse = !range.is_whole && range.highest < kFewestLevels;
  if (scale == 0 && is_coarse)
    refuse(name, range, scale, "as whole grey levels they would lose what they show");
  std::vector<std::uint16_t> levels(samples.size());
  std::transform(samples.begin(), samples.end(), levels.begin(), [factor](Sample sample) {
    return static_cast<std::uint16_t>(std::lround(static_cast<double>(sample) * factor));
  });
  return levels;
}

template std::vector<std::uint16_t> grey_levels(std::span<const std::int16_t>, double,
                                                const std::string&);
template std::vector<std::uint16_t> grey_levels(std::span<const std::int32_t>, double,
                                                const std::string&);
template std::vector<std::uint16_t> grey_levels(std::span<const std::uint32_t>, double,
                                                const std::string&);
template std::vector<std::uint16_t> grey_levels(std::span<const float>, double, const std::string&);
template std::vector<std::uint16_t> grey_levels(std::span<const double>, double,
                                                const std::string&);

}  // namespace fathom::pictures
