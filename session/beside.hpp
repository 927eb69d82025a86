// SPDX-License-Identifier: Apache-2.0
// A second picture to hold beside that of a peak: of a recording the neighbouring one, of a live
// camera what it saw when it looked again.
#pragma once

#include <optional>
#include <set>

#include "../focus/focus.hpp"
#include "../focus/resemblance.hpp"
#include "first_picture.hpp"
#include "observer.hpp"
#include "rig.hpp"

namespace fathom {

/// Compares two pictures of one size where the window is, or its surroundings if it is small: of a
/// large one the square with the most detail. Nothing where the pictures are too small, or one
/// tells nothing of the other (focus/resemblance.hpp).
std::optional<Resemblance> compare(const Frame& best, const Frame& other, const Window& window,
                                   int reach_px);

/// Compares the picture of a recording where the search found its best score with those beside it,
/// and leaves the lens where it was. The better of both sides; nothing where no picture can be
/// read. Throws Error(cancelled) as Rig::measure.
std::optional<Resemblance> compare_beside(Rig& rig, const Focus& focus);

/// Keeps the best picture of a live search until the camera has looked there again.
class TopKeeper final : public Observer {
 public:
  explicit TopKeeper(const Window& window) : window_(window) {}

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override;
  void evaluated(const Measurement& measurement) override;

  /// Of the best picture and the second look at its place; nothing before there was one.
  const std::optional<Resemblance>& resemblance() const { return resemblance_; }

  /// The best picture, and where it was taken; nothing before there was one.
  std::optional<PictureAt> best() const;
  /// The first one, or that which was taken beforehand.
  const std::optional<PictureAt>& first() const { return first_; }
  void begin_with(PictureAt first) { first_ = std::move(first); }
  /// Of all others that of the nearest place.
  const std::optional<PictureAt>& beside_first() const { return beside_first_; }

 private:
  void keep_for_first(double position);

  Window window_;
  Frame latest_, best_;
  std::optional<PictureAt> first_, beside_first_;
  double position_ = 0, score_ = -1;  ///< Of the best.
  std::set<double> seen_;             ///< Every position so far.
  std::optional<Resemblance> resemblance_;
};

}  // namespace fathom
