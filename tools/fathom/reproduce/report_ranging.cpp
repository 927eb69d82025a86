// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

/// Six digits, large numbers in full.
std::string coefficient(double value) {
  return std::abs(value) < 1e5 ? fmt::format("{:.6g}", value) : fmt::format("{:.0f}", value);
}

std::string own_parameters(const Calibration& calibration) {
  std::string text;
  for (const CalibrationParameter& p : calibration.parameters()) {
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", p.name, coefficient(p.value));
  }
  return text;
}

Table calibration_table(const Calibrations& calibrations) {
  Table table;
  table.header = {"Transform", "Way", "Curve", "Points", "Coefficients", "R\u00B2"};
  table.alignment = "lllrlr";
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const CalibrationPair& pair = calibrations[t];
    const ThesisCalibration& thesis = kThesisCalibrations[t];
    const OldCurve& old = pair.thesis_curve;
    table.rows.push_back({kTransforms[t].name, "the thesis", to_string(thesis.model),
                          std::to_string(thesis.points), "not printed",
                          fmt::format("{:.4f}", thesis.r_squared)});
    table.rows.push_back({"", "thesis' way", to_string(old.model),
                          std::to_string(pair.thesis_runs.size()),
                          fmt::format("b0 = {}, b1 = {}", coefficient(old.b0), coefficient(old.b1)),
                          fmt::format("{:.5f}", old.r_squared)});
    table.rows.push_back({"", "own way", to_string(pair.own->model()),
                          std::to_string(pair.own->points().size()), own_parameters(*pair.own),
                          fmt::format("{:.7f}", pair.own->r_squared())});
  }
  return table;
}

std::vector<Cell> table_row(const TableSet& set, const TableRow& row, bool is_first) {
  const auto columns = [&](const RowOutcome& outcome, std::vector<Cell>& cells) {
    const Summary s = outcome.summary();
    cells.emplace_back(fmt::format("{:.0f}", s.mean));
    cells.emplace_back(percent(outcome.difference_part(row.actual_mm)));
    cells.emplace_back(fmt::format("{:.1f}", 3 * s.sd));
  };
  const std::string name =
      set.test == 1 ? set.object : std::string(kTransforms[set.transform].name);
  std::vector<Cell> cells = {is_first ? name : "", fmt::format("{:.0f}", row.actual_mm),
                             fmt::format("{:.0f}", row.thesis_mm),
                             fmt::format("{:.2f} %", row.thesis_percent),
                             fmt::format("{:.1f}", row.thesis_three_sd_mm)};
  columns(row.old_way, cells);
  columns(row.own_way, cells);
  cells.emplace_back(std::to_string(row.old_way.runs.size()));
  return cells;
}

Table distances_table(const std::vector<TableSet>& tables, int test) {
  Table table;
  table.id = fmt::format("table-{}", test);
  table.caption = fmt::format(
      "**Table {}**, actual versus measured distances for Test {}, in mm: the thesis' own, the "
      "thesis' "
      "way on the simulated rig, and Fathom's own way on it.",
      test == 1 ? "I" : "II", test);
  table.header = {test == 1 ? "Object" : "Transform",
                  "Actual",
                  "The thesis: mean",
                  "difference",
                  "\u00B13 sd",
                  "Thesis' way here: mean",
                  "difference",
                  "\u00B13 sd",
                  "Own way here: mean",
                  "difference",
                  "\u00B13 sd",
                  "Runs"};
  table.alignment = "lrrrrrrrrrrr";
  for (const TableSet& set : tables) {
    if (set.test != test) continue;
    for (const TableRow& row : set.rows) {
      table.rows.push_back(table_row(set, row, &row == &set.rows.front()));
    }
  }
  return table;
}

Table regressions_table(const std::vector<TableSet>& tables) {
  Table table;
  table.caption = "Regressions of measured on actual distance, Y = a + b X.";
  table.header = {"Test",       "Object, transform", "Points",
                  "The thesis", "R\u00B2",           "Thesis' way here",
                  "R\u00B2",    "Own way",           "R\u00B2"};
  table.alignment = "rlrrrrrrr";
  const auto text = [](const Line& line) {
    return fmt::format("{:.2f} + {:.4f} X", line.intercept, line.slope);
  };
  for (const TableSet& set : tables) {
    std::size_t points = 0;
    for (const TableRow& row : set.rows) points += row.old_way.measured_mm.size();
    table.rows.push_back({std::to_string(set.test),
                          set.object + ", " + kTransforms[set.transform].short_name,
                          std::to_string(points),
                          fmt::format("{:g} + {:g} X", set.thesis.intercept, set.thesis.slope),
                          fmt::format("{:.4f}", set.thesis.r_squared), text(set.old_line),
                          fmt::format("{:.5f}", set.old_line.r_squared), text(set.own_line),
                          fmt::format("{:.7f}", set.own_line.r_squared)});
  }
  return table;
}

std::string calibration_command(std::size_t t) {
  std::string distances;
  for (int i = 0; i < kCalibrationDistances; ++i) {
    distances += fmt::format("{}{:g}", i == 0 ? "" : ",", calibration_distance_mm(i));
  }
  return fmt::format(
      "fathom calibrate --rig sim --metric {} --search golden --peak evaluated "
      "--distances {} --repeat 6 --model {} -o cal-{}.json",
      kTransforms[t].metric, distances, to_string(kThesisCalibrations[t].model), t + 1);
}

}  // namespace

Section calibration_section(const Results& results, const Artist& artist) {
  Section section{"calibration",
                  "Calibration (figures 15 to 20)",
                  {Paragraph{fmt::format("The chart stood at {} known distances and was brought "
                                         "into focus as often as in the thesis: "
                                         "51, 33 and 34 times. The thesis does not say which "
                                         "distances; these are spread evenly over "
                                         "the range that it measured later, 1400 to 2600 mm. It "
                                         "fitted the FFT's points with b0 + b1 / "
                                         "position, and Walsh's with a power curve.",
                                         kCalibrationDistances)}}};
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    section.blocks.emplace_back(calibration_figure(artist, results.calibrations[t], t));
  }
  section.blocks.emplace_back(calibration_table(results.calibrations));
  section.blocks.emplace_back(Paragraph{
      "The fits are closer than the thesis', whose lens was no thin lens and whose errors were "
      "larger. The geometry of this one "
      "says "
      "b0 = 135 mm (its focal length) and b1 = 1 300 800 mm x steps. The power curve is the wrong "
      "shape "
      "for such a lens: its residuals bend, and this bend alone puts some 3 to 5 mm into Walsh's "
      "distances below. Fathom's own way finds that out by cross-validation and takes the inverse "
      "curve "
      "for all three. (The thesis prints no coefficients, and those of another lens and motor "
      "would not "
      "be these.)"});
  section.blocks.emplace_back(Commands{
      {calibration_command(kFft), calibration_command(kPaley), calibration_command(kSequency)}});
  return section;
}

Section tables_section(const Results& results, const Artist& artist) {
  const auto mean = [&](int test, RowOutcome TableRow::*way) {
    return percent(summarise(row_differences(results.tables, test, way)).mean);
  };
  Section section{
      "tables",
      "Distances: tables I and II (figures 21 to 30)",
      {Paragraph{
           "Test 1 measured a seedling at four distances and an orange at two with the FFT. Test 2 "
           "measured the seedling at three distances with all three transforms. The number of "
           "points is the thesis'; how they are spread over the rows is ours (last column)."},
       distances_table(results.tables, 1), distances_table(results.tables, 2),
       Paragraph{fmt::format("The mean of the differences is {} in test 1 and {} in test 2 "
                             "(thesis: 0.52 % and 0.52 % by "
                             "its rows). Done Fathom's own way, it is {} and {}: what is left then "
                             "is not scatter but the "
                             "[needles](#seedling). That the thesis has \u00B13 sd of 0.0 mm in "
                             "one row means that all of its "
                             "runs stopped at one step.",
                             mean(1, &TableRow::old_way), mean(2, &TableRow::old_way),
                             mean(1, &TableRow::own_way), mean(2, &TableRow::own_way))},
       regressions_table(results.tables)}};
  for (const TableSet& set : results.tables) {
    section.blocks.emplace_back(table_figure(artist, set));
  }
  section.blocks.emplace_back(
      Paragraph{"Scatter grows with distance in both tests. It must: a step of the motor is 1.4 mm "
                "at 1500 mm and "
                "4.3 mm at 2500 mm, and the search is as good in steps everywhere. The thesis saw "
                "this in test 1, "
                "not in test 2, and asked for more data; these side with test 1."});
  section.blocks.emplace_back(Commands{
      {"fathom range --rig sim:target=seedling,distance=1486 --calibration cal-1.json --search "
       "golden "
       "--peak evaluated --repeat 7",
       "fathom range --rig sim:target=seedling,distance=1486 --metric walsh-paley --calibration "
       "cal-2.json --search golden --peak evaluated --repeat 8",
       "fathom optics --focal 135 --fnumber 4 --distance 1500"}});
  return section;
}

Section seedling_section(const Results& results, const Artist& artist) {
  Table table;
  table.header = {"Transform", "Runs", "Mean error", "Nearest", "Farthest"};
  table.alignment = "lrrrr";
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const Trial& trial = results.own.plants[t];
    table.rows.push_back({kTransforms[t].name, std::to_string(trial.answers),
                          percent(trial.error.mean), percent(trial.error.least),
                          percent(trial.error.most)});
  }
  return {
      "seedling",
      "Why the seedling reads near",
      {Paragraph{
           "A tape measures to the stem; the sharpest edges are the needles', which stand 2 to 9 "
           "mm in front of it. So a seedling must read near, by some millimetres at any "
           "distance. These are other seedlings, each grown from another seed, at random "
           "distances."},
       seedling_figure(artist, results), table,
       Paragraph{
           "All read near. No better search mends this: it is what the window holds. The "
           "thesis says \"always slightly less\"; its own table II has one mean on the far side, "
           "1919 for 1918 mm."}}};
}

}  // namespace fathom::reproduce
