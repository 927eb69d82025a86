// SPDX-License-Identifier: Apache-2.0
// A peak of known shape that moves: where it is, and how fast, from scores taken one after the
// other.
//
// Nobody can look at two places at once. Where the target moves, the scores of one curve belong to
// several, and a shape fitted through them lies somewhere between. So position and speed are
// estimated together, each score at its own time.
#pragma once

#include <span>

namespace fathom {

/// A score, where and when.
struct Sighting {
  double position = 0;
  double score = 0;
  double time_s = 0;  ///< Middle of the exposure, on any clock.
};

/// What is known of the peak beforehand.
struct PeakTemplate {
  double floor = 0;        ///< Score far from the peak.
  double height = 0;       ///< Of its top above the floor,
  double height_part = 0;  ///< and how well that is known, as a part of it.
  double half_width = 0;   ///< At half its height,
  double width_part = 0;   ///< and how well that is known, as a part of it.
  double noise = 0;        ///< Standard deviation of a score.
};

/// Means and standard uncertainties of what the sightings leave possible.
struct MovingPeak {
  double time_s = 0;  ///< What position and speed belong to: the last sighting.
  double position = 0;
  double sigma = 0;
  double speed = 0;  ///< Position per second.
  double speed_sigma = 0;
  double height = 0;      ///< Of the likeliest,
  double half_width = 0;  ///< likewise,
  double misfit = 0;      ///< and the mean square of its residuals, in their sigmas.

  double position_at(double when_s) const { return position + speed * (when_s - time_s); }
};

/// The peak lies from low to high at the last sighting, and keeps its speed but for a tenth of it a
/// second. sightings: at least one, in the order of their times. Sums over a grid of positions,
/// speeds and widths, so two places that are both possible make sigma large.
MovingPeak locate(std::span<const Sighting> sightings, const PeakTemplate& peak, double low,
                  double high);

}  // namespace fathom
