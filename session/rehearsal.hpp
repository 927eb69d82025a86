// SPDX-License-Identifier: Apache-2.0
// A focus search over pictures that were taken before: what it costs once lens and camera are taken
// out.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "../focus/focus.hpp"
#include "rig.hpp"

namespace fathom {

class Rehearsal {
 public:
  /// Searches once on the rig, keeps every picture and puts the lens back. Throws as
  /// Session::focus.
  Rehearsal(Rig& rig, const FocusRequest& request);

  /// The same search again, from pictures to verdict. Its positions are the first one's.
  Focus run();

  /// Time of one picture with its move and its settling, on the rig's clock: a mean, in seconds.
  double cycle_s() const { return cycle_s_; }

 private:
  class Keeper;

  Sample sample_of(const Frame& picture);

  FocusLimits limits_;
  Window window_;
  std::unique_ptr<Plan> plan_;  // of the rig's device, as these:
  BrightnessShare share_;
  PictureReader reader_;
  std::map<double, Frame> pictures_;  // by position
  std::vector<Frame> repeats_;        // of the first position, for the scatter of a score
  double cycle_s_ = 0;
};

}  // namespace fathom
