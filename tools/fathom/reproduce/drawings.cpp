// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/drawings.hpp"

#include <string>

namespace fathom::reproduce {
namespace {

constexpr unsigned char kThinLens[] = {
#include "thin-lens.svg.text"
};
constexpr unsigned char kDepthOfField[] = {
#include "depth-of-field.svg.text"
};
constexpr unsigned char kMomentFourier[] = {
#include "moment-fourier.svg.text"
};
constexpr unsigned char kMomentWalsh[] = {
#include "moment-walsh.svg.text"
};
constexpr unsigned char kSearchIntervals[] = {
#include "search-intervals.svg.text"
};

template <std::size_t size>
std::string text_of(const unsigned char (&bytes)[size]) {
  return {bytes, bytes + size};
}

}  // namespace

Figure lens_drawings() {
  return {
      {{"figure-1", "a thin lens and the image that it makes", text_of(kThinLens)},
       {"figure-2", "the depth of field of a thin lens", text_of(kDepthOfField)}},
      "As the thesis' figures 1 and 2. Left: rays from one point of the object meet in one point "
      "behind the lens, at a distance that tells the object's. Right: what is nearer or farther "
      "meets elsewhere, and makes a disc of the sensor's plane, the circle of confusion."};
}

Figure moment_drawings() {
  return {
      {{"figure-6", "the moment of inertia of Fourier coefficients", text_of(kMomentFourier)},
       {"figure-7", "the moment of inertia of Walsh coefficients", text_of(kMomentWalsh)}},
      "As the thesis' figures 6 and 7. Each magnitude is a mass, its squared distance from zero "
      "frequency the lever arm. Half of the Fourier coefficients are counted, all of Walsh's."};
}

Figure search_drawing() {
  return {
      {{"figure-9", "the intervals of a golden section search", text_of(kSearchIntervals)}},
      "As the thesis' figure 9. The search knows three positions, 0, X and 1200, and scores one "
      "more in each interval; the best one and its two neighbours make the next interval."};
}

}  // namespace fathom::reproduce
