// SPDX-License-Identifier: Apache-2.0
#include "words/verdict_words.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace fathom {

namespace {

/// From this part of the pixels on more light is no advice.
constexpr double kSaturated = 0.01;

bool is_saturated(const Reason& reason) { return reason.saturated > kSaturated; }

/// "a", "a or b", "a, b, or c".
std::string one_of(const std::vector<std::string>& ways) {
  if (ways.size() < 2) return ways.empty() ? "" : ways[0];
  if (ways.size() == 2) return ways[0] + " or " + ways[1];
  std::string text;
  for (std::size_t i = 0; i + 1 < ways.size(); ++i) text += ways[i] + ", ";
  return text + "or " + ways.back();
}

/// What makes a faint peak stand out, as far as the user can do it.
std::vector<std::string> ways_to_more_signal(const Reason& reason, const Terms& terms) {
  std::vector<std::string> ways;
  if (reason.is_live) {
    ways.emplace_back(is_saturated(reason) ? "a shorter exposure" : "better light");
    ways.push_back(fmt::format("a larger {}", terms.average));
  }
  if (!reason.largest_window) ways.emplace_back("a larger window");
  if (!reason.largest_window || !reason.is_live)
    ways.emplace_back(reason.largest_window ? "pictures with more edges" : "one on more edges");
  if (reason.largest_window && reason.is_live) ways.emplace_back("a target with more edges");
  return ways;
}

std::string more_signal(const Reason& reason, const Terms& terms) {
  return one_of(ways_to_more_signal(reason, terms));
}

/// Where else a focus may be, or nothing where all was searched.
std::string elsewhere_or_more_signal(const Reason& reason, const Terms& terms) {
  std::vector<std::string> ways = ways_to_more_signal(reason, terms);
  if (!reason.whole_travel) ways.insert(ways.begin(), "to search elsewhere");
  return one_of(ways);
}

std::string another_metric(const Reason& reason, const Terms& terms) {
  return terms.metric(reason.transform == Transform::walsh_sequency ? "fft:64:hann:band=0.05-0.25"
                                                                    : "walsh-sequency");
}

/// A lens that still moves when it says that it is there smears a curve, or doubles it.
std::string does_it_settle(const Terms& terms) {
  constexpr const char* kMayMove =
      "; if the lens may still move when it says that it is there, {} measures that";
  return terms.settling_check.empty() ? "" : fmt::format(kMayMove, terms.settling_check);
}

std::string words_for_end(const Reason& reason, const Terms& terms) {
  if (reason.at_lens_end) {
    return fmt::format(
        "the best score is at {:g}, the lens's own end; the focus may lie beyond it: {}",
        reason.position,
        reason.is_live ? "move the target, or the camera" : "the recording ends there");
  }
  return fmt::format(
      "no score stands above the one at {:g}, an end of what was searched; the focus may lie "
      "beyond it, try a wider {}",
      reason.position, terms.wider);
}

std::string words_for_change(const Reason& reason, const Terms& terms) {
  return fmt::format(
      "what was seen at {:.6g} at one time does not fit what was seen at another: the scene, the "
      "light or the lens changed during the search; hold the target still, slow the motor or home "
      "it, and search again{}",
      reason.position, does_it_settle(terms));
}

}  // namespace

std::string words_for(const Verdict& verdict, const Terms& terms) {
  const Reason& reason = verdict.reason;
  switch (reason.why) {
    case Why::unknown:
      return "no reason was kept";
    case Why::stands_out:
      return fmt::format("the peak stands {:.0f} times the noise above the floor",
                         verdict.rise.rise);
    case Why::by_spectra:
      return "the spectra of the pictures defocus as the lens says, though their scores drown in "
             "noise";
    case Why::too_few_frames:
      return "so few frames do not tell where the focus is; allow more, start nearer to it, or see "
             "that the blur told is this lens's";
    case Why::dead_pictures:
      return fmt::format(
          "{} of {} pictures are black or saturated, so there is no floor to judge a focus by; {}",
          reason.dead, reason.evaluations,
          reason.is_live ? "set the exposure" : "record with another exposure");
    case Why::one_position:
      return fmt::format("one position alone tells of no peak; {}",
                         !reason.whole_travel
                             ? fmt::format("try a wider {}", terms.wider)
                             : fmt::format("{} are needed, better 5", kFewestLive));
    case Why::few_pictures:
      return fmt::format("{} positions are too few to tell a peak by; {} are needed, better 5",
                         reason.evaluations, kFewestLive);
    case Why::all_alike:
      return "every position has the very same score; does the lens move, does the camera send "
             "fresh pictures, and is the window neither black nor saturated?";
    case Why::too_wild:
      return fmt::format(
          "so few coefficients scatter too much to judge a focus by; use a {}wider band",
          reason.largest_window ? "" : "larger window or a ");
    case Why::within_noise:
      return fmt::format(
          "the scores rise by {:.1f} times the noise, and noise alone may give {:.1f}; try {}",
          verdict.rise.rise, verdict.rise.needed, elsewhere_or_more_signal(reason, terms));
    case Why::small_rise:
      return fmt::format(
          "the scores rise by {:.1f} %, and a lamp that drifts may give {:.0f} %; is there texture "
          "in the window? Try {}",
          100 * reason.contrast, 100 * kLeastContrast, more_signal(reason, terms));
    case Why::light_changed:
      return fmt::format(
          "the scores at {:.6g} rise with the brightness of the pictures, not with their "
          "sharpness; "
          "{}",
          reason.position,
          reason.is_live ? "switch off automatic exposure and gain, and keep the light steady"
                         : "the light or the camera's gain changed while this was recorded");
    case Why::light_in_part:
      return fmt::format(
          "the scores at {:.6g} rise with the brightness of parts of the window, not with their "
          "sharpness; {}",
          reason.position,
          reason.is_live ? "keep lamps, shadows and reflections still"
                         : "the light of a part of the picture changed while this was recorded");
    case Why::noise_changed:
      return fmt::format(
          "the scores at {:.6g} rise because the pictures are noisier there, not sharper; {}",
          reason.position,
          reason.is_live ? "switch off automatic gain, and keep the light steady"
                         : "the camera's gain changed while this was recorded");
    case Why::unshared:
      return fmt::format(
          "no other picture shows what the one at {:.6g} shows, so it is noise{}, or something "
          "that "
          "passed by; {}",
          reason.position, reason.is_live ? "" : " that changed",
          reason.is_live ? "more light, less gain, or a window on more edges"
                         : "try a window on more edges");
    case Why::too_faint:
      return fmt::format("what rises is less than one grey level of the camera; try {}",
                         more_signal(reason, terms));
    case Why::no_shape:
      return fmt::format(
          "the scores round {:.6g} have no shape of a peak (R^2 = {:.2f}); try {}, {}",
          reason.position, reason.r_squared, another_metric(reason, terms),
          more_signal(reason, terms));
    case Why::unsure:
      return fmt::format("the peak at {:.6g} is too unsure, confidence {:.2f}; try {}",
                         reason.position, reason.confidence, more_signal(reason, terms));
    case Why::at_end:
      return words_for_end(reason, terms);
    case Why::changed:
      return words_for_change(reason, terms);
    case Why::two_depths:
      return fmt::format(
          "parts of the window are sharpest at {:.6g}, others at {:.6g}: it holds two depths; try "
          "a smaller {} on one of them",
          reason.position, reason.second_position, terms.window);
    case Why::two_peaks:
      return fmt::format(
          "two peaks, at {:.6g} and, {:.0f} % as high, at {:.6g}: are there two objects in the "
          "window? Try a smaller {}, or {} round one of them{}",
          reason.position, 100 * reason.second_part, reason.second_position, terms.window,
          terms.ends, reason.is_live ? does_it_settle(terms) : "");
  }
  return {};
}

}  // namespace fathom
