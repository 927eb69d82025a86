// SPDX-License-Identifier: Apache-2.0
#include "bench/gpu/work.hpp"

#include <stdexcept>

#include "backends/gpu/spectrum.hpp"
#include "backends/gpu/tables.hpp"
#include "backends/vulkan/plan.hpp"
#include "engine/tables.hpp"

namespace fathom::bench {
namespace {

class Streamed final : public Work {
 public:
  Streamed(std::shared_ptr<vulkan::Context> context, const Pixels& pixels, const Cell& cell)
      : pixels_(pixels),
        cell_(cell),
        windows_(cell.tiles.list()),
        plan_(vulkan::make_plan(std::move(context), cell.spec, windows_.size())) {
    for (Seat& seat : seats_) seat.scores.resize(windows_.size());
  }

  const Frame& frame(int seat) const override { return seats_[seat].frame; }
  std::vector<double> scores(int seat) const override { return seats_[seat].scores; }

 private:
  struct Seat {
    Frame frame;
    std::vector<double> scores;
    Plan::Ticket ticket;
  };

  void do_start(int i) override {
    Seat& seat = seats_[i];
    seat.frame = pixels_.frame(number_++, cell_.tiles, cell_.depth);
    seat.ticket = plan_->submit(seat.frame, windows_, seat.scores);
  }
  void do_finish(int i) override { plan_->wait(seats_[i].ticket); }

  const Pixels& pixels_;
  Cell cell_;
  std::vector<Window> windows_;
  std::array<Seat, 2> seats_;
  std::size_t number_ = 0;
  std::unique_ptr<Plan> plan_;  // last, so that it goes first, and waits for its batches
};

/// What a plan does with a batch (backends/gpu/plan.hpp), but that it is loaded once.
class Resident final : public Work {
 public:
  Resident(std::shared_ptr<vulkan::Context> context, const Pixels& pixels, const Cell& cell)
      : context_(std::move(context)), spec_(cell.spec), args_(gpu::args_for(spec_)) {
    if (gpu::needs_exact(spec_))
      throw std::logic_error("only metrics with a fast kernel are timed");
    const auto windows = cell.tiles.list();
    const gpu::Limits& limits = context_->physical().limits;
    fast_.emplace(*context_, spec_, gpu::fast_shape(spec_, cell.depth, limits).value(), cell.depth,
                  windows.size());
    if (!is_walsh(spec_.transform)) {
      exact_.emplace(*context_, spec_, gpu::exact_shape(spec_, limits).value(), cell.depth,
                     windows.size());
    }
    gpu::Rectangle all;
    for (const Window& window : windows) all.include(window);
    for (int i = 0; i < 2; ++i) {
      frames_[i] = pixels.frame(i, cell.tiles, cell.depth);
      flights_[i].emplace(*context_, windows.size());
      flights_[i]->load(frames_[i], all, windows, {});
    }
    windows_ = windows.size();
  }
  ~Resident() override { context_->drain(); }

  const Frame& frame(int seat) const override { return frames_[seat]; }
  std::vector<double> scores(int seat) const override {
    std::vector<double> scores(windows_);
    const std::uint32_t* words = flights_[seat]->results();
    for (double& score : scores) {
      score = tables::moment_scale(spec_) * gpu::moment_of(spec_, words);
      words += 2;
    }
    return scores;
  }

 private:
  void do_start(int i) override {
    flights_[i]->start(*fast_, exact_ ? &*exact_ : nullptr, args_, gpu::Wanted::score);
  }
  void do_finish(int i) override { flights_[i]->finish(); }

  std::shared_ptr<vulkan::Context> context_;
  MetricSpec spec_;
  std::size_t windows_ = 0;
  kernels::ScoreArgs args_;
  std::optional<vulkan::Program> fast_, exact_;
  std::array<Frame, 2> frames_;
  std::array<std::optional<vulkan::Flight>, 2> flights_;
};

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

}  // namespace

std::unique_ptr<Work> streamed(std::shared_ptr<vulkan::Context> context, const Pixels& pixels,
                               const Cell& cell) {
  return std::make_unique<Streamed>(std::move(context), pixels, cell);
}

std::unique_ptr<Work> resident(std::shared_ptr<vulkan::Context> context, const Pixels& pixels,
                               const Cell& cell) {
  return std::make_unique<Resident>(std::move(context), pixels, cell);
}

std::unique_ptr<Work> upload(std::shared_ptr<vulkan::Context> context, const Pixels& pixels,
                             const Cell& cell, bool copies_on_host) {
  if (context->physical().is_unified) return nullptr;
  return std::make_unique<Upload>(std::move(context), pixels, cell, copies_on_host);
}

}  // namespace fathom::bench
