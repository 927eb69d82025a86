// SPDX-License-Identifier: Apache-2.0
// The depth of parts of the picture that a user names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/window.hpp"
#include "mapping/depth_result.hpp"

namespace fathom::cli {

/// Reads windows, x,y,n a line (left column, top row, side, px). A line of words before the first is
/// a header; empty lines and those that begin with # are left out. Throws Error(bad_data), naming
/// the line, for anything else, and for a file without any.
std::vector<Window> parse_regions(std::string_view text, const std::string& name);

/// Throws Error(out_of_bounds) for a window over the edge of a picture of this size.
void require_inside(const std::vector<Window>& regions, int width_px, int height_px);

/// A CSV: x,y,n,position,sigma,verdict,known a line. position and sigma: the medians of what is
/// known; verdict: the class that most pixels have; known: the part that has a depth. A region of
/// which less than half is known has no position.
std::string regions_csv(const mapping::DepthResult& result, const std::vector<Window>& regions);

}  // namespace fathom::cli
