// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "backends/opencl/flight.hpp"
#include "backends/opencl/plan.hpp"
#include "bench/gpu/resident.hpp"
#include "bench/gpu/target.hpp"

namespace fathom::bench {
namespace {

/// The same copies on the same queue as a Flight's, without kernels.
class Upload final : public Work {
 public:
  Upload(std::shared_ptr<opencl::Context> context, const Pixels& pixels, const Cell& cell,
         bool copies_on_host)
      : context_(std::move(context)),
        pixels_(pixels),
        cell_(cell),
        copies_on_host_(copies_on_host) {
    for (const Window& window : cell.tiles.list()) all_.include(window);
    for (Seat& seat : seats_) {
      seat.staging = opencl::Staging(*context_, bytes(), "a frame to upload");
      seat.pixels = context_->buffer(bytes(), CL_MEM_READ_ONLY, "a frame");
    }
  }
  ~Upload() override { context_->drain(); }

  const Frame& frame(int seat) const override { return seats_[seat].frame; }
  std::vector<double> scores(int) const override { return {}; }

 private:
  struct Seat {
    opencl::Staging staging;
    opencl::Buffer pixels;
    opencl::Handle<cl_event> done;
    Frame frame;
  };

  std::size_t bytes() const { return all_.bytes(cell_.depth); }

  void do_start(int i) override {
    Seat& seat = seats_[i];
    if (copies_on_host_) {
      seat.frame = pixels_.frame(number_++, cell_.tiles, cell_.depth);
      all_.copy(seat.frame, seat.staging.data());
    }
    cl_event done = nullptr;
    context_->check_alive(
        opencl::cl().EnqueueWriteBuffer(context_->copies(), seat.pixels.memory.get(), CL_FALSE, 0,
                                        bytes(), seat.staging.data(), 0, nullptr, &done),
        "copying pixels");
    seat.done = opencl::Handle<cl_event>(done);
    context_->check_alive(opencl::cl().Flush(context_->copies()), "starting copies");
  }
  void do_finish(int i) override {
    const cl_event done = seats_[i].done.get();
    context_->check_alive(opencl::cl().WaitForEvents(1, &done), "waiting for a copy");
  }

  std::shared_ptr<opencl::Context> context_;
  const Pixels& pixels_;
  Cell cell_;
  bool copies_on_host_;
  gpu::Rectangle all_;
  std::array<Seat, 2> seats_;
  std::size_t number_ = 0;
};

class OpenclTarget final : public Target {
 public:
  explicit OpenclTarget(std::shared_ptr<opencl::Context> context) : context_(std::move(context)) {}

  const DeviceInfo& info() const override { return context_->physical().info; }
  std::uint64_t buffer_bytes() const override { return context_->limits().buffer_bytes; }
  bool is_lost() const override { return context_->is_lost(); }

  std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity) override {
    return opencl::make_plan(context_, spec, capacity);
  }
  std::unique_ptr<Work> resident(const Pixels& pixels, const Cell& cell) override {
    using Scoring = Resident<opencl::Context, opencl::Program, opencl::Flight>;
    return std::make_unique<Scoring>(context_, pixels, cell);
  }
  std::unique_ptr<Work> upload(const Pixels& pixels, const Cell& cell,
                               bool copies_on_host) override {
    if (context_->physical().is_unified) return nullptr;
    return std::make_unique<Upload>(context_, pixels, cell, copies_on_host);
  }

 private:
  std::shared_ptr<opencl::Context> context_;
};

}  // namespace

Named opencl_target(const std::string& name) {
  const auto devices = opencl::list_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const std::string label = fmt::format("opencl:{}", i);
    const bool is_chosen = name.empty() ? devices[i].info.kind == DeviceKind::gpu : name == label;
    if (!is_chosen) continue;
    return {label, std::make_unique<OpenclTarget>(std::make_shared<opencl::Context>(devices[i]))};
  }
  return {};
}

}  // namespace fathom::bench
