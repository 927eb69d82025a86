// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/topics.hpp"

#include <fmt/format.h>

#include "focus/searches.hpp"
#include "hal/rig_driver.hpp"
#include "tools/fathom/manual.hpp"

namespace fathom::cli {
namespace {

/// A name, and what is said of it in lines beside it.
std::string described(std::string_view name, std::string_view text) {
  constexpr int kIndent = 14;
  std::string lines;
  for (const std::string& line : wrapped(text, kHelpColumns - kIndent))
    lines += fmt::format("  {:<{}}{}\n", lines.empty() ? name : "", kIndent - 2, line);
  return lines;
}

std::string rigs_text() {
  std::string text =
      "A rig is a camera and a lens, behind --rig:\n\n"
      "  DRIVER            with what it has by itself\n"
      "  DRIVER:VALUE,KEY=VALUE,...\n"
      "  FILE.toml         a rig file: one driver and its keys, or a [camera] and a [lens]\n\n"
      "Drivers of this build:\n";
  for (const RigDriver* driver : all_rig_drivers())
    text += described(driver->name(), driver->summary());
  for (const AbsentRigDriver& absent : absent_rig_drivers())
    text += described(absent.name, fmt::format("not in this build: {}", absent.reason));
  return text +
         "\nExamples:\n"
         "  fathom focus --rig sim:target=seedling,distance=1800\n"
         "  fathom focus --rig replay:stack.tif\n"
         "  fathom focus --rig v4l2:/dev/video0\n\n"
         "fathom rigs list says what is plugged in, and fathom rigs check RIG tries it. "
         "docs/rigs.md\n"
         "leads from an unboxed webcam to the first distance, and examples/rigs has rig files.\n";
}

std::string metrics_text() {
  return "A metric is what is computed of a window, behind --metric:\n\n"
         "  TRANSFORM[:N][:TAPER][:power][:band=LO-HI][:rings=K]\n"
         "  dct[:N]:entropy[:band=LO-HI]\n\n"
         "Parts:\n" +
         described(
             "TRANSFORM",
             "fft, walsh-paley, walsh-sequency, walsh-hadamard or dct. The score is the moment "
             "of inertia of the spectrum: high where fine detail is.") +
         described("N",
                   "Side of the window in pixels: 8, 16, 32, 64, 128, 256 or 512; else that of "
                   "--window, else 64.") +
         described("TAPER",
                   "none, hann or tukey=A: how pixels near the edge count. Of fft, hann if "
                   "nothing is said; of the others none.") +
         described("power", "Squares of the coefficients in place of their magnitudes.") +
         described("band=LO-HI",
                   "Only these spatial frequencies, in cycles per pixel; 0.5 is the "
                   "finest.") +
         described("rings=K",
                   "K numbers a window in place of one: the mean power in K rings of "
                   "spatial frequency. Of fathom score alone.") +
         described("entropy",
                   "Entropy of the cosine spectrum, which light-sheet microscopes focus "
                   "by.") +
         "\nExamples:\n"
         "  fathom score photo.png --metric fft:64:hann\n"
         "  fathom focus --rig sim --metric walsh-sequency:64\n"
         "  fathom score photo.png --metric fft:64:hann:power:band=0-0.25\n\n"
         "Searches take walsh-sequency unless they are told otherwise. fathom compare-metrics "
         "STACK\n"
         "tells which metric suits your pictures; docs/metrics.md has the formulas.\n";
}

/// What the search does and when to take it.
const char* words_for(SearchMethod method) {
  switch (method) {
    case SearchMethod::automatic:
      return "spectral where the lens's blur is known, and coarse where it is not or does not "
             "tell.";
    case SearchMethod::golden:
      return "Golden section, as in the thesis: for curves of one peak, within --bracket or what a "
             "coarse pass finds.";
    case SearchMethod::fibonacci:
      return "Its relative that knows beforehand how many pictures it needs.";
    case SearchMethod::brent:
      return "Parabolas through the best pictures, and golden sections where they fail.";
    case SearchMethod::hill:
      return "Climbs from where the lens stands, in steps that become smaller: for a lens that is "
             "nearly in focus. It takes the first peak that it meets.";
    case SearchMethod::full:
      return "Looks at every position, or at some hundred: slow, and misses nothing.";
    case SearchMethod::spectral:
      return "From where the lens stands, a few pictures: how their spectra differ tells how far "
             "the focus is. Needs a lens whose blur is known, told or learned.";
    case SearchMethod::coarse:
      return "A coarse pass over the travel finds the peak wherever it is; a fit asks for a few "
             "pictures more on its top and slopes.";
  }
  return "";
}

std::string searches_text() {
  std::string text = "A search is how the lens finds the sharpest picture, behind --search:\n\n";
  for (const Search& search : searches()) text += described(search.name, words_for(search.method));
  return text + "\nThe answer (--peak):\n" +
         described("fit",
                   "A fit through the top of the curve, which may lie between steps, with its "
                   "sigma.") +
         described("evaluated", "The best position that was looked at, as in the thesis.") +
         "\nExamples:\n"
         "  fathom focus --rig sim --search auto\n"
         "  fathom focus --rig sim --search golden --peak evaluated\n\n"
         "fathom compare-searches runs all of them on the same scenes. docs/ranging.md says when "
         "a\n"
         "focus is believed.\n";
}

constexpr Topic kTopics[] = {
    {"rigs", "cameras and lenses, and how to name them", rigs_text},
    {"metrics", "what is computed of a window, and how to write it", metrics_text},
    {"searches", "how the lens finds the sharpest picture", searches_text},
};

}  // namespace

std::span<const Topic> topics() { return kTopics; }

}  // namespace fathom::cli
