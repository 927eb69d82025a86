// SPDX-License-Identifier: Apache-2.0
// Fathom's own way, and what breaks a search: the orange's rind, small windows, a whole travel.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/fathom/reproduce/calibrations.hpp"

namespace fathom::reproduce {

/// Runs of one kind, and what they came to.
struct Trial {
  std::string name;              ///< What sets it apart from the others of its kind.
  std::size_t transform = kFft;  ///< Whose calibration turns positions into distances.
  bool judged = true;  ///< False: the answer counts whatever the verdict, as in the thesis.
  std::vector<FocusRun> runs = {};

  // Of finish_trial():
  int answers = 0;  ///< Runs that gave a distance.
  int wrong = 0;    ///< Distances off by more than half of the depth of field.
  int no_focus = 0;
  int others = 0;      ///< At a limit, or ambiguous.
  Summary error = {};  ///< (measured - actual) / actual of the answers.
  Summary size = {};   ///< Its absolute value.
  Summary evaluations = {};
};

void finish_trial(Trial& trial, const Calibrations& calibrations);

/// Adds the runs of a trial to the tasks, in pieces. one: a run by its index alone.
using OneRun = std::function<FocusRun(int index)>;
void add_runs(Trial& trial, int count, const OneRun& one, Tasks& tasks);

inline constexpr double kNearest = 1400, kFarthest = 2600;  ///< mm, of the thesis' tables (p. 89).

/// A search on a rig of its own.
FocusRun run_on(const RigChoice& choice, double distance_mm, const FocusRequest& request,
                const ShouldStop& should_stop);

/// Fathom's own way; each vector has a trial for each transform.
struct OwnWay {
  std::vector<Trial> whole;    ///< The chart, over the whole travel.
  std::vector<Trial> working;  ///< The chart, told the working range.
  std::vector<Trial> plants;   ///< Seedlings, each another.
  Trial random, blank;         ///< Random rigs, with and without texture.
};
inline constexpr double kWorkingFrom = 500, kWorkingTo = 1060;  // steps
void plan_own_way(OwnWay& own, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks);

/// A patch of an orange: window sides, the thesis' search without a verdict and Fathom's way.
struct Orange {
  struct Patch {
    int side = 0;
    double distance_mm = 0;
    Trial old_way, own_way;
  };
  std::vector<Patch> patches;
  /// A sweep over the rind for each side, score as a part of the highest.
  struct Sweep {
    int side = 0;
    double truth = 0;
    std::vector<double> positions, scores;
  };
  std::vector<Sweep> sweeps;
};
void plan_orange(Orange& orange, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks);

/// Searches and window sides compared on the same targets.
struct Searches {
  std::vector<Trial> bracketed;  ///< golden, fibonacci, brent from the same brackets.
  std::vector<Trial> bare;       ///< Golden section over the whole travel, a trial a transform.
  struct Side {
    int side = 0;
    Trial chart, seedling;
  };
  std::vector<Side> sides;
};
void plan_searches(Searches& searches, const Effort& effort, const ShouldStop& should_stop,
                   Tasks& tasks);

}  // namespace fathom::reproduce
