// SPDX-License-Identifier: Apache-2.0
// A move that is under way: which steps are to come, and when.
#pragma once

#include <cstdint>
#include <vector>

namespace fathom::simulated {

class Course {
 public:
  /// legs: relative moves in steps, in order, none of them 0; rate: steps/s. A leg of n steps takes
  /// as long as Motor::step_ns says, and each of its steps the same part of that.
  Course(std::vector<int> legs, std::int64_t begun_ns, double rate);

  bool is_over() const { return leg_ == legs_.size(); }

  // Of the next step, before the end of the course:
  std::int64_t next_ns() const;  ///< When it has been made.
  int direction() const { return legs_[leg_] > 0 ? 1 : -1; }
  bool begins_leg() const { return made_ == 0; }
  int leg() const { return legs_[leg_]; }

  /// The next step has been made.
  void advance();

 private:
  std::vector<int> legs_;
  std::int64_t leg_begun_ns_;
  double rate_;
  std::size_t leg_ = 0;
  int made_ = 0;  // steps of this leg
};

}  // namespace fathom::simulated
