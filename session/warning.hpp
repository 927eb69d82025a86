// SPDX-License-Identifier: Apache-2.0
// What a user should know of a measurement that goes on all the same. Values, not words: a command
// line, a page and a Python program each put them into words of their own.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "../hal/camera.hpp"
#include "../hal/finding.hpp"

namespace fathom {

/// Positions that were asked for, and that the lens takes elsewhere.
struct InexactPositions {
  /// One of them, in the lens's unit.
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

/// The light, or the camera's exposure or gain, changed while the lens moved.
struct LightChanged {
  double part;          ///< Between the brightest and the darkest picture, of their mean.
  bool is_even = true;  ///< Alike in the window and in the rest; else no score can be corrected.
};

/// The pictures far from focus are not equally noisy, as where a camera changes its gain.
struct NoiseChanged {
  double least, most;  ///< Standard deviations of the pixels' noise, grey values.
};

/// The parts of the window are not all sharp at one position: it shows a slope, or several things.
struct Receding {
  double from, to;  ///< Where the parts are sharpest.
  double spread;    ///< Standard deviation of that, which is in the answer's sigma.
  std::string unit;
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

/// The first pictures are too dark or too bright, or their brightness changes.
struct PoorLight {
  enum class Kind { dark, bright, flickering };
  Kind kind = Kind::dark;
  double part = 0;  ///< dark: mean grey value of full scale; bright: part of the window's pixels at
                    ///< the maximum; flickering: from darkest to brightest picture, of the mean.
  double exposure_ms = 0;  ///< Of the camera; 0 where it has none of its own.
};

/// The pictures do not defocus by the blur that the search was told of the lens.
struct BlurDoubted {
  double used;                 ///< px per unit of travel.
  std::optional<double> seen;  ///< What the pictures say, where they tell.
  bool was_misled = false;     ///< The search by spectra did not find the focus; another did.
  std::string unit;
};

/// Of a sweep without a halt: frames that were not scored, and places that were visited afterwards
/// because too few were.
struct FewOnTheWay {
  int unplaced = 0;  ///< Frames of which nobody knows well enough where the lens stood,
  int smeared = 0;   ///< and those within which it travelled too far.
  int visited = 0;   ///< Places that the frames had left out.
};

/// A search was asked to score frames of a lens on its way, and halts for every one instead.
struct HaltsInstead {
  enum class Why {
    unwatched,       ///< The lens cannot tell where it is on its way.
    not_by_spectra,  ///< Nobody knows how it blurs, or the window is too small to tell it.
    too_quick,       ///< The lens goes too far within a frame, or between two.
    unplaced,        ///< It did not say where it stood while frames were exposed.
  };
  Why why;
  std::string lens_says = {};  ///< unwatched: in its own words.
};

/// Besides these, what a driver noticed when it opened (hal/finding.hpp).
///
/// A new kind goes into this list; whoever visits it without an answer for that does not compile.
using Warning = std::variant<InexactPositions, StepTooFine, Saturation, LightChanged, NoiseChanged,
                             Receding, LostFrames, LensNote, LensNotReturned, PoorLight,
                             BlurDoubted, FewOnTheWay, HaltsInstead, Finding>;

}  // namespace fathom
