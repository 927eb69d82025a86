// SPDX-License-Identifier: Apache-2.0
#include "bench/opencl/batched_fft.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

namespace fathom::bench {
namespace {

void require(cl_int result, const char* what) {
  if (result != CL_SUCCESS) throw std::runtime_error(fmt::format("{} failed ({})", what, result));
}

}  // namespace

BatchedFft::BatchedFft(const opencl::PhysicalDevice& device, int n, std::size_t batch, bool is_real)
    : bytes_(batch * n * (is_real ? n / 2 + 1 : n) * 2 * sizeof(float)) {
  const auto& cl = opencl::cl();
  cl_int result = CL_SUCCESS;
  context_ = opencl::Handle<cl_context>(
      cl.CreateContext(nullptr, 1, &device.id, nullptr, nullptr, &result));
  require(result, "a context");
  queue_ = opencl::Handle<cl_command_queue>(
      cl.CreateCommandQueue(context_.get(), device.id, 0, &result));
  require(result, "a queue");
  std::vector<float> noise(bytes_ / sizeof(float));
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<float>(i * 2654435761U % 256);
  buffer_ = opencl::Handle<cl_mem>(cl.CreateBuffer(
      context_.get(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, bytes_, noise.data(), &result));
  require(result, "a buffer");
}

void BatchedFft::run() {
  start();
  require(opencl::cl().Finish(queue_.get()), "waiting for a transform");
}

}  // namespace fathom::bench
