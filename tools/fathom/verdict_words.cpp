// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/verdict_words.hpp"

#include <fmt/format.h>

namespace fathom::cli {

std::string words_for(const Verdict& verdict) {
  const Reason& reason = verdict.reason;
  switch (reason.why) {
    case Why::unknown:
      return "no reason was kept";
    case Why::stands_out:
      return fmt::format("the peak stands {:.0f} times the noise above the floor",
                         verdict.rise.rise);
    case Why::dead_pictures:
      return fmt::format(
          "{} of {} pictures are black or saturated, so there is no floor to judge a focus by; "
          "set the exposure",
          reason.dead, reason.evaluations);
    case Why::one_position:
      return "one position alone tells of no peak; try a wider --from, --to or --bracket";
    case Why::all_alike:
      return "every position has the very same score; does the lens move, does the camera send "
             "fresh pictures, and is the window neither black nor saturated?";
    case Why::too_wild:
      return "so few coefficients scatter too much to judge a focus by; use a larger window or a "
             "wider band";
    case Why::within_noise:
      return fmt::format(
          "the scores rise by {:.1f} times the noise, and noise alone may give {:.1f}; try to "
          "search elsewhere, more light, or a larger window on more edges",
          verdict.rise.rise, verdict.rise.needed);
    case Why::no_shape:
      return fmt::format(
          "the scores round {:.6g} have no shape of a peak (R^2 = {:.2f}); try --metric "
          "walsh-sequency or a band, --average, or a larger window",
          reason.position, reason.r_squared);
    case Why::unsure:
      return fmt::format(
          "the peak at {:.6g} is too unsure, confidence {:.2f}; try --average, more light, or a "
          "larger window on more edges",
          reason.position, reason.confidence);
    case Why::at_end:
      return fmt::format(
          "the best score is at {:g}, an end of what was searched; the focus may lie beyond it, "
          "try a wider --from, --to or --bracket",
          reason.position);
    case Why::two_peaks:
      return fmt::format(
          "two peaks, at {:.6g} and, {:.0f} % as high, at {:.6g}: are there two objects in the "
          "window? Try a smaller --window, or --from and --to round one of them",
          reason.position, 100 * reason.second_part, reason.second_position);
  }
  return {};
}

}  // namespace fathom::cli
