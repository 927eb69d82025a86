// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/warning_words.hpp"

#include <fmt/format.h>

#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

using Lines = std::vector<std::string>;

/// One function a kind: a new one without words does not compile.
struct Words {
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

  Lines operator()(const LostFrames& lost) const {
    return {fmt::format(
        "the camera lost {} frames, and {} came damaged, beside {} good ones; none of them was "
        "scored",
        lost.during.dropped, lost.during.corrupt, lost.during.delivered)};
  }

  Lines operator()(const LensNote& note) const {
    return {fmt::format("at position {:g} the lens says: {}", note.position, note.text)};
  }

  Lines operator()(const LensNotReturned& lost) const {
    return {fmt::format("the lens was not put back to {}: {}", lost.position, lost.why)};
  }
};

}  // namespace

std::vector<std::string> lines_of(const Warning& warning) { return std::visit(Words{}, warning); }

void WarningNotes::warned(const Warning& warning) {
  for (const std::string& line : lines_of(warning)) note(line);
}

}  // namespace fathom::cli
