// SPDX-License-Identifier: Apache-2.0
#include "session/rehearsal.hpp"

#include <cmath>

namespace fathom {

Rehearsal::Rehearsal(Rig& rig, const FocusRequest& request, int repeats)
    : limits_(resolve_limits(request, rig.lens().info())),
      window_(rig.window()),
      plan_(rig.selection().device->plan(rig.spec(), 1)) {
  const LensReturn put_back(rig.lens());
  const ShotOptions& how = rig.options().shot;
  const Arrival start = rig.lens().move_to(rig.lens().nearest(limits_.from));
  for (int i = 0; i < repeats; ++i)
    repeats_.push_back(take_frame(rig.camera(), start.settled_ns, how).clone());
  std::int64_t first_ns = -1, last_ns = 0;
  const auto take = [&](double position) {
    const Shot shot = shoot(rig.camera(), rig.lens(), position, how);
    last_ns = shot.frame.exposure.end_ns;
    if (first_ns < 0) first_ns = last_ns;
    return plan_->score(pictures_[shot.arrival.position] = shot.frame.clone(), window_);
  };
  const auto nearest = [&](double position) { return rig.lens().nearest(position); };
  const Focus focus = search_focus({take, nearest}, limits_, rig.spec(), 0);
  const auto cycles = static_cast<double>(focus.evaluations.size()) - 1;
  if (cycles > 0) cycle_s_ = 1e-9 * static_cast<double>(last_ns - first_ns) / cycles;
}

double Rehearsal::score_at(double position) {
  return plan_->score(pictures_.at(position), window_);
}

Focus Rehearsal::run() {
  std::vector<double> repeated;
  for (const Frame& picture : repeats_) repeated.push_back(plan_->score(picture, window_));
  // The lens would take a position that there is a picture of, and the nearest one is that.
  const auto nearest = [this](double wanted) {
    auto above = pictures_.lower_bound(wanted);
    if (above == pictures_.begin()) return above->first;
    const auto below = std::prev(above);
    const bool is_above = above != pictures_.end() && above->first - wanted < wanted - below->first;
    return is_above ? above->first : below->first;
  };
  return search_focus({[this](double position) { return score_at(position); }, nearest}, limits_,
                      plan_->spec(), relative_scatter(repeated));
}

}  // namespace fathom
