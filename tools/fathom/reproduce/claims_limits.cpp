// SPDX-License-Identifier: Apache-2.0
// Claims on what limits the method: contrast, search, window, lens.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/optics.hpp"
#include "tools/fathom/reproduce/claims.hpp"

namespace fathom::reproduce {
namespace {

Claim orange_fails(const Orange& orange) {
  std::string text;
  std::size_t small_lost = 0, small_all = 0;
  for (const int side : {64, 32, 16}) {
    int lost = 0, wrong = 0;
    std::size_t all = 0;
    for (const Orange::Patch& patch : orange.patches) {
      if (patch.side != side) continue;
      lost += patch.own_way.no_focus + patch.own_way.others;
      wrong += patch.own_way.wrong;
      all += patch.own_way.runs.size();
    }
    text += fmt::format("{}{} px: {} of {} runs without a focus{}", text.empty() ? "" : "; ", side,
                        lost, all, wrong > 0 ? fmt::format(", {} wrong", wrong) : "");
    small_lost = static_cast<std::size_t>(lost);
    small_all = all;
  }
  return {"orange-fails",
          "A small patch of orange has too little contrast to converge",
          "p. 92",
          "often",
          text,
          holds_if(2 * small_lost > small_all, small_lost > 0 ? Mark::partly : Mark::fails),
          "orange"};
}

Claim evaluations(const Results& results) {
  std::vector<double> counts;
  for (const TableSet& set : results.tables) {
    for (const TableRow& row : set.rows) {
      for (const FocusRun& run : row.old_way.runs) counts.push_back(run.evaluations);
    }
  }
  const Summary summary = summarise(counts);
  return {"evaluations", "Golden section needs 7 to 11 evaluations", "p. 92", "7 to 11",
          fmt::format("{:.0f} to {:.0f}, mean {:.1f}, from brackets of 40 to 240 steps that were "
                      "chosen for it",
                      summary.least, summary.most, summary.mean),
          // Never more than this: the brackets were chosen so that the thesis' count comes out.
          holds_if(false, summary.least >= 7 && summary.most <= 11 ? Mark::partly : Mark::fails),
          "searches"};
}

Claim no_knowledge_needed(const Searches& searches) {
  int lost = 0;
  std::size_t all = 0;
  for (const Trial& trial : searches.bare) {
    lost += trial.wrong;
    all += trial.runs.size();
  }
  return {
      "no-a-priori-knowledge",
      "Golden section over the whole travel needs no knowledge of the curve",
      "pp. 52\u201353",
      "0 to 1200 steps",
      fmt::format("{} of {} runs ended on a wrong place", lost, all),
      holds_if(lost == 0, static_cast<std::size_t>(4 * lost) < all ? Mark::partly : Mark::fails),
      "searches"};
}

Claim brent_saves(const Searches& searches) {
  const double golden = searches.bracketed.front().evaluations.mean;
  const double brent = searches.bracketed.back().evaluations.mean;
  const double saved = 1 - brent / golden;
  return {"brent-saves-a-third",
          "Brent's method would save a third of the evaluations",
          "p. 94",
          "one third",
          fmt::format("{:.1f} instead of {:.1f}: {} fewer", brent, golden, percent(saved, 0)),
          holds_if(saved >= 0.3, saved >= 0.1 ? Mark::partly : Mark::fails),
          "searches"};
}

Claim window_suffices(const Searches& searches) {
  std::string text;
  bool enough = false;
  for (const Searches::Side& side : searches.sides) {
    text += fmt::format("{}{} px {}", text.empty() ? "mean error on the chart: " : ", ", side.side,
                        percent(side.chart.size.mean, 3));
    if (side.side != 64) continue;
    enough = side.chart.answers == static_cast<int>(side.chart.runs.size()) &&
             side.chart.size.mean < 0.001;
  }
  return {"window-64", "A 64 x 64 window is a good compromise of speed and content",
          "p. 89",     "64 x 64",
          text,        holds_if(enough),
          "searches"};
}

Claim depth_of_field() {
  struct Case {
    double f_number, distance_mm, thesis_mm;
  };
  static constexpr Case kCases[] = {
      {4, 1500, 40}, {4, 2500, 110}, {2.8, 1500, 27.7}, {2.8, 2500, 76.5}};
  std::string thesis, ours;
  bool agree = true;
  for (const auto& [f_number, distance_mm, thesis_mm] : kCases) {
    const double mm = optics::depth_of_field({135, f_number, 0.04}, distance_mm).total_mm();
    thesis += fmt::format("{}{:g}", thesis.empty() ? "" : ", ", thesis_mm);
    ours += fmt::format("{}{:.1f}", ours.empty() ? "" : ", ", mm);
    agree = agree && std::abs(mm / thesis_mm - 1) < 0.02;
  }
  return {"depth-of-field",
          "Depth of field at 1500 and 2500 mm, f/4, then f/2.8",
          "pp. 90\u201391",
          thesis + " mm",
          ours + " mm (eq. 3-3)",
          holds_if(agree),
          "tables"};
}

}  // namespace

void add_claims_on_limits(const Results& results, std::vector<Claim>& claims) {
  claims.push_back(orange_fails(results.orange));
  claims.push_back(depth_of_field());
  claims.push_back(evaluations(results));
  claims.push_back(no_knowledge_needed(results.searches));
  claims.push_back(brent_saves(results.searches));
  claims.push_back(window_suffices(results.searches));
}

}  // namespace fathom::reproduce
