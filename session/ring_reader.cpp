// SPDX-License-Identifier: Apache-2.0
#include "session/ring_reader.hpp"

#include <algorithm>

#include "backends/backends.hpp"
#include "focus/blur.hpp"

namespace fathom {
namespace {

Window widened(const Window& window, int side, int width_px, int height_px) {
  const int more = (side - window.n) / 2;
  return {std::clamp(window.x - more, 0, width_px - side),
          std::clamp(window.y - more, 0, height_px - side), side};
}

}  // namespace

MetricSpec rings_metric(int side) {
  MetricSpec spec = MetricSpec::standard(Transform::fft, side);
  spec.power = true;
  spec.measure = Measure::rings;
  spec.rings = rings_of_side(side);
  return spec;
}

RingReader::RingReader(const Window& window, int width_px, int height_px) {
  if (rings_of_side(window.n) == 0) return;  // the wide window alone shows something else
  for (const int side : {window.n, 2 * window.n}) {
    if (rings_of_side(side) == 0 || side > std::min(width_px, height_px)) continue;
    const MetricSpec spec = rings_metric(side);
    scorers_.emplace_back(select_device(all_backends(), "auto", spec, 1), spec,
                          widened(window, side, width_px, height_px));
  }
}

std::vector<RingPowers> RingReader::read(const Frame& frame) {
  std::vector<RingPowers> all;
  for (Scorer& scorer : scorers_) {
    values_.resize(scorer.outputs());
    scorer.score(frame, values_);
    all.push_back({scorer.spec().n, {values_.begin(), values_.end()}});
  }
  return all;
}

}  // namespace fathom
