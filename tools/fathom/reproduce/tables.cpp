// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/tables.hpp"

#include <cmath>

namespace fathom::reproduce {
namespace {

void measure(TableSet& set, RowOutcome TableRow::*way, bool is_old, int per_distance,
             std::uint64_t seed, const ShouldStop& should_stop) {
  RigChoice choice;
  choice.target = set.target;
  choice.metric = kTransforms[set.transform].metric;
  Rig rig(options_of(choice, should_stop));
  Dice dice(seed);
  for (TableRow& row : set.rows) {
    const int count = per_distance > 0 ? per_distance : row.count;
    for (int i = 0; i < count; ++i) {
      const FocusRequest request = is_old ? thesis_request(row.actual_mm, dice) : FocusRequest{};
      (row.*way).runs.push_back(focus_run(rig, row.actual_mm, request));
    }
  }
}

template <typename Curve>
void range_runs(RowOutcome& outcome, const Curve& curve, bool judged) {
  for (const FocusRun& run : outcome.runs) {
    if (run.focused() || !judged) outcome.measured_mm.push_back(curve.distance_mm(run.position));
  }
}

Line regression(const TableSet& set, RowOutcome TableRow::*way) {
  std::vector<double> actual, measured;
  for (const TableRow& row : set.rows) {
    for (const double mm : (row.*way).measured_mm) {
      actual.push_back(row.actual_mm);
      measured.push_back(mm);
    }
  }
  return fit_line(actual, measured);
}

}  // namespace

double RowOutcome::difference_part(double actual_mm) const {
  return std::abs(summary().mean - actual_mm) / actual_mm;
}

int TableSet::thesis_points() const {
  int points = 0;
  for (const TableRow& row : rows) points += row.count;
  return points;
}

std::vector<TableSet> thesis_tables() {
  const auto row = [](double actual, double measured, double percent, double three_sd, int count) {
    return TableRow{actual, measured, percent, three_sd, count, {}, {}};
  };
  const auto test_2 = [](std::size_t transform, int figure, int page, Line regression,
                         std::vector<TableRow> rows) {
    return TableSet{2,    "pine seedling", "seedling",      transform, figure,
                    page, regression,      std::move(rows), {},        {}};
  };
  return {{1,
           "pine seedling",
           "seedling",
           kFft,
           21,
           78,
           {4.93, 0.99, 0.9998},
           {row(1407, 1398, 0.64, 9.8, 5), row(1429, 1421, 0.56, 6.7, 4),
            row(1892, 1876, 0.85, 7.8, 4), row(2267, 2250, 0.75, 20.3, 4)},
           {},
           {}},
          {1,
           "orange",
           "orange",
           kFft,
           23,
           80,
           {-22.94, 1.01, 0.9994},
           {row(1864, 1860, 0.21, 15.5, 6), row(2508, 2511, 0.12, 25.9, 5)},
           {},
           {}},
          test_2(kFft, 25, 83, {12.020, 0.9879, 0.9997},
                 {row(1486, 1481, 0.31, 15.5, 7), row(1918, 1901, 0.89, 23.4, 7),
                  row(2585, 2566, 0.72, 17.5, 7)}),
          test_2(kPaley, 27, 85, {-2.840, 0.9986, 0.9998},
                 {row(1486, 1478, 0.53, 14.0, 8), row(1918, 1919, 0.07, 25.1, 7),
                  row(2585, 2577, 0.29, 18.0, 7)}),
          test_2(kSequency, 29, 87, {-7.142, 0.9978, 0.9999},
                 {row(1486, 1476, 0.67, 14.2, 7), row(1918, 1904, 0.70, 0.0, 7),
                  row(2585, 2572, 0.48, 18.0, 7)})};
}

void plan_tables(std::vector<TableSet>& sets, const Effort& effort, const ShouldStop& should_stop,
                 Tasks& tasks) {
  sets = thesis_tables();
  for (std::size_t i = 0; i < sets.size(); ++i) {
    TableSet& set = sets[i];
    const int per_distance = effort.per_distance;
    tasks.emplace_back([&set, i, per_distance, should_stop] {
      measure(set, &TableRow::old_way, true, per_distance, 200 + i, should_stop);
    });
    tasks.emplace_back([&set, i, per_distance, should_stop] {
      measure(set, &TableRow::own_way, false, per_distance, 300 + i, should_stop);
    });
  }
}

void finish_tables(std::vector<TableSet>& sets, const Calibrations& calibrations) {
  for (TableSet& set : sets) {
    const CalibrationPair& pair = calibrations[set.transform];
    for (TableRow& row : set.rows) {
      range_runs(row.old_way, pair.thesis_curve, false);
      range_runs(row.own_way, *pair.own, true);
    }
    set.old_line = regression(set, &TableRow::old_way);
    set.own_line = regression(set, &TableRow::own_way);
  }
}

std::vector<double> errors_of(const std::vector<TableSet>& sets, int test,
                              RowOutcome TableRow::*way) {
  std::vector<double> errors;
  for (const TableSet& set : sets) {
    if (test != 0 && set.test != test) continue;
    for (const TableRow& row : set.rows) {
      for (const double mm : (row.*way).measured_mm) {
        errors.push_back((mm - row.actual_mm) / row.actual_mm);
      }
    }
  }
  return errors;
}

std::vector<double> row_differences(const std::vector<TableSet>& sets, int test,
                                    RowOutcome TableRow::*way) {
  std::vector<double> differences;
  for (const TableSet& set : sets) {
    if (test != 0 && set.test != test) continue;
    for (const TableRow& row : set.rows) {
      differences.push_back((row.*way).difference_part(row.actual_mm));
    }
  }
  return differences;
}

std::vector<double> thesis_differences(const std::vector<TableSet>& sets, int test) {
  std::vector<double> differences;
  for (const TableSet& set : sets) {
    if (set.test != test) continue;
    for (const TableRow& row : set.rows) differences.push_back(row.thesis_percent / 100);
  }
  return differences;
}

}  // namespace fathom::reproduce
