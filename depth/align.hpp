// SPDX-License-Identifier: Apache-2.0
// How the pictures of a stack lie on each other: the picture grows and shifts as a lens moves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "../engine/frame.hpp"
#include "similarity.hpp"

namespace fathom {

/// What of a movement is looked for.
enum class Alignment {
  none,
  scale,       ///< That the picture grows about its middle, one number.
  similarity,  ///< That it grows, turns and shifts.
};
/// "none", "scale", "similarity".
const char* to_string(Alignment alignment) noexcept;

/// How a picture grows by the thin lens whose way goes with its position: by
/// 1 + per_unit (position - that of the first frame).
struct GrowthLaw {
  double per_unit = 0;
  double sigma = 0;  ///< Standard uncertainty of that, above 0, before a picture was seen.
  std::vector<double> positions = {};  ///< Of the frames, as they will come.
};

/// Follows a stack from frame to frame, in one pass. The reference is the first frame.
///
/// Each frame is held against the one before it, reduced to some 800 px, coarse to fine (BandMatch).
/// With a law, what all pairs tell goes into its one number, and the law says where a frame lies.
class StackAligner {
 public:
  /// Frames must come in the order of their positions, so that neighbours look alike.
  /// law: of Alignment::scale; others have none.
  explicit StackAligner(Alignment alignment, std::optional<GrowthLaw> law = std::nullopt);
  ~StackAligner();
  StackAligner(StackAligner&&) noexcept;
  StackAligner& operator=(StackAligner&&) noexcept;

  /// Where the reference lies in this frame. What moves less than a quarter of a pixel at the
  /// corners stands still. Throws Error(bad_argument) for a frame of another size than the first.
  Similarity add(const Frame& grey);

  /// The law's number, as far as it is fitted by now; nothing without a law.
  std::optional<double> growth_per_unit() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fathom
