// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/results.hpp"

namespace fathom::reproduce {
namespace {

void finish_trials(Results& results) {
  const Calibrations& calibrations = results.calibrations;
  const auto all = [&](std::vector<Trial>& trials) {
    for (Trial& trial : trials) finish_trial(trial, calibrations);
  };
  all(results.own.whole);
  all(results.own.working);
  all(results.own.plants);
  finish_trial(results.own.random, calibrations);
  finish_trial(results.own.blank, calibrations);
  for (Orange::Patch& patch : results.orange.patches) {
    finish_trial(patch.old_way, calibrations);
    finish_trial(patch.own_way, calibrations);
  }
  all(results.searches.bracketed);
  all(results.searches.bare);
  for (Searches::Side& side : results.searches.sides) {
    finish_trial(side.chart, calibrations);
    finish_trial(side.seedling, calibrations);
  }
  finish_ways(results.ways, calibrations);
}

}  // namespace

void run_experiments(Results& results, const ShouldStop& should_stop,
                     const std::function<void(std::size_t, std::size_t)>& on_done) {
  Tasks tasks;
  plan_calibrations(results.calibrations, results.effort, should_stop, tasks);
  plan_tables(results.tables, results.effort, should_stop, tasks);
  plan_looks(results.looks, should_stop, tasks);
  plan_curves(results.curves, results.effort, should_stop, tasks);
  plan_repeatability(results.repeatability, results.effort, should_stop, tasks);
  plan_own_way(results.own, results.effort, should_stop, tasks);
  plan_orange(results.orange, results.effort, should_stop, tasks);
  plan_searches(results.searches, results.effort, should_stop, tasks);
  plan_ways(results.ways, results.effort, should_stop, tasks);
  run_all(tasks, on_done);
  finish_calibrations(results.calibrations);
  finish_tables(results.tables, results.calibrations);
  finish_curves(results.curves);
  finish_trials(results);
}

}  // namespace fathom::reproduce
