// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "backends/vulkan/flight.hpp"
#include "backends/vulkan/plan.hpp"
#include "bench/gpu/resident.hpp"
#include "bench/gpu/target.hpp"

namespace fathom::bench {
namespace {

/// The same copies on the same queues as a Flight's, without kernels.
class Upload final : public Work {
 public:
  Upload(std::shared_ptr<vulkan::Context> context, const Pixels& pixels, const Cell& cell,
         bool copies_on_host)
      : context_(std::move(context)),
        pixels_(pixels),
        cell_(cell),
        copies_on_host_(copies_on_host) {
    for (const Window& window : cell.tiles.list()) all_.include(window);
    for (auto& seat : seats_) seat.emplace(*context_, all_.bytes(cell.depth));
  }
  ~Upload() override { context_->drain(); }

  const Frame& frame(int seat) const override { return seats_[seat]->frame; }
  std::vector<double> scores(int) const override { return {}; }

 private:
  struct Seat {
    Seat(vulkan::Context& context, std::size_t bytes)
        : staging(context.buffer(bytes, vulkan::Place::upload, "a frame to upload")),
          pixels(context.buffer(bytes, vulkan::Place::device, "a frame")),
          done(context.fence()),
          uploaded(context.has_transfer_queue() ? context.semaphore()
                                                : vulkan::Handle<VkSemaphore>()),
          compute(context, context.physical().compute_family),
          transfer(context,
                   context.physical().transfer_family.value_or(context.physical().compute_family)) {
    }
    vulkan::Buffer staging, pixels;
    vulkan::Handle<VkFence> done;
    vulkan::Handle<VkSemaphore> uploaded;
    vulkan::Commands compute, transfer;
    Frame frame;
  };

  void do_start(int i) override {
    Seat& seat = *seats_[i];
    if (copies_on_host_) {
      seat.frame = pixels_.frame(number_++, cell_.tiles, cell_.depth);
      all_.copy(seat.frame, static_cast<std::byte*>(seat.staging.mapped));
    }
    const VkCommandBuffer copy = seat.transfer.begin();
    const VkBufferCopy region = {0, 0, seat.staging.bytes};
    context_->api().vkCmdCopyBuffer(copy, seat.staging.buffer.get(), seat.pixels.buffer.get(), 1,
                                    &region);
    seat.transfer.end();
    if (!context_->has_transfer_queue()) {
      return context_->submit(copy, VK_NULL_HANDLE, seat.done.get());
    }
    context_->submit_transfer(copy, seat.uploaded.get());
    const VkCommandBuffer nothing = seat.compute.begin();
    seat.compute.end();
    context_->submit(nothing, seat.uploaded.get(), seat.done.get());
  }
  void do_finish(int i) override { context_->wait(seats_[i]->done.get()); }

  std::shared_ptr<vulkan::Context> context_;
  const Pixels& pixels_;
  Cell cell_;
  bool copies_on_host_;
  gpu::Rectangle all_;
  std::array<std::optional<Seat>, 2> seats_;
  std::size_t number_ = 0;
};

class VulkanTarget final : public Target {
 public:
  explicit VulkanTarget(std::shared_ptr<vulkan::Context> context) : context_(std::move(context)) {}

  const DeviceInfo& info() const override { return context_->physical().info; }
  std::uint64_t buffer_bytes() const override { return context_->limits().buffer_bytes; }
  bool is_lost() const override { return context_->is_lost(); }

  std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity) override {
    return vulkan::make_plan(context_, spec, capacity);
  }
  std::unique_ptr<Work> resident(const Pixels& pixels, const Cell& cell) override {
    using Scoring = Resident<vulkan::Context, vulkan::Program, vulkan::Flight>;
    return std::make_unique<Scoring>(context_, pixels, cell);
  }
  std::unique_ptr<Work> upload(const Pixels& pixels, const Cell& cell,
                               bool copies_on_host) override {
    if (context_->physical().is_unified) return nullptr;
    return std::make_unique<Upload>(context_, pixels, cell, copies_on_host);
  }

 private:
  std::shared_ptr<vulkan::Context> context_;
};

}  // namespace

Named vulkan_target(const std::string& name) {
  const auto instance = std::make_shared<const vulkan::Instance>();
  const auto& devices = instance->devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const std::string label = fmt::format("vulkan:{}", i);
    const bool is_chosen = name.empty() ? devices[i].info.kind == DeviceKind::gpu : name == label;
    if (!is_chosen) continue;
    return {label, std::make_unique<VulkanTarget>(
                       std::make_shared<vulkan::Context>(instance, devices[i]))};
  }
  return {};
}

}  // namespace fathom::bench
