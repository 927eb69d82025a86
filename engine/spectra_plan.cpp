// SPDX-License-Identifier: Apache-2.0
#include "engine/spectra_plan.hpp"

#include <complex>
#include <vector>

#include "engine/measure.hpp"

namespace fathom {
namespace {

class SpectraPlan final : public Plan {
 public:
  SpectraPlan(std::unique_ptr<Plan> plain, const MetricSpec& spec, std::size_t capacity)
      : Plan(spec, capacity),
        plain_(std::move(plain)),
        measure_(spec),
        coefficients_(static_cast<std::size_t>(spec.n) * spec.n) {}

 private:
  void do_submit(std::uint64_t, const Frame& frame, std::span<const Window> windows,
                 std::span<double> values) override {
    const std::size_t outputs = spec().outputs();
    for (std::size_t i = 0; i < windows.size(); ++i) {
      plain_->spectrum(frame, windows[i], coefficients_);
      measure_(coefficients_, values.subspan(i * outputs, outputs));
    }
  }

  void do_wait(std::uint64_t) override {}  // submit has done it all

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    plain_->spectrum(frame, window, coefficients);
  }

  std::unique_ptr<Plan> plain_;
  SpectrumMeasure measure_;
  std::vector<std::complex<double>> coefficients_;  ///< Of one window.
};

}  // namespace

std::unique_ptr<Plan> plan_from_spectra(std::unique_ptr<Plan> plain, const MetricSpec& spec,
                                        std::size_t capacity) {
  return std::make_unique<SpectraPlan>(std::move(plain), spec, capacity);
}

}  // namespace fathom
