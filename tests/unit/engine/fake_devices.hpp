// SPDX-License-Identifier: Apache-2.0
// Backends that exist only in tests: listed, opened, and scoring nothing for a time that passes on
// a clock of the test's own.
#pragma once

#include <functional>
#include <vector>

#include "engine/backend.hpp"
#include "engine/clock.hpp"
#include "engine/error.hpp"

namespace fathom::test {

/// Time passes when a device works or the test says so.
class FakeClock final : public Clock {
 public:
  double wall_s() const override { return now_s_; }
  double processor_s() const override { return used_s_; }
  double calendar_s() const override { return kStart_s + now_s_; }

  /// processor_s: how much of the time a processor spent on this process.
  void pass(double wall_s, double processor_s = 0) {
    now_s_ += wall_s;
    used_s_ += processor_s;
  }

  /// What other programs take away from a call: how much longer than so many seconds it lasts.
  std::function<double(DeviceKind, double)> disturbance;

 private:
  static constexpr double kStart_s = 1.8e9 + 0.7;
  double now_s_ = 0, used_s_ = 0;
};

/// What a call costs: so much, and so much for every window.
struct FakeCost {
  double call_us = 0;
  double window_us = 0;
};

/// What the plans of some devices share.
struct FakeWorld {
  FakeClock clock;
  int calls = 0;  ///< How often any plan scored.
};

class FakePlan final : public Plan {
 public:
  FakePlan(const MetricSpec& spec, std::size_t capacity, const FakeCost& cost, DeviceKind kind,
           FakeWorld& world)
      : Plan(spec, capacity), cost_(cost), kind_(kind), world_(world) {}

 private:
  void do_submit(std::uint64_t, const Frame&, std::span<const Window> windows,
                 std::span<double>) override {
    ++world_.calls;
    const double takes_s =
        1e-6 * (cost_.call_us + cost_.window_us * static_cast<double>(windows.size()));
    const auto& disturbance = world_.clock.disturbance;
    const double extra_s = disturbance ? disturbance(kind_, takes_s) : 0;
    world_.clock.pass(takes_s + extra_s, kind_ == DeviceKind::cpu ? takes_s : 0);
  }
  void do_wait(std::uint64_t) override {}
  void do_spectrum(const Frame&, const Window&, std::span<std::complex<double>>) override {}

  FakeCost cost_;
  DeviceKind kind_;
  FakeWorld& world_;
};

class FakeDevice final : public Device {
 public:
  FakeDevice(const DeviceInfo& info, std::string reason, const FakeCost& cost, FakeWorld& world)
      : Device(info), reason_(std::move(reason)), cost_(cost), world_(world) {}
  bool fuses(const MetricSpec&) const override { return true; }

 private:
  std::string do_unsupported(const MetricSpec& spec) const override {
    return spec.n > 128 ? reason_ : std::string();
  }
  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    if (cost_.call_us < 0) throw Error(ErrorCode::out_of_memory, "it has no memory left");
    return std::make_unique<FakePlan>(spec, capacity, cost_, info().kind, world_);
  }
  std::string reason_;
  FakeCost cost_;
  FakeWorld& world_;
};

struct FakeBackend final : Backend {
  FakeBackend(FakeWorld& its_world, const char* its_name, std::vector<DeviceInfo> its_devices,
              const FakeCost& its_cost)
      : world(its_world), own_name(its_name), infos(std::move(its_devices)), cost(its_cost) {}
  const char* name() const noexcept override { return own_name; }
  bool is_for_gpus() const noexcept override { return for_gpus; }
  std::string drivers() const override { return driver_files; }
  std::vector<DeviceInfo> devices() const override {
    ++listed;
    return infos;
  }
  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    if (broken || index >= infos.size()) {
      throw Error(ErrorCode::unavailable, "its driver is too old");
    }
    ++opened;
    const bool is_special = index < costs.size();
    return std::make_unique<FakeDevice>(infos[index], reason, is_special ? costs[index] : cost,
                                        world);
  }

  FakeWorld& world;
  const char* own_name;
  std::vector<DeviceInfo> infos;
  FakeCost cost;                ///< Of its devices; below zero: they have no memory for a plan.
  std::vector<FakeCost> costs;  ///< Of the first devices, if they differ.
  bool for_gpus = false;
  bool broken = false;
  std::string driver_files;  ///< Empty: its list of devices is not kept.
  std::string reason;        ///< Why it declines windows above 128 px; empty: it does not.
  mutable int listed = 0;    ///< How often it was asked for its devices.
  mutable int opened = 0;    ///< How often one of them was opened.
};

}  // namespace fathom::test
