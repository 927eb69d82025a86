// SPDX-License-Identifier: Apache-2.0
// How often noise alone would tell as much as a window tells. Noise of cameras and of their compression
// has many shapes, so it is asked of the stack itself: with its frames in disorder it has the same
// noise, and no focus.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "depth/cascade.hpp"

namespace fathom::depth {

/// Where nothing is there but noise, each order of the frames is the one that tells most equally often.
/// So those places tell how many are noise where one of the disorders tells most (Barber and Candes,
/// Controlling the false discovery rate via knockoffs, 2015).
class Chance {
 public:
  /// disorders: how many a place is compared with.
  explicit Chance(int disorders) : share_(1 / static_cast<float>(disorders)) {}

  /// A place that tells so much, and so much in the disorder that tells most. weights: the part of a
  /// place that is its own, because nearby places share what they tell.
  void add(float told, float weight, float in_disorder, float weight_in_disorder);
  /// After the last one.
  void settle();

  /// The part of the places which tell so much that is noise, 0 to 1. 0 where nothing was added.
  float of(float told) const;

 private:
  static constexpr std::size_t kBins = 48;
  static std::size_t bin_of(float told);

  float share_;
  using Counts = std::array<float, kBins>;
  Counts ordered_{}, disordered_{}, part_{};
};

/// What Cascade needs to be made again.
struct CascadeOf {
  const Scoring& scoring;
  std::span<const std::size_t> frames;
  std::span<const double> positions;
  const StackBlur& blur;
  const FocusGrid& grid;
  const Ends& ends;
};

/// Takes away what may be noise: confidence becomes less by it, and a peak that is as likely noise has
/// no texture. Of few frames disorder is no other order, and nothing is taken away. Looks at all of
/// a small picture, and at a sample of the rows of a large one.
void doubt_noise(const CascadeOf& of, Nodes& nodes, int threads);

}  // namespace fathom::depth
