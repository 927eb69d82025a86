// SPDX-License-Identifier: Apache-2.0
// What is in a picture beside light that differs from side to side, and how much of it another one
// explains.
#pragma once

#include <vector>

#include "resemblance.hpp"

namespace fathom {

/// Without its mean: sums of it need fewer digits. An empty one stays so.
Patch centred(Patch patch);

/// What is beside a plane of light in a picture.
class PatchRelief {
 public:
  /// An empty one is explained by nothing.
  explicit PatchRelief(const Patch& patch);

  /// The part 0..1 of its variance that another picture, times a factor, and a plane of light leave.
  /// The pixel (x, y) of `other` lies on the first one of this; 1 where either is flat, or they are
  /// opposites. other: large enough, and best centred().
  double left_by(const Patch& other, int x, int y) const;

 private:
  /// Over pixels of another picture: of this relief times it, and of it, with places and squared.
  struct Sums {
    double ab = 0, b = 0, bx = 0, by = 0, bb = 0;
  };

  Sums sums_of(const Patch& other, int from_x, int from_y) const;
  double count() const { return static_cast<double>(relief_.size()); }
  double xx() const;
  double yy() const;

  int width_, height_;
  std::vector<float> relief_;  ///< Pixel by pixel.
  std::vector<float> places_;  ///< Of the pixels of a row, from its middle.
  double squares_ = 0;
};

}  // namespace fathom
