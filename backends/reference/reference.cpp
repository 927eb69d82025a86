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
                 std::span<double> scores) override {
    std::transform(windows.begin(), windows.end(), scores.begin(), [&](const Window& window) {
      return reference::focus_quality(basis_, frame, window);
    });
  }

  void do_wait(std::uint64_t) override {}  // submit has done it all

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    if (!is_walsh(spec().transform)) {
      narrow(reference::fourier_spectrum(basis_, frame, window), 1, coefficients);
    } else if (spec().taper == Taper::none()) {
      const reference::Real pixels = reference::Real(spec().n) * spec().n;
      narrow(reference::walsh_sums(basis_, frame, window), 1 / pixels, coefficients);
    } else {
      narrow(reference::tapered_walsh_spectrum(basis_, frame, window), 1, coefficients);
    }
  }

  reference::Basis basis_;
};

class ReferenceDevice final : public Device {
 public:
  explicit ReferenceDevice(const DeviceInfo& info) : Device(info) {}
  std::string unsupported(const MetricSpec&) const override { return {}; }

 private:
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
