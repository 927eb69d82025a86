// SPDX-License-Identifier: Apache-2.0
// Numbers that are no grey levels of 16 bits: signed, 32 bits, floating point.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fathom::pictures {

/// Each sample times `scale`, rounded. scale 0: as they are. Throws Error(bad_data), with the range
/// of the samples and the scale that would do, where a level lies outside of 0..65535 or is no
/// number, and, without a scale, where rounding would cost more than a part in 256. `name` stands
/// in the message. Sample: int16_t, int32_t, uint32_t, float or double.
template <class Sample>
std::vector<std::uint16_t> grey_levels(std::span<const Sample> samples, double scale,
                                       const std::string& name);

}  // namespace fathom::pictures
