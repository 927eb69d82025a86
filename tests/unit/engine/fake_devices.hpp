// SPDX-License-Identifier: Apache-2.0
// Backends that exist only in tests: listed, opened, and taking their time to score nothing.
#pragma once

#include <chrono>
#include <vector>

#include "engine/backend.hpp"
#include "engine/error.hpp"

namespace fathom::test {

/// What a call costs: so much, and so much for every window.
struct FakeCost {
  double call_us = 0;
  double window_us = 0;
};

class FakePlan final : public Plan {
 public:
  FakePlan(const MetricSpec& spec, std::size_t capacity, const FakeCost& cost, int& calls)
      : Plan(spec, capacity), cost_(cost), calls_(calls) {}

 private:
  void do_submit(std::uint64_t, const Frame&, std::span<const Window> windows,
                 std::span<double>) override {
    ++calls_;
    const std::chrono::duration<double, std::micro> takes(
        cost_.call_us + cost_.window_us * static_cast<double>(windows.size()));
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < takes) {
    }
  }
  void do_wait(std::uint64_t) override {}
  void do_spectrum(const Frame&, const Window&, std::span<std::complex<double>>) override {}

  FakeCost cost_;
  int& calls_;
};

class FakeDevice final : public Device {
 public:
  FakeDevice(const DeviceInfo& info, std::string reason, const FakeCost& cost, int& calls)
      : Device(info), reason_(std::move(reason)), cost_(cost), calls_(calls) {}
  bool fuses(const MetricSpec&) const override { return true; }

 private:
  std::string do_unsupported(const MetricSpec& spec) const override {
    return spec.n > 128 ? reason_ : std::string();
  }
  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    if (cost_.call_us < 0) throw Error(ErrorCode::out_of_memory, "it has no memory left");
    return std::make_unique<FakePlan>(spec, capacity, cost_, calls_);
  }
  std::string reason_;
  FakeCost cost_;
  int& calls_;
};

struct FakeBackend final : Backend {
  FakeBackend(const char* its_name, std::vector<DeviceInfo> its_devices, const FakeCost& its_cost)
      : own_name(its_name), infos(std::move(its_devices)), cost(its_cost) {}
  const char* name() const noexcept override { return own_name; }
  bool is_for_gpus() const noexcept override { return for_gpus; }
  std::vector<DeviceInfo> devices() const override {
    ++listed;
    return infos;
  }
  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    if (broken || index >= infos.size()) {
      throw Error(ErrorCode::unavailable, "its driver is too old");
    }
    return std::make_unique<FakeDevice>(infos[index], reason, cost, calls);
  }

  const char* own_name;
  std::vector<DeviceInfo> infos;
  FakeCost cost;  ///< Of all its devices; below zero: they have no memory for a plan.
  bool for_gpus = false;
  bool broken = false;
  std::string reason;      ///< Why it declines windows above 128 px; empty: it does not.
  mutable int listed = 0;  ///< How often it was asked for its devices.
  mutable int calls = 0;   ///< How often any of its plans scored.
};

}  // namespace fathom::test
