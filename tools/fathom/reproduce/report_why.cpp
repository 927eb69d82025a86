// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/drawings.hpp"
#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

/// Where the table's columns begin and end, cycles per pixel; the last column has the corners.
constexpr double kEdges[] = {0, 0.125, 0.25, 0.5};

std::string part_of(double value, double sharp_score) {
  return fmt::format("{:.1f}", 100 * value / sharp_score);
}

Table sums_table(const Looks& looks) {
  Table table;
  table.id = "sums";
  table.header = {
      "Sum of mass times lever arm squared", "up to 1/8", "to 1/4", "to 1/2", "beyond", "score"};
  table.alignment = "lrrrrr";
  table.caption =
      "Where in the spectrum the score lies, by spatial frequency in cycles per pixel. The score "
      "in "
      "focus is 100.";
  for (std::size_t i = 0; i < std::size(kShown); ++i) {
    const double whole = looks.find(kChart, true).spectra[i].score;
    for (const bool sharp : {true, false}) {
      const SpectrumLook& look = looks.find(kChart, sharp).spectra[i];
      std::vector<Cell> row{
          fmt::format("{}, {}", kTransforms[look.transform].short_name,
                      sharp ? "in focus" : fmt::format("{:g} steps off", kBlurSteps))};
      for (std::size_t k = 0; k + 1 < std::size(kEdges); ++k) {
        row.emplace_back(part_of(look.between(kEdges[k], kEdges[k + 1]), whole));
      }
      row.emplace_back(part_of(look.bands.back(), whole));
      row.emplace_back(part_of(look.score, whole));
      table.rows.push_back(row);
    }
  }
  return table;
}

}  // namespace

Section why_section(const Results& results, const Artist& artist) {
  const Looks& looks = results.looks;
  return {
      "why",
      "Why the score finds the focus (figures 1, 2, 6, 7 and 9)",
      {lens_drawings(),
       Paragraph{fmt::format("These are the three targets at {:g} mm as the camera sees them, in "
                             "focus and with the lens {:g} steps from there:",
                             kLookDistance, kBlurSteps)},
       targets_figure(artist, looks, true), targets_figure(artist, looks, false),
       Paragraph{"Blur takes away what is fine. In a spectrum that is what lies far from zero "
                 "frequency; what is coarse, near zero, stays:"},
       spectra_figure(artist, looks, true), spectra_figure(artist, looks, false),
       Paragraph{"So the farther out a coefficient lies, the more it tells of the focus. The "
                 "thesis' score weighs it by its squared distance, as a moment of inertia does:"},
       moment_drawings(), sums_figure(artist, looks), sums_table(looks),
       Paragraph{
           "What is left far out without a focus is the camera's noise and, for Walsh, what its "
           "square waves need to make soft edges. It is the floor under every curve below. "
           "The search then looks for the lens position with the largest sum:"},
       search_drawing(),
       Commands{{fmt::format("fathom snap --rig sim:distance={:g} --at {:g} -o sharp.png",
                             kLookDistance, looks.find(kChart, true).position),
                 "fathom spectrum sharp.png --metric fft --plot sharp-spectrum.svg",
                 "fathom score sharp.png --metric fft",
                 "fathom score sharp.png --metric walsh-sequency"}}}};
}

}  // namespace fathom::reproduce
