// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

Table orange_table(const Orange& orange) {
  Table table;
  table.header = {"Window",      "Distance (mm)",     "Runs",     "Golden section: wrong",
                  "worst error", "Own way: distance", "no focus", "wrong"};
  table.alignment = "lrrrrrrr";
  table.caption =
      "Wrong: off by more than half of the depth of field. Golden section alone always gives "
      "an answer; the bracket keeps it from going far.";
  for (const Orange::Patch& patch : orange.patches) {
    table.rows.push_back({fmt::format("{0} x {0}", patch.side),
                          fmt::format("{:g}", patch.distance_mm),
                          std::to_string(patch.own_way.runs.size()),
                          std::to_string(patch.old_way.wrong), percent(patch.old_way.size.most, 1),
                          std::to_string(patch.own_way.answers - patch.own_way.wrong),
                          std::to_string(patch.own_way.no_focus + patch.own_way.others),
                          std::to_string(patch.own_way.wrong)});
  }
  return table;
}

Table searches_table(const Searches& searches) {
  Table table;
  table.header = {"Search", "Runs", "Evaluations, mean", "from", "to", "Mean error"};
  table.alignment = "lrrrrr";
  table.caption = "From the same brackets to the same tolerance of 2 steps, on the chart, FFT.";
  for (const Trial& trial : searches.bracketed) {
    table.rows.push_back({trial.name, std::to_string(trial.runs.size()),
                          fmt::format("{:.1f}", trial.evaluations.mean),
                          fmt::format("{:.0f}", trial.evaluations.least),
                          fmt::format("{:.0f}", trial.evaluations.most),
                          percent(trial.size.mean, 3)});
  }
  return table;
}

Table sides_table(const Searches& searches) {
  Table table;
  table.header = {"Window", "Chart: mean error", "no focus", "Seedling: mean error", "no focus"};
  table.alignment = "lrrrr";
  table.caption = "Windows of other sizes, FFT, Fathom's own way.";
  for (const Searches::Side& side : searches.sides) {
    table.rows.push_back(
        {fmt::format("{0} x {0}", side.side), percent(side.chart.size.mean, 3),
         fmt::format("{} of {}", side.chart.no_focus + side.chart.others, side.chart.runs.size()),
         percent(side.seedling.size.mean, 3),
         fmt::format("{} of {}", side.seedling.no_focus + side.seedling.others,
                     side.seedling.runs.size())});
  }
  return table;
}

Cell met(bool is_true) { return {is_true ? "met" : "missed", is_true ? Mark::holds : Mark::fails}; }

void add_bars(Table& table, const char* what, const std::vector<Trial>& trials,
              double evaluations) {
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const Trial& trial = trials[t];
    const bool all = trial.answers == static_cast<int>(trial.runs.size());
    table.rows.push_back(
        {fmt::format("{}, {}", what, kTransforms[t].short_name),
         fmt::format("error at most 0.1 %, {:g} evaluations", evaluations),
         fmt::format("mean error {} (largest {}), {:.0f} evaluations at most; {} of {} focused",
                     percent(trial.size.mean, 3), percent(trial.size.most, 3),
                     trial.evaluations.most, trial.answers, trial.runs.size()),
         met(all && trial.size.mean <= 0.001 && trial.evaluations.most <= evaluations)});
  }
}

Table bars_table(const OwnWay& own) {
  Table table;
  table.header = {"What", "Bar", "Here", "Outcome"};
  table.alignment = "llll";
  table.folds = true;
  add_bars(table, "Chart, whole travel", own.whole, 20);
  add_bars(table, "Chart, told steps 500 to 1060", own.working, 12);
  table.rows.push_back(
      {"Chart, seedling or orange; random distance, noise (half to twice), seed, start and "
       "transform",
       "no wrong answer",
       fmt::format(
           "{} runs: {} distances, {} wrong; {} ended as no focus, {} at a limit or ambiguous",
           own.random.runs.size(), own.random.answers, own.random.wrong, own.random.no_focus,
           own.random.others),
       met(own.random.wrong == 0)});
  table.rows.push_back(
      {"A blank grey card", "always \"no focus\"",
       fmt::format("{} of {} runs ended as no focus", own.blank.no_focus, own.blank.runs.size()),
       met(own.blank.no_focus == static_cast<int>(own.blank.runs.size()))});
  return table;
}

}  // namespace

Section orange_section(const Results& results, const Artist& artist) {
  return {
      "orange",
      "Why a patch of orange fails",
      {Paragraph{
           "The dimples of an orange are faint. The less of the rind the window holds, the less "
           "its scores rise out of the noise. Each run is on another orange."},
       orange_figure(artist, results.orange), orange_table(results.orange),
       Paragraph{
           "The thesis' search cannot tell: it answers in any case, and with a small patch it "
           "is sometimes far off. Fathom asks whether the curve rises out of what noise alone "
           "would give, and says \"no focus\" where it does not. It is the cautious one: it "
           "also turns down small patches of which the bare search would have been right, "
           "because a bracket is knowledge that it does not have."},
       Commands{{"fathom focus --rig sim:target=orange,distance=1864 --metric fft:64 --plot -",
                 "fathom focus --rig sim:target=orange,distance=1864 --metric fft:16 --plot -   # "
                 "no-focus"}}}};
}

Section searches_section(const Results& results, const Artist& artist) {
  return {
      "searches",
      "How many evaluations, how large a window",
      {evaluations_figure(artist, results), searches_table(results.searches),
       Paragraph{
           "Brent's method saves less than the third that the thesis hoped for. Golden section as "
           "the thesis describes it, "
           "over all 1200 steps, cannot do with 11 evaluations: 1200 steps down to 2 take 14. "
           "So its operator must have begun closer to the focus, and had to: see "
           "[far from focus](#far)."},
       sides_table(results.searches),
       Paragraph{
           "A 64 x 64 window is enough where there is texture, and here even a smaller one is; "
           "on the [orange](#orange) it is not a luxury."},
       Commands{{"fathom focus --rig sim:distance=1700 --search brent --bracket 700,830,900 --peak "
                 "evaluated"}}}};
}

Section own_way_section(const Results& results, const Artist& artist) {
  return {
      "own",
      "Fathom's own way",
      {Paragraph{
           "The same rig and the same noise, but Fathom's default search over the whole travel, a "
           "fitted peak and the curve that predicts best. Random distances from 1400 to 2600 "
           "mm, random start of the lens. Wrong means off by more than half of the depth of "
           "field."},
       own_way_figure(artist, results), bars_table(results.own),
       Paragraph{fmt::format(
           "With the FFT on the chart the thesis' search is off by {} on average, a peak fitted "
           "between the steps by {}. On the seedling both ways end near 0.3 %: there the needles "
           "decide, not the search. What the fit does there is to shrink the scatter: see the "
           "columns of 3 standard deviations in [the tables](#tables).",
           percent(results.searches.bracketed.front().size.mean, 3),
           percent(results.own.whole[kFft].size.mean, 3))},
       Commands{{"fathom calibrate --rig sim --distances 1400,1571,1743,1914,2086,2257,2429,2600 "
                 "--repeat 3 --model auto -o own.json",
                 "fathom range --rig sim:distance=1700,start=300 --calibration own.json"}}}};
}

}  // namespace fathom::reproduce
