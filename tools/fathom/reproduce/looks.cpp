// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/looks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "backends/backends.hpp"
#include "engine/measure.hpp"

namespace fathom::reproduce {
namespace {

constexpr double kHighest = 0.5;  // cycles per pixel of the last band

/// Keeps the picture that was taken last.
class LastFrame final : public Observer {
 public:
  explicit LastFrame(Frame& kept) : kept_(kept) {}
  void frame(const Frame& frame, const Arrival&, std::span<const double>) override {
    kept_ = frame.clone();
  }

 private:
  Frame& kept_;
};

double measured(const MetricSpec& spec, std::span<const std::complex<double>> coefficients) {
  double value = 0;
  SpectrumMeasure measure(spec);
  measure(coefficients, {&value, 1});
  return value;
}

/// What every band adds to the score; the last has the rest.
std::vector<double> bands_of(const MetricSpec& spec,
                             std::span<const std::complex<double>> coefficients) {
  std::vector<double> bands;
  for (int i = 0; i < kBands; ++i) {
    MetricSpec part = spec;
    part.band = Band{kHighest * i / kBands, kHighest * (i + 1) / kBands};
    bands.push_back(measured(part, coefficients));
  }
  MetricSpec inner = spec;
  inner.band = Band{0, kHighest};
  bands.push_back(measured(spec, coefficients) - measured(inner, coefficients));
  return bands;
}

SpectrumLook spectrum_look(std::size_t transform, const Frame& frame, const Window& window) {
  const MetricSpec spec = MetricSpec::parse(kTransforms[transform].metric);
  SpectrumLook look{.transform = transform, .coefficients = {}, .score = 0, .bands = {}};
  look.coefficients.resize(static_cast<std::size_t>(spec.n) * spec.n);
  Selection selection = select_device(all_backends(), "", spec, 1);
  selection.device->plan(spec, 1)->spectrum(frame, window, look.coefficients);
  look.score = Scorer(std::move(selection), spec, window).score(frame);
  look.bands = bands_of(spec, look.coefficients);
  return look;
}

void take(Look& look, const ShouldStop& should_stop) {
  RigChoice choice;
  choice.target = kTargets[look.target];
  choice.more = fmt::format(",distance={}", kLookDistance);
  Rig rig(options_of(choice, should_stop));
  const double focus = std::round(true_position(kLookDistance));
  look.position = look.sharp ? focus : focus - kBlurSteps;
  LastFrame observer(look.frame);
  Session(rig).visit({look.position}, observer);
  look.window = rig.window();
  if (look.target != kChart) return;
  for (const std::size_t transform : kShown) {
    look.spectra.push_back(spectrum_look(transform, look.frame, look.window));
  }
}

}  // namespace

double SpectrumLook::between(double low, double high) const {
  const auto band = [&](double frequency) { return std::lround(frequency / kHighest * kBands); };
  return std::accumulate(bands.begin() + band(low), bands.begin() + band(high), 0.0);
}

const Look& Looks::find(std::size_t target, bool sharp) const {
  for (const Look& look : looks) {
    if (look.target == target && look.sharp == sharp) return look;
  }
  throw std::out_of_range("no such look");
}

void plan_looks(Looks& looks, const ShouldStop& should_stop, Tasks& tasks) {
  for (const bool sharp : {true, false}) {
    for (std::size_t target = 0; target < std::size(kTargets); ++target) {
      looks.looks.push_back({.target = target,
                             .sharp = sharp,
                             .position = 0,
                             .frame = {},
                             .window = {},
                             .spectra = {}});
    }
  }
  for (Look& look : looks.looks) {
    tasks.emplace_back([&look, should_stop] { take(look, should_stop); });
  }
}

}  // namespace fathom::reproduce
