// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/flight.hpp"
#include "backends/opencl/plan.hpp"
#include "bench/gpu/device_target.hpp"

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
    context_->wait(done, 0);
  }

  std::shared_ptr<opencl::Context> context_;
  const Pixels& pixels_;
  Cell cell_;
  bool copies_on_host_;
  gpu::Rectangle all_;
  std::array<Seat, 2> seats_;
  std::size_t number_ = 0;
};

}  // namespace

Named opencl_target(const std::string& name) {
  const auto devices = opencl::list_devices();
  return named_target<opencl::Program, opencl::Flight, Upload>(
      "opencl", name, devices, [](const opencl::PhysicalDevice& device) {
        return std::make_shared<opencl::Context>(device);
      });
}

}  // namespace fathom::bench
