// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/trials.hpp"

#include <fmt/format.h>

#include <cmath>

#include "session/session.hpp"

namespace fathom::reproduce {
namespace {

constexpr int kRunsPerTask = 10;

}  // namespace

void add_runs(Trial& trial, int count, const OneRun& one, Tasks& tasks) {
  trial.runs.resize(static_cast<std::size_t>(count));
  for (int first = 0; first < count; first += kRunsPerTask) {
    tasks.emplace_back([&trial, first, count, one] {
      for (int i = first; i < std::min(first + kRunsPerTask, count); ++i) {
        trial.runs[static_cast<std::size_t>(i)] = one(i);
      }
    });
  }
}

FocusRun run_on(const RigChoice& choice, double distance_mm, const FocusRequest& request,
                const ShouldStop& should_stop) {
  RigChoice placed = choice;
  placed.more += fmt::format(",distance={:.17g}", distance_mm);
  Rig rig(options_of(placed, should_stop));
  return focus_run(rig, distance_mm, request);
}

namespace {

/// A rig of a random kind at a random distance, all by one number.
FocusRun random_run(int index, std::uint64_t seed, const std::vector<std::string>& targets,
                    const ShouldStop& should_stop) {
  Dice dice(seed + static_cast<std::uint64_t>(index));
  RigChoice choice;
  choice.target = targets[static_cast<std::size_t>(dice.below(static_cast<int>(targets.size())))];
  choice.metric = kTransforms[dice.below(kTransformCount)].metric;
  choice.seed = static_cast<std::uint64_t>(dice.below(1000000));
  choice.more = fmt::format(",noise={:.3f},start={}", dice.between(0.5, 2), dice.below(1200));
  return run_on(choice, dice.between(kNearest, kFarthest), {}, should_stop);
}

}  // namespace

void finish_trial(Trial& trial, const Calibrations& calibrations) {
  const Calibration& calibration = *calibrations[trial.transform].own;
  std::vector<double> errors, sizes, evaluations;
  for (const FocusRun& run : trial.runs) {
    evaluations.push_back(run.evaluations);
    if (trial.judged && !run.focused()) {
      ++(run.result == FocusResult::no_focus ? trial.no_focus : trial.others);
      continue;
    }
    const double mm = calibration.distance_mm(run.position);
    const double error = (mm - run.distance_mm) / run.distance_mm;
    ++trial.answers;
    if (!(std::abs(mm - run.distance_mm) <= half_depth_mm(run.distance_mm))) ++trial.wrong;
    errors.push_back(error);
    sizes.push_back(std::abs(error));
  }
  trial.error = summarise(errors);
  trial.size = summarise(sizes);
  trial.evaluations = summarise(evaluations);
}

void plan_own_way(OwnWay& own, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks) {
  const auto trials = [](const char* name) {
    std::vector<Trial> all;
    for (std::size_t t = 0; t < kTransformCount; ++t) all.push_back({name, t, true, {}});
    return all;
  };
  own = {trials("chart, whole travel"),
         trials("chart, told the working range"),
         trials("seedlings"),
         {"random rigs", kFft, true, {}},
         {"blank card", kFft, true, {}}};
  const auto add = [&](std::vector<Trial>& kind, int count, std::uint64_t seed, bool is_working,
                       const std::string& target) {
    for (std::size_t t = 0; t < kTransformCount; ++t) {
      const OneRun one = [=](int i) {
        Dice dice(seed + static_cast<std::uint64_t>(i));
        RigChoice choice;
        choice.target = target;
        choice.metric = kTransforms[t].metric;
        choice.seed = kSeed + static_cast<std::uint64_t>(target == "seedling" ? i : 0);
        choice.more = fmt::format(",start={}", dice.below(1200));
        const FocusRequest request =
            is_working ? FocusRequest::within(kWorkingFrom, kWorkingTo) : FocusRequest{};
        return run_on(choice, dice.between(kNearest, kFarthest), request, should_stop);
      };
      add_runs(kind[t], count, one, tasks);
    }
  };
  add(own.whole, effort.own_distances, 1000, false, "usaf");
  add(own.working, effort.own_distances, 2000, true, "usaf");
  add(own.plants, effort.plants, 3000, false, "seedling");
  const auto textured = [should_stop](int i) {
    return random_run(i, 10000, {"usaf", "seedling", "orange"}, should_stop);
  };
  const auto blank = [should_stop](int i) { return random_run(i, 20000, {"blank"}, should_stop); };
  add_runs(own.random, effort.random_runs, textured, tasks);
  add_runs(own.blank, effort.blank_runs, blank, tasks);
}

void plan_orange(Orange& orange, const Effort& effort, const ShouldStop& should_stop,
                 Tasks& tasks) {
  constexpr double kSwept = 1864;
  for (const int side : {64, 32, 16}) {
    for (const double distance : {1864.0, 2508.0}) {
      orange.patches.push_back(
          {side, distance, {"golden section", kFft, false, {}}, {"own way", kFft, true, {}}});
    }
    orange.sweeps.push_back({side, true_position(kSwept), {}, {}});
  }
  const auto choice_of = [](int side, int index) {
    RigChoice choice;
    choice.target = "orange";
    choice.metric = fmt::format("fft:{}:hann", side);
    choice.seed = kSeed + static_cast<std::uint64_t>(index);
    return choice;
  };
  const auto count = static_cast<std::size_t>(effort.orange_runs);
  for (Orange::Patch& patch : orange.patches) {
    patch.old_way.runs.resize(count);
    patch.own_way.runs.resize(count);
    tasks.emplace_back([&patch, count, choice_of, should_stop] {
      for (std::size_t i = 0; i < count; ++i) {  // Each on another orange; drawing one takes long.
        Dice dice(4000 + i);
        Rig rig(options_of(choice_of(patch.side, static_cast<int>(i)), should_stop));
        const double mm = patch.distance_mm;
        patch.old_way.runs[i] = focus_run(rig, mm, thesis_request(mm, dice));
        patch.own_way.runs[i] = focus_run(rig, mm, {});
      }
    });
  }
  for (Orange::Sweep& sweep : orange.sweeps) {
    tasks.emplace_back(
        [&sweep, choice = choice_of(sweep.side, 0), step = effort.quick ? 20 : 10, should_stop] {
          Rig rig(options_of(choice, should_stop));
          rig.stage()->place_at(kSwept);
          Observer nobody;
          const auto seen =
              Session(rig).sweep({400, 1100, static_cast<double>(step)}, nobody).evaluations();
          for (const Evaluation& e : seen) {
            sweep.positions.push_back(e.position);
            sweep.scores.push_back(e.score / best_of(seen).score);
          }
        });
  }
}

void plan_searches(Searches& searches, const Effort& effort, const ShouldStop& should_stop,
                   Tasks& tasks) {
  constexpr SearchMethod kMethods[] = {SearchMethod::golden, SearchMethod::fibonacci,
                                       SearchMethod::brent};
  for (const SearchMethod method : kMethods) {
    searches.bracketed.push_back({to_string(method), kFft, false, {}});
  }
  for (std::size_t t = 0; t < kTransformCount; ++t) searches.bare.push_back({"bare", t, false, {}});
  for (const int side : {16, 32, 64, 128}) {
    searches.sides.push_back({side, {"chart", kFft, true, {}}, {"seedling", kFft, true, {}}});
  }
  for (std::size_t m = 0; m < std::size(kMethods); ++m) {
    const OneRun one = [=](int i) {
      Dice dice(5000 + static_cast<std::uint64_t>(i));
      const double distance = dice.between(kNearest, kFarthest);
      return run_on({}, distance, thesis_request(distance, dice, kMethods[m]), should_stop);
    };
    add_runs(searches.bracketed[m], effort.search_runs, one, tasks);
  }
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const OneRun one = [=](int i) {
      Dice dice(6000 + static_cast<std::uint64_t>(i));
      RigChoice choice;
      choice.target = "seedling";
      choice.metric = kTransforms[t].metric;
      FocusRequest request;
      request.search = SearchMethod::golden;
      request.peak = PeakMethod::evaluated;
      request.bracket = whole_range(0, 1200);
      return run_on(choice, dice.between(kNearest, kFarthest), request, should_stop);
    };
    add_runs(searches.bare[t], effort.search_runs, one, tasks);
  }
  for (Searches::Side& side : searches.sides) {
    for (const bool is_chart : {true, false}) {
      const OneRun one = [=, n = side.side](int i) {
        Dice dice(7000 + static_cast<std::uint64_t>(i));
        RigChoice choice;
        choice.target = is_chart ? "usaf" : "seedling";
        choice.metric = fmt::format("fft:{}:hann", n);
        return run_on(choice, dice.between(kNearest, kFarthest), {}, should_stop);
      };
      add_runs(is_chart ? side.chart : side.seedling, effort.side_runs, one, tasks);
    }
  }
}

}  // namespace fathom::reproduce
