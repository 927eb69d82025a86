// SPDX-License-Identifier: Apache-2.0
// Searches against each other on the same scenes of the simulated rig: what each costs, how near it
// comes, and where it is trapped.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "focus/focus.hpp"
#include "session/rig.hpp"

namespace fathom {

/// One way to search, as it stands in the table.
struct Contender {
  std::string name;
  SearchMethod search = SearchMethod::automatic;
  PeakMethod peak = PeakMethod::fit;
  bool is_bare = false;  ///< Over the whole travel at once, without a coarse pass.
};

/// The thesis' golden section, bare and after a coarse pass, fibonacci and brent alike; hill, full,
/// coarse, spectral and auto. The rig knows its own blur.
std::vector<Contender> all_contenders();

/// What the searches are tried on: every target at every distance, noise, lens start and seed.
struct ComparisonScenes {
  std::vector<std::string> targets = {"usaf", "seedling", "orange"};
  std::vector<double> distances_mm = {1500, 2400};
  std::vector<double> noises = {1, 2};
  std::vector<double> starts = {0, 600};
  int seeds = 1;

  std::size_t count() const {
    return targets.size() * distances_mm.size() * noises.size() * starts.size() *
           static_cast<std::size_t>(seeds);
  }
};

/// How one search did over all scenes.
struct SearchTally {
  Contender contender;
  int runs = 0;
  int right = 0;     ///< Focused, off by less than half of the depth of field (thesis eq. 3-3).
  int trapped = 0;   ///< Ended farther off than that, on a local maximum or on the floor.
  int wrong = 0;     ///< Trapped, and said to be focused: what must not happen.
  int declined = 0;  ///< At the right place, but not said to be focused.
  std::vector<double> evaluations = {};     ///< Of every run.
  std::vector<double> errors_percent = {};  ///< |found - true| / true of the right ones.
  std::vector<double> moved_steps = {};     ///< Travel of the lens of every run, in its unit.
};

/// Runs every contender on every scene. Distances come from a calibration of the same target, made
/// by default searches without noise. options: of every rig, but for its text. told: after every
/// run, how many are done. Deterministic. Throws as Rig.
std::vector<SearchTally> compare_searches(const std::vector<Contender>& contenders,
                                          const ComparisonScenes& scenes, const RigOptions& options,
                                          const std::function<void(std::size_t done)>& told);

}  // namespace fathom
