// SPDX-License-Identifier: Apache-2.0
// Pictures that single precision gets wrong if it is not careful: spectra that are nearly empty,
// where rounding has nothing to drown in, and faint contrast on bright ground.
#pragma once

#include <string>
#include <vector>

#include "tests/support/patterns.hpp"

namespace fathom::differential {

/// The kinds that draw() knows: those of test::contents() and the adversarial ones.
const std::vector<std::string>& picture_kinds();

/// Draws "KIND@N" or "KIND+KIND@N", the sum of two, clamped to the range of `bits`. N is the side
/// of the windows that will look at it, which waves have their periods and columns their places by.
/// Throws std::invalid_argument for a text that is none.
test::Pixels draw(const std::string& picture, int bits, int width, int height, std::uint64_t seed);

}  // namespace fathom::differential
