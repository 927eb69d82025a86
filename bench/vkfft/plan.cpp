// SPDX-License-Identifier: Apache-2.0
#include "bench/vkfft/plan.hpp"

#define VKFFT_BACKEND 3  // OpenCL
#include <fmt/format.h>
#include <vkFFT.h>

#include <stdexcept>
#include <vector>

#include "backends/opencl/handle.hpp"

namespace fathom::bench {
namespace {

void require(int result, const char* doing) {
  if (result != 0) throw std::runtime_error(fmt::format("{} failed ({})", doing, result));
}

}  // namespace

struct VkfftPlan::State {
  cl_platform_id platform = nullptr;
  cl_device_id device = nullptr;
  opencl::Handle<cl_context> context;
  opencl::Handle<cl_command_queue> queue;
  opencl::Handle<cl_mem> buffer;
  // VkFFT keeps their addresses.
  cl_context raw_context = nullptr;
  cl_command_queue raw_queue = nullptr;
  cl_mem raw_buffer = nullptr;
  std::uint64_t bytes = 0;
  VkFFTApplication application = {};
};

VkfftPlan::VkfftPlan(const opencl::PhysicalDevice& physical, int n, std::size_t batch, bool is_real)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.platform = physical.platform;
  state.device = physical.id;
  cl_int result = CL_SUCCESS;
  const auto& cl = opencl::cl();
  state.raw_context = cl.CreateContext(nullptr, 1, &state.device, nullptr, nullptr, &result);
  state.context = opencl::Handle<cl_context>(state.raw_context);
  require(result, "VkFFT's context");
  state.raw_queue = cl.CreateCommandQueue(state.raw_context, state.device, 0, &result);
  state.queue = opencl::Handle<cl_command_queue>(state.raw_queue);
  require(result, "VkFFT's queue");
  const std::size_t columns = is_real ? n / 2 + 1 : n;
  state.bytes = batch * n * columns * 2 * sizeof(float);
  std::vector<float> noise(state.bytes / sizeof(float));
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<float>(i * 2654435761U % 256);
  state.raw_buffer = cl.CreateBuffer(state.raw_context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
                                     state.bytes, noise.data(), &result);
  state.buffer = opencl::Handle<cl_mem>(state.raw_buffer);
  require(result, "VkFFT's buffer");

  VkFFTConfiguration wish = {};
  wish.FFTdim = 2;
  wish.size[0] = wish.size[1] = static_cast<std::uint64_t>(n);
  wish.numberBatches = batch;
  wish.performR2C = is_real ? 1 : 0;
  wish.normalize = 0;
  wish.device = &state.device;
  wish.platform = &state.platform;
  wish.context = &state.raw_context;
  wish.buffer = &state.raw_buffer;
  wish.bufferSize = &state.bytes;
  require(initializeVkFFT(&state.application, wish), "VkFFT's plan");
}

VkfftPlan::~VkfftPlan() { deleteVkFFT(&state_->application); }

void VkfftPlan::run() {
  start();
  require(opencl::cl().Finish(state_->raw_queue), "waiting for VkFFT");
}

cl_context VkfftPlan::context() const { return state_->raw_context; }
cl_command_queue VkfftPlan::queue() const { return state_->raw_queue; }
cl_mem VkfftPlan::buffer() const { return state_->raw_buffer; }

void VkfftPlan::start() {
  VkFFTLaunchParams launch = {};
  launch.commandQueue = &state_->raw_queue;
  launch.buffer = &state_->raw_buffer;
  require(VkFFTAppend(&state_->application, -1, &launch), "VkFFT");
}

}  // namespace fathom::bench
