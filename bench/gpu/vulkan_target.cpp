// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/flight.hpp"
#include "backends/vulkan/plan.hpp"
#include "bench/gpu/device_target.hpp"

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
  void do_finish(int i) override { context_->wait(seats_[i]->done.get(), 0); }

  std::shared_ptr<vulkan::Context> context_;
  const Pixels& pixels_;
  Cell cell_;
  bool copies_on_host_;
  gpu::Rectangle all_;
  std::array<std::optional<Seat>, 2> seats_;
  std::size_t number_ = 0;
};

}  // namespace

Named vulkan_target(const std::string& name) {
  const auto instance = std::make_shared<const vulkan::Instance>();
  const auto& devices = instance->devices();
  return named_target<vulkan::Program, vulkan::Flight, Upload>(
      "vulkan", name, devices, [&](const vulkan::PhysicalDevice& device) {
        return std::make_shared<vulkan::Context>(instance, device);
      });
}

}  // namespace fathom::bench
