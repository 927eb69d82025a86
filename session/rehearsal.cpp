// SPDX-License-Identifier: Apache-2.0
#include "session/rehearsal.hpp"

#include "focus/noise.hpp"
#include "session/session.hpp"

namespace fathom {

/// Keeps the pictures of a search: those before it begins are the repeated ones.
class Rehearsal::Keeper final : public Observer {
 public:
  explicit Keeper(Rehearsal& rehearsal) : rehearsal_(rehearsal) {}

  void began(const Run&, std::size_t) override { has_begun_ = true; }
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double>) override {
    if (!has_begun_) return rehearsal_.repeats_.push_back(frame.clone());
    rehearsal_.pictures_[arrival.position] = frame.clone();
  }

 private:
  Rehearsal& rehearsal_;
  bool has_begun_ = false;
};

Rehearsal::Rehearsal(Rig& rig, const FocusRequest& request)
    : window_(rig.window()),
      plan_(rig.selection().device->plan(rig.spec(), 1)),
      share_(*rig.selection().device, rig.spec()),
      reader_(*rig.selection().device, rig.spec(), rig.window()) {
  const LensReturn put_back(rig.lens());
  Keeper keeper(*this);
  FocusRequest halting = request;
  halting.moving = false;  // a picture at every position that the search may ask for again
  const Run run = Session(rig).focus(halting, keeper);
  limits_ = *run.limits;
  const auto cycles = static_cast<double>(run.measurements.size()) - 1;
  if (cycles > 0) {
    const std::int64_t span_ns =
        run.measurements.back().exposure.end_ns - run.measurements.front().exposure.end_ns;
    cycle_s_ = 1e-9 * static_cast<double>(span_ns) / cycles;
  }
}

Sample Rehearsal::sample_of(const Frame& picture) {
  return {BrightnessShare::without(plan_->score(picture, window_), share_.of(picture, window_)),
          reader_.read(picture)};
}

Focus Rehearsal::run() {
  std::vector<double> repeated;
  for (const Frame& picture : repeats_) repeated.push_back(sample_of(picture).score);
  // The lens would take a position that there is a picture of, and the nearest one is that.
  const auto nearest = [this](double wanted) {
    auto above = pictures_.lower_bound(wanted);
    if (above == pictures_.begin()) return above->first;
    const auto below = std::prev(above);
    const bool is_above = above != pictures_.end() && above->first - wanted < wanted - below->first;
    return is_above ? above->first : below->first;
  };
  const auto sample = [this](double position) { return sample_of(pictures_.at(position)); };
  return search_focus({sample, nearest}, limits_, plan_->spec(), relative_scatter(repeated));
}

}  // namespace fathom
