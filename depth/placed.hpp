// SPDX-License-Identifier: Apache-2.0
// A picture brought to where another one lies.
#pragma once

#include "../engine/colours.hpp"
#include "../engine/frame.hpp"
#include "similarity.hpp"

namespace fathom::depth {

struct Point {
  double x, y;
};
/// Where a pixel of the reference lies in the other picture, both of this size.
Point place_of(const Similarity& place, double x, double y, int width_px, int height_px);

struct Placed {
  Frame grey;
  Colours colours;
};

/// The picture that the reference's pixels show: pixel p is what stands at place(p), by cubic
/// convolution (Keys 1981, a = -1/2), which keeps texture sharp. Beyond the edge its pixels repeat.
/// Where there are colours, grey is their luma.
Placed placed(const Frame& grey, const Colours& colours, const Similarity& place);

}  // namespace fathom::depth
