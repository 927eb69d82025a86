// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fathom::reproduce {
namespace {

std::size_t count(const std::vector<Claim>& claims, Mark outcome) {
  return static_cast<std::size_t>(std::count_if(
      claims.begin(), claims.end(), [&](const Claim& claim) { return claim.outcome == outcome; }));
}

Table claims_table(const std::vector<Claim>& claims) {
  Table table;
  table.id = "claims-table";
  table.header = {"Claim", "In the thesis", "Its number", "Ours", "Outcome", "See"};
  table.alignment = "llllll";
  table.folds = true;
  for (const Claim& claim : claims) {
    table.rows.push_back({claim.claim,
                          claim.where,
                          claim.thesis,
                          claim.ours,
                          {to_string(claim.outcome), claim.outcome},
                          fmt::format("[{0}](#{0})", claim.section)});
  }
  return table;
}

/// Those that do not simply hold.
Bullets exceptions(const std::vector<Claim>& claims) {
  Bullets bullets;
  for (const Claim& claim : claims) {
    if (claim.outcome == Mark::holds) continue;
    bullets.items.push_back(fmt::format("{}: **{}** ({}). Here: {}; [more](#{}).", claim.claim,
                                        to_string(claim.outcome), claim.where, claim.ours,
                                        claim.section));
  }
  return bullets;
}

}  // namespace

Section claims_section(const Results& results, const std::vector<Claim>& claims,
                       const Artist& artist) {
  Section section{"claims", "What the thesis claims, and what came out", {}};
  if (!artist.problem().empty()) {
    section.blocks.emplace_back(Notice{"**All plots are missing from this report**: " +
                                       artist.problem() + ". Then run it again."});
  }
  if (results.effort.quick) {
    section.blocks.emplace_back(
        Notice{"This is a quick run (`--quick`): a few runs of everything, enough to see that it "
               "works, too few to judge the thesis by. Leave `--quick` out for that."});
  }
  section.blocks.emplace_back(Paragraph{fmt::format(
      "P. R. Weckler measured distances with one camera: he moved its lens to where the picture "
      "was "
      "sharpest and read the distance from the lens position. We repeated his experiments on a "
      "simulation of his rig. Of {} claims of the thesis, **{} hold, {} hold in part and {} do "
      "not**. "
      "Times are compared [at the end](#speed).",
      claims.size(), count(claims, Mark::holds), count(claims, Mark::partly),
      count(claims, Mark::fails))});
  section.blocks.emplace_back(exceptions(claims));
  section.blocks.emplace_back(errors_figure(artist, results.tables));
  section.blocks.emplace_back(claims_table(claims));
  return section;
}

Section rig_section(const Results& results) {
  Section section{"rig", "How it was done", {}};
  section.blocks.emplace_back(Paragraph{
      "The rig is `sim`: a 135 mm lens at f/4 on a motor of 1200 steps (0 is infinity, 1200 is 4 "
      "ft), "
      "a camera of 256 x 240 pixels with shot noise, read noise and fixed pattern, gears with "
      "play, "
      "and a lamp that wanders by 1 %. Its targets are a USAF-1951 chart, a pine seedling and an "
      "orange before an 18 % grey card. The window is 64 x 64 pixels in the middle, unless said "
      "otherwise."});
  section.blocks.emplace_back(Bullets{
      {"**The thesis' way** repeats the thesis: golden section to 2 steps from a bracket round the "
       "focus, one frame a score, the best position evaluated, its calibration curves fitted as a "
       "statistics package of 1989 does. An operator chose the thesis' brackets; here dice set "
       "their "
       "ends 20 to 120 steps from the focus, because then about as many evaluations come out as "
       "the "
       "thesis needed.",
       "**Fathom's own way** is what the program does when nothing is asked for: from where "
       "the lens stands, the spectra of a few pictures tell the side and the place of the focus; "
       "the lens goes there and passes it once ([more](#ways)). A peak is fitted between the "
       "steps, the curve is the one that predicts best, and a verdict may say \"no focus\".",
       "Everything is random from fixed seeds. Two runs on one machine give the same report but "
       "for "
       "[the times](#speed); another kind of processor may change last digits."}});
  std::string command = "fathom reproduce OUT";
  if (results.effort.quick) command += " --quick";
  section.blocks.emplace_back(Commands{{command}});
  return section;
}

Section limits_section() {
  Section section{"limits", "What this cannot show", {}};
  section.blocks.emplace_back(Bullets{
      {"It is a simulation. That the seedling's needles stand in front of its stem and that the "
       "orange's dimples are faint was put into it; what is shown is that this leads to what the "
       "thesis saw, and by how much.",
       "The simulated lens is a thin lens, its motor never slips and its target never moves. The "
       "thesis' larger scatter may come from all of that; we cannot know.",
       "The thesis does not say at which distances it calibrated, how many runs each row of its "
       "tables has (only their sums), from which brackets it searched, nor the coefficients of its "
       "calibration curves. Where a choice was needed, the text says which.",
       "The scan of the thesis lost the points of its plots, so single points cannot be compared; "
       "the grey marks come from its tables."}});
  return section;
}

Document build_report(const Results& results, const std::vector<Claim>& claims,
                      const ThisRun& this_run, const Artist& artist) {
  return {
      "Optical range-finding from image focus, repeated",
      "The experiments of P. R. Weckler's thesis (Oklahoma State University, December 1989) on a "
      "simulation of its rig, beside its own numbers.",
      {claims_section(results, claims, artist), rig_section(results), why_section(results, artist),
       curves_section(results, artist), far_section(results, artist),
       repeatability_section(results, artist), calibration_section(results, artist),
       tables_section(results, artist), seedling_section(results, artist),
       orange_section(results, artist), searches_section(results, artist),
       own_way_section(results, artist), ways_section(results, artist), limits_section(),
       speed_section(this_run)}};
}

}  // namespace fathom::reproduce
