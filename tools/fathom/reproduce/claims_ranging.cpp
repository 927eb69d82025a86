// SPDX-License-Identifier: Apache-2.0
// Claims on calibration and distances: chapters VIII to X.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/fathom/reproduce/claims.hpp"

namespace fathom::reproduce {
namespace {

void add_calibrations(const Calibrations& calibrations, std::vector<Claim>& claims) {
  static constexpr const char* kWhat[] = {"FFT: distance = b0 + b1 / position",
                                          "Normal Walsh: distance = b0 position^b1",
                                          "Sequency Walsh: distance = b0 position^b1"};
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const ThesisCalibration& thesis = kThesisCalibrations[t];
    const double r = calibrations[t].thesis_curve.r_squared;
    claims.push_back(
        {fmt::format("calibration-{}", t + 1), kWhat[t],
         fmt::format("p. {}, figs. {}\u2013{}", thesis.page, thesis.figure, thesis.figure + 1),
         fmt::format("R\u00B2 = {:.4f}", thesis.r_squared), fmt::format("R\u00B2 = {:.5f}", r),
         holds_if(r >= thesis.r_squared), "calibration"});
  }
}

int beyond(const std::vector<double>& errors, double limit) {
  return static_cast<int>(
      std::count_if(errors.begin(), errors.end(), [&](double e) { return std::abs(e) > limit; }));
}

void add_test(const std::vector<TableSet>& tables, int test, double limit, double average,
              const char* pages, std::vector<Claim>& claims) {
  const auto errors = errors_of(tables, test, &TableRow::old_way);
  const int outside = beyond(errors, limit);
  claims.push_back(
      {fmt::format("test-{}-all-but-one", test),
       fmt::format("Test {}: all but one measurement within {:g} %", test, 100 * limit), pages,
       "all but one", fmt::format("{} of {} beyond it", outside, errors.size()),
       holds_if(outside <= 1), "tables"});
  const double ours = summarise(row_differences(tables, test, &TableRow::old_way)).mean;
  const double own = summarise(row_differences(tables, test, &TableRow::own_way)).mean;
  claims.push_back({fmt::format("test-{}-average", test),
                    fmt::format("Test {}: average difference below {:g} %", test, 100 * average),
                    pages,
                    fmt::format("below {:g} %; its rows' mean is {}", 100 * average,
                                percent(summarise(thesis_differences(tables, test)).mean)),
                    fmt::format("{}; Fathom's own way {}", percent(ours), percent(own)),
                    holds_if(ours < average), "tables"});
}

void add_regressions(const std::vector<TableSet>& tables, std::vector<Claim>& claims) {
  for (const int test : {1, 2}) {
    std::string thesis, ours;
    bool all_as_good = true, all_good = true;
    for (const TableSet& set : tables) {
      if (set.test != test) continue;
      const double r = set.old_line.r_squared;
      thesis += fmt::format("{}{:.4f}", thesis.empty() ? "R\u00B2 " : ", ", set.thesis.r_squared);
      ours += fmt::format("{}{:.5f}", ours.empty() ? "R\u00B2 " : ", ", r);
      all_as_good = all_as_good && r >= set.thesis.r_squared - 5e-5;
      all_good = all_good && r >= 0.999;
    }
    claims.push_back(
        {fmt::format("test-{}-straight-line", test),
         fmt::format("Test {}: measured against actual distance is a straight line", test),
         test == 1 ? "pp. 78\u201381, figs. 21\u201324" : "pp. 82\u201388, figs. 25\u201330",
         thesis, ours, holds_if(all_as_good, all_good ? Mark::partly : Mark::fails), "tables"});
  }
}

void add_worst(const std::vector<TableSet>& tables, std::vector<Claim>& claims) {
  double worst_mm = 0, worst_part = 0;
  int within = 0, all = 0;
  for (const TableSet& set : tables) {
    for (const TableRow& row : set.rows) {
      for (const double mm : row.old_way.measured_mm) {
        const double off = std::abs(mm - row.actual_mm);
        worst_mm = std::max(worst_mm, off);
        worst_part = std::max(worst_part, off / row.actual_mm);
        ++all;
        if (off < half_depth_mm(row.actual_mm)) ++within;
      }
    }
  }
  claims.push_back({"worst-error", "The worst error is almost 30 mm, just over 1 %", "p. 90",
                    "30 mm, 1 %", fmt::format("{:.0f} mm, {}", worst_mm, percent(worst_part)),
                    holds_if(worst_mm <= 30, worst_mm <= 40 ? Mark::partly : Mark::fails),
                    "tables"});
  claims.push_back({"half-depth-of-field", "Errors stay below half of the depth of field", "p. 91",
                    "almost all", fmt::format("{} of {}", within, all),
                    holds_if(20 * within >= 19 * all, Mark::partly), "tables"});
}

void add_near(const Results& results, std::vector<Claim>& claims) {
  int near = 0, all = 0, near_rows = 0, rows = 0;
  for (const TableSet& set : results.tables) {
    if (set.target != "seedling") continue;
    for (const TableRow& row : set.rows) {
      ++rows;
      if (row.old_way.summary().mean < row.actual_mm) ++near_rows;
    }
  }
  double bias = 0;
  for (const Trial& plants : results.own.plants) {
    bias += plants.error.mean / kTransformCount;
    for (const FocusRun& run : plants.runs) {
      if (!run.focused()) continue;
      ++all;
      const auto& calibration = *results.calibrations[plants.transform].own;
      if (calibration.distance_mm(run.position) < run.distance_mm) ++near;
    }
  }
  claims.push_back(
      {"seedling-near", "The seedling reads near, because its needles stand before the stem",
       "pp. 91\u201392", "always slightly less",
       fmt::format("{} of {} rows near; {} of {} runs on other seedlings, by {} on average",
                   near_rows, rows, near, all, percent(-bias)),
       holds_if(near_rows == rows && near == all, bias < 0 ? Mark::partly : Mark::fails),
       "seedling"});
}

/// Scatter of the farthest rows over that of the nearest, over all seedlings of a test.
double growth(const std::vector<TableSet>& tables, int test) {
  double far = 0, near = 0;
  for (const TableSet& set : tables) {
    if (set.test != test || set.target == "orange") continue;  // The orange has two rows only.
    far += std::pow(set.rows.back().old_way.summary().sd, 2);
    near += std::pow(set.rows.front().old_way.summary().sd, 2);
  }
  return std::sqrt(far / near);
}

void add_growth(const std::vector<TableSet>& tables, std::vector<Claim>& claims) {
  // mm that a step is worth, far over near: the square of the distances less the focal length.
  const auto steps = [](double near_mm, double far_mm) {
    return std::pow((far_mm - 135) / (near_mm - 135), 2);
  };
  const auto text = [](double ratio, double of_steps) {
    return fmt::format(
        "scatter of the farthest rows {:.1f}\u00D7 that of the nearest; a step is worth "
        "{:.1f}\u00D7 as many mm there",
        ratio, of_steps);
  };
  const double first = growth(tables, 1), second = growth(tables, 2);
  claims.push_back({"test-1-grows", "Test 1: scatter grows with distance, as depth of field does",
                    "p. 92, figs. 22, 24", "seen in the plots", text(first, steps(1407, 2267)),
                    holds_if(first > 1.5), "tables"});
  claims.push_back({"test-2-does-not-grow", "Test 2: scatter does not grow with distance",
                    "p. 93, figs. 26, 28, 30", "seen in the plots", text(second, steps(1486, 2585)),
                    holds_if(second <= 1.5), "tables"});
}

}  // namespace

void add_claims_on_ranging(const Results& results, std::vector<Claim>& claims) {
  add_calibrations(results.calibrations, claims);
  add_test(results.tables, 1, 0.01, 0.005, "pp. 77, 92, table I", claims);
  add_test(results.tables, 2, 0.012, 0.0055, "pp. 82, 93, table II", claims);
  add_regressions(results.tables, claims);
  add_worst(results.tables, claims);
  add_near(results, claims);
  add_growth(results.tables, claims);
}

}  // namespace fathom::reproduce
