// SPDX-License-Identifier: Apache-2.0
// A target of any backend with flights (backends/gpu/plan.hpp).
#pragma once

#include <fmt/format.h>

#include "bench/gpu/resident.hpp"
#include "bench/gpu/target.hpp"

namespace fathom::bench {

/// Upload: its own way for pixels to the device, Upload(context, pixels, cell, copies_on_host).
template <class Context, class Program, class Flight, class Upload>
class DeviceTarget final : public Target {
 public:
  explicit DeviceTarget(std::shared_ptr<Context> context) : context_(std::move(context)) {}

  const DeviceInfo& info() const override { return context_->physical().info; }
  std::uint64_t buffer_bytes() const override { return context_->limits().buffer_bytes; }
  bool is_lost() const override { return context_->is_lost(); }

  std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity) override {
    return make_plan(context_, spec, capacity);
  }
  std::unique_ptr<Work> resident(const Pixels& pixels, const Cell& cell) override {
    return std::make_unique<Resident<Context, Program, Flight>>(context_, pixels, cell);
  }
  std::unique_ptr<Work> upload(const Pixels& pixels, const Cell& cell,
                               bool copies_on_host) override {
    if (context_->physical().is_unified) return nullptr;
    return std::make_unique<Upload>(context_, pixels, cell, copies_on_host);
  }

 private:
  std::shared_ptr<Context> context_;
};

/// The device called `name`, or the first real GPU where that is empty; open: to a shared Context.
template <class Program, class Flight, class Upload, class Devices, class Open>
Named named_target(const char* backend, const std::string& name, const Devices& devices,
                   const Open& open) {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const std::string label = fmt::format("{}:{}", backend, i);
    const bool is_chosen = name.empty() ? devices[i].info.kind == DeviceKind::gpu : name == label;
    if (!is_chosen) continue;
    auto context = open(devices[i]);
    using Context = typename decltype(context)::element_type;
    return {label, std::make_unique<DeviceTarget<Context, Program, Flight, Upload>>(context)};
  }
  return {};
}

}  // namespace fathom::bench
