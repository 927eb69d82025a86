// SPDX-License-Identifier: Apache-2.0
#include "words/warning_words.hpp"

#include <fmt/format.h>

#include "engine/printable.hpp"
#include "words/finding_words.hpp"

namespace fathom {
namespace {

using Lines = std::vector<std::string>;

/// One function a kind: a new one without words does not compile.
struct Words {
  const Terms& terms;

  Lines operator()(const InexactPositions& inexact) const {
    constexpr std::size_t kSaid = 3;
    Lines lines;
    for (const InexactPositions::Place& place : inexact.places) {
      if (lines.size() == kSaid) break;
      lines.push_back(fmt::format("there is no lens position {}; the nearest, {} {}, is used",
                                  place.wanted, place.nearest, inexact.unit));
    }
    if (inexact.places.size() > kSaid)
      lines.push_back(fmt::format("and so for {} more positions", inexact.places.size() - kSaid));
    return lines;
  }

  Lines operator()(const StepTooFine& fine) const {
    return {fmt::format("the lens has no positions {:g} {} apart; each that it has is taken once",
                        fine.step, fine.unit)};
  }

  Lines operator()(const Saturation& saturation) const {
    return {fmt::format(
        "{:.0f} % of the window is saturated at position {:g}, so the peak may be off by more than "
        "it says; shorten the exposure",
        100 * saturation.part, saturation.position)};
  }

  Lines operator()(const LightChanged& light) const {
    constexpr double kMostOfALamp = 0.35;
    if (!light.is_even) {
      return {fmt::format(
          "the light changed in a part of the picture, or something bright moved in it, while the "
          "lens moved (the whole picture's brightness changed by {:.1f} %); no score can be "
          "corrected for that; keep lamps, shadows and reflections still",
          100 * light.part)};
    }
    if (light.part > kMostOfALamp) {
      return {fmt::format(
          "the pictures' brightness changed by {:.0f} % while the lens moved: the light or the "
          "exposure changed, or something bright came into the picture; the answer may be of that",
          100 * light.part)};
    }
    return {fmt::format(
        "the pictures' brightness changed by {:.1f} % while the lens moved; the scores were "
        "corrected for it; switch off automatic exposure and gain, and keep the light steady",
        100 * light.part)};
  }

  Lines operator()(const NoiseChanged& noise) const {
    return {
        fmt::format("the pictures' noise changed from {:.2g} to {:.2g} grey levels while the lens "
                    "moved; switch "
                    "off automatic gain",
                    noise.least, noise.most)};
  }

  Lines operator()(const Receding& receding) const {
    return {fmt::format(
        "the window is not all at one distance: its parts are sharpest from {:.6g} to {:.6g} {}, "
        "and the answer's sigma holds that; use a smaller {} on what is to be measured",
        receding.from, receding.to, receding.unit, terms.window)};
  }

  Lines operator()(const LostFrames& lost) const {
    return {fmt::format(
        "the camera lost {} frames, and {} came damaged, beside {} good ones; none of them was "
        "scored",
        lost.during.dropped, lost.during.corrupt, lost.during.delivered)};
  }

  Lines operator()(const LensNote& note) const {
    return {fmt::format("at position {:g} the lens says: {}", note.position, note.text)};
  }

  Lines operator()(const PoorLight& light) const {
    const std::string now =
        light.exposure_ms > 0 ? fmt::format(" (now {:g})", light.exposure_ms) : "";
    switch (light.kind) {
      case PoorLight::Kind::dark:
        return {fmt::format(
            "the first pictures are dark: {:.1f} % of full scale. A camera may keep an old "
            "exposure "
            "once its automatics are off: set a longer exposure_ms{} or a higher gain in the rig "
            "file, or give more light",
            100 * light.part, now)};
      case PoorLight::Kind::bright:
        return {fmt::format(
            "the first pictures are too bright: {:.0f} % of the window is at the maximum; set a "
            "shorter exposure_ms{} or a lower gain in the rig file",
            100 * light.part, now)};
      case PoorLight::Kind::flickering:
        return {fmt::format(
            "the light flickers: the first pictures differ by {:.0f} % in brightness. Under lamps "
            "on "
            "mains set exposure_ms{} to a multiple of 10 (50 Hz) or 8.333 (60 Hz), and switch off "
            "what changes the exposure by itself",
            100 * light.part, now)};
    }
    return {};
  }

  Lines operator()(const BlurDoubted& doubted) const {
    const std::string seen =
        doubted.seen ? fmt::format("; they say {:.3g}", *doubted.seen) : std::string();
    return {
        fmt::format("the pictures do not defocus by {}, which is what was known of this lens{}{}",
                    blur_words(doubted.used, doubted.unit), seen,
                    doubted.was_misled ? "; so the travel was searched without it" : "")};
  }

  Lines operator()(const FewOnTheWay& few) const {
    Lines lines;
    if (few.unplaced > 0) {
      lines.push_back(fmt::format(
          "{} frames were left out: where the lens stood meanwhile is not known well enough",
          few.unplaced));
    }
    if (few.smeared > 0) {
      lines.push_back(fmt::format(
          "{} frames were left out: the lens went too far within one exposure; a shorter "
          "exposure_ms or a slower motor helps",
          few.smeared));
    }
    if (few.visited > 0) {
      lines.push_back(fmt::format(
          "the camera is too slow for this travel: {} positions that its frames had left out are "
          "visited one by one",
          few.visited));
    }
    return lines;
  }

  Lines operator()(const HaltsInstead& halts) const {
    switch (halts.why) {
      case HaltsInstead::Why::unwatched:
        return {
            fmt::format("the lens cannot be watched while it moves: {}; it halts for every "
                        "frame",
                        printable(halts.lens_says))};
      case HaltsInstead::Why::not_by_spectra:
        return {
            "frames on the way are looked at by their spectra, and here the blur of the lens is "
            "not known, or the window too small; the lens halts for every frame"};
      case HaltsInstead::Why::too_quick:
        return {
            "the camera is too slow for this travel: the lens goes too far within a frame, or "
            "between two; it halts for every frame instead"};
      case HaltsInstead::Why::unplaced:
        return {
            "the lens did not say where it stood while frames were exposed; it halts for every "
            "frame instead"};
    }
    return {};
  }

  Lines operator()(const Finding& finding) const { return {words_for(finding)}; }

  Lines operator()(const LensNotReturned& lost) const {
    return {fmt::format("the lens was not put back to {}: {}", lost.position, lost.why)};
  }
};

}  // namespace

std::string blur_words(double px_per_unit, const std::string& unit) {
  const bool is_plural = unit.size() > 2 && unit.ends_with('s');
  return fmt::format("{:.3g} px a {}", px_per_unit,
                     is_plural ? unit.substr(0, unit.size() - 1) : unit);
}

std::vector<std::string> lines_of(const Warning& warning, const Terms& terms) {
  return std::visit(Words{terms}, warning);
}

}  // namespace fathom
