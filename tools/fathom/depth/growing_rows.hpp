// SPDX-License-Identifier: Apache-2.0
// What is known of a map of depth while its frames are taken, in letters.
#pragma once

#include <string>
#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::cli {

using mapping::CurveGrid;

/// Where each block of the picture has been sharpest until now: rows of digits, 0 for the first frames
/// that most blocks are sharpest in and 9 for the last ones, a point where no frame stands out. At
/// most `columns` wide and `rows` high; blocks are twice as high as wide, as letters are.
std::vector<std::string> growing_rows(const CurveGrid& curves, int columns, int rows);

/// The same digits, each in its colour of viridis.
std::string coloured_digits(const std::string& digits);

}  // namespace fathom::cli
