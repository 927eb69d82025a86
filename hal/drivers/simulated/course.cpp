// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/course.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

namespace fathom::simulated {

Course::Course(std::vector<int> legs, std::int64_t begun_ns, double rate)
    : legs_(std::move(legs)), leg_begun_ns_(begun_ns), rate_(rate) {}

std::int64_t Course::next_ns() const {
  return leg_begun_ns_ + std::llround((made_ + 1) / rate_ * 1e9);
}

void Course::advance() {
  const std::int64_t now_ns = next_ns();
  if (++made_ < std::abs(legs_[leg_])) return;
  leg_begun_ns_ = now_ns;
  made_ = 0;
  ++leg_;
}

}  // namespace fathom::simulated
