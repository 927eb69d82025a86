// SPDX-License-Identifier: Apache-2.0
#include "session/spectrum_keeper.hpp"

#include "backends/backends.hpp"
#include "calibration/likeness.hpp"

namespace fathom {
namespace {

/// Eight samples and more of a period are what rings need.
constexpr int kSmallestSide = 2 * kSpectrumRings;

MetricSpec spectrum_metric(int side) {
  MetricSpec spec = MetricSpec::standard(Transform::fft, side);
  spec.measure = Measure::rings;
  spec.rings = kSpectrumRings;
  return spec;
}

}  // namespace

SpectrumKeeper::SpectrumKeeper(const Window& window) : window_(window) {}

void SpectrumKeeper::begin() {
  best_ = seen_ = 0;
  spectrum_.clear();
}

void SpectrumKeeper::see(const Frame& frame, double score) {
  seen_ = 0;
  if (window_.n < kSmallestSide || !(score > best_)) return;
  if (!scorer_) {
    const MetricSpec spec = spectrum_metric(window_.n);
    scorer_ =
        std::make_unique<Scorer>(select_device(all_backends(), "auto", spec, 1), spec, window_);
  }
  seen_ = score;
  seen_spectrum_.resize(scorer_->outputs());
  scorer_->score(frame, seen_spectrum_);
}

void SpectrumKeeper::keep() {
  if (!(seen_ > best_)) return;
  best_ = seen_;
  spectrum_ = seen_spectrum_;
}

}  // namespace fathom
