// SPDX-License-Identifier: Apache-2.0
// Tables I and II and figures 21 to 30: objects at known distances, and what was measured.
#pragma once

#include <string>
#include <vector>

#include "tools/fathom/reproduce/calibrations.hpp"

namespace fathom::reproduce {

/// What came out of one row's runs.
struct RowOutcome {
  std::vector<FocusRun> runs;       ///< All, in order.
  std::vector<double> measured_mm;  ///< Of the thesis' runs all, of the others those that focused.

  Summary summary() const { return summarise(measured_mm); }
  /// |mean - actual| / actual, as the thesis' "average percent difference" is.
  double difference_part(double actual_mm) const;
};

/// A distance of a table, with the thesis' own numbers.
struct TableRow {
  double actual_mm;
  double thesis_mm;
  double thesis_percent;
  double thesis_three_sd_mm;
  int count;  ///< Runs: the thesis gives only their sum over the rows.
  RowOutcome old_way, own_way;
};

/// Rows that share object and transform, and one regression.
struct TableSet {
  int test;
  std::string object;  ///< As the thesis calls it.
  std::string target;  ///< As the simulated rig calls it.
  std::size_t transform;
  int figure;  ///< Of the regression; the next one shows its residuals.
  int page;
  Line thesis;
  std::vector<TableRow> rows;
  Line old_line, own_line;

  int thesis_points() const;
};

std::vector<TableSet> thesis_tables();

void plan_tables(std::vector<TableSet>& sets, const Effort& effort, const ShouldStop& should_stop,
                 Tasks& tasks);
void finish_tables(std::vector<TableSet>& sets, const Calibrations& calibrations);

/// (measured - actual) / actual of every run of the sets of a test; 0: of both.
std::vector<double> errors_of(const std::vector<TableSet>& sets, int test,
                              RowOutcome TableRow::*way);
/// The difference_part() of every row of a test, and the thesis' own as parts.
std::vector<double> row_differences(const std::vector<TableSet>& sets, int test,
                                    RowOutcome TableRow::*way);
std::vector<double> thesis_differences(const std::vector<TableSet>& sets, int test);

}  // namespace fathom::reproduce
