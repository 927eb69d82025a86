// SPDX-License-Identifier: Apache-2.0
// What a user should know of a measurement that goes on all the same. Values, not words: a command
// line, a page and a Python program each put them into words of their own.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "../hal/camera.hpp"

namespace fathom {

/// Positions that were asked for, and that the lens takes elsewhere.
struct InexactPositions {
  struct Place {
    double wanted;
    double nearest;
  };
  std::vector<Place> places;  ///< In the order in which they were asked for; at least one.
  std::string unit;           ///< Of the lens.
};

/// A sweep's step that the lens cannot make; each position that it has is taken once.
struct StepTooFine {
  double step;
  double resolution;
  std::string unit;
};

/// The window was too bright near the answer, so the peak may be off by more than it says.
struct Saturation {
  double part;      ///< Of the window's pixels at the maximum, 0..1.
  double position;  ///< Where that was measured.
};

/// The camera lost frames during a run. None of them was scored, but a cable or a bus may be at
/// fault.
struct LostFrames {
  FrameCounts during;  ///< The counts of this run alone.
};

/// The lens said something of a move, such as lost steps.
struct LensNote {
  double position;  ///< Where it was sent.
  std::string text;
};

/// The lens could not be put back to where it was found.
struct LensNotReturned {
  double position;  ///< Where it was found.
  std::string why;
};

/// A new kind goes into this list; whoever visits it without an answer for that does not compile.
using Warning =
    std::variant<InexactPositions, StepTooFine, Saturation, LostFrames, LensNote, LensNotReturned>;

}  // namespace fathom
