// SPDX-License-Identifier: Apache-2.0
#include "bench/opencl/batched_fft.hpp"

#define VKFFT_BACKEND 3  // OpenCL
// After ours, which says of which OpenCL.
#include <fmt/format.h>
#include <vkFFT.h>

#include <stdexcept>

namespace fathom::bench {
namespace {

void require(int result, const char* what) {
  if (result != 0) throw std::runtime_error(fmt::format("{} failed ({})", what, result));
}

class Vkfft final : public BatchedFft {
 public:
  Vkfft(const opencl::PhysicalDevice& physical, int n, std::size_t batch, bool is_real)
      : BatchedFft(physical, n, batch, is_real),
        platform_(physical.platform),
        device_(physical.id),
        context_(context()),
        queue_(queue()),
        buffer_(buffer()),
        bytes_(bytes()) {
    VkFFTConfiguration wish = {};
    wish.FFTdim = 2;
    wish.size[0] = wish.size[1] = static_cast<std::uint64_t>(n);
    wish.numberBatches = batch;
    wish.performR2C = is_real ? 1 : 0;
    wish.device = &device_;
    wish.platform = &platform_;
    wish.context = &context_;
    wish.buffer = &buffer_;
    wish.bufferSize = &bytes_;
    require(initializeVkFFT(&application_, wish), "VkFFT's plan");
  }
  ~Vkfft() override { deleteVkFFT(&application_); }

  void start() override {
    VkFFTLaunchParams launch = {};
    launch.commandQueue = &queue_;
    launch.buffer = &buffer_;
    require(VkFFTAppend(&application_, -1, &launch), "VkFFT");
  }

 private:
  // VkFFT keeps their addresses.
  cl_platform_id platform_;
  cl_device_id device_;
  cl_context context_;
  cl_command_queue queue_;
  cl_mem buffer_;
  std::uint64_t bytes_;
  VkFFTApplication application_ = {};
};

}  // namespace

std::unique_ptr<BatchedFft> make_vkfft(const opencl::PhysicalDevice& device, int n,
                                       std::size_t batch, bool is_real) {
  return std::make_unique<Vkfft>(device, n, batch, is_real);
}

}  // namespace fathom::bench
