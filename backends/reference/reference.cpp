// SPDX-License-Identifier: Apache-2.0
// The `reference` backend: the formulas behind the contract. Slow, and right.
#include <algorithm>

#include "backends/backends.hpp"
#include "backends/reference/formulas.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

double narrow(reference::Real value) { return static_cast<double>(value); }

std::complex<double> narrow(const reference::Complex& value) {
  return {narrow(value.real()), narrow(value.imag())};
}

template <class Spectrum>
void narrow(const Spectrum& spectrum, reference::Real scale, std::span<std::complex<double>> out) {
  std::transform(spectrum.begin(), spectrum.end(), out.begin(),
                 [scale](const auto& value) { return narrow(scale * value); });
}

class ReferencePlan final : public Plan {
 public:
  ReferencePlan(const MetricSpec& spec, std::size_t capacity)
      : Plan(spec, capacity), basis_(spec) {}

 private:
  void do_submit(std::uint64_t, const Frame& frame, std::span<const Window> windows,
                 std::span<double> values) override {
    const std::size_t outputs = spec().outputs();
    for (std::size_t i = 0; i < windows.size(); ++i)
      measure(frame, windows[i], values.subspan(i * outputs, outputs));
  }

  void measure(const Frame& frame, const Window& window, std::span<double> values) {
    switch (spec().measure) {
      case Measure::moment:
        values[0] = reference::focus_quality(basis_, frame, window);
        return;
      case Measure::rings:
        return reference::ring_powers(basis_, frame, window, values);
      case Measure::entropy:
        values[0] = reference::entropy(basis_, frame, window);
        return;
    }
  }

  void do_wait(std::uint64_t) override {}  // submit has done it all

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    switch (family_of(spec().transform)) {
      case TransformFamily::fourier:
        return narrow(reference::fourier_spectrum(basis_, frame, window), 1, coefficients);
      case TransformFamily::walsh:
        return walsh_spectrum(frame, window, coefficients);
      case TransformFamily::cosine:
        return narrow(reference::cosine_spectrum(basis_, frame, window), 1, coefficients);
    }
  }

  void walsh_spectrum(const Frame& frame, const Window& window,
                      std::span<std::complex<double>> coefficients) {
    if (spec().taper != Taper::none()) {
      return narrow(reference::tapered_walsh_spectrum(basis_, frame, window), 1, coefficients);
    }
    const reference::Real pixels = reference::Real(spec().n) * spec().n;
    narrow(reference::walsh_sums(basis_, frame, window), 1 / pixels, coefficients);
  }

  reference::Basis basis_;
};

class ReferenceDevice final : public Device {
 public:
  explicit ReferenceDevice(const DeviceInfo& info) : Device(info) {}

  bool fuses(const MetricSpec& spec) const override {
    switch (spec.measure) {
      case Measure::moment:
      case Measure::rings:
      case Measure::entropy:
        return true;
    }
    return false;
  }

 private:
  std::string do_unsupported(const MetricSpec&) const override { return {}; }

  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    return std::make_unique<ReferencePlan>(spec, capacity);
  }
};

class ReferenceBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "reference"; }

  std::vector<DeviceInfo> devices() const override {
    return {{"direct sums", DeviceKind::cpu, "the formulas as they stand, one thread"}};
  }

  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    const auto infos = devices();
    if (index >= infos.size()) {
      throw Error(ErrorCode::unavailable, "backend reference has one device, reference:0");
    }
    return std::make_unique<ReferenceDevice>(infos[index]);
  }
};

}  // namespace

const Backend& reference_backend() {
  static const ReferenceBackend backend;
  return backend;
}

}  // namespace fathom
