// SPDX-License-Identifier: Apache-2.0
#include "bench/opencl/batched_fft.hpp"

// After ours, which says of which OpenCL.
#include <clFFT.h>
#include <fmt/format.h>

#include <stdexcept>

namespace fathom::bench {
namespace {

void require(clfftStatus result, const char* what) {
  if (result != CLFFT_SUCCESS) {
    throw std::runtime_error(fmt::format("clFFT: {} failed ({})", what, static_cast<int>(result)));
  }
}

/// The library's own state, while there are plans.
class Library {
 public:
  Library() {
    if (users_++ > 0) return;
    clfftSetupData data;
    clfftInitSetupData(&data);
    require(clfftSetup(&data), "setting up");
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    if (--users_ == 0) clfftTeardown();
  }

 private:
  static inline int users_ = 0;
};

class Clfft final : public BatchedFft {
 public:
  Clfft(const opencl::PhysicalDevice& device, int n, std::size_t batch)
      : BatchedFft(device, n, batch, true) {
    const std::size_t side = n, columns = side / 2 + 1;
    const std::size_t sides[] = {side, side};
    std::size_t rows_in[] = {1, 2 * columns}, rows_out[] = {1, columns};
    require(clfftCreateDefaultPlan(&plan_, context(), CLFFT_2D, sides), "a plan");
    require(clfftSetLayout(plan_, CLFFT_REAL, CLFFT_HERMITIAN_INTERLEAVED), "a layout");
    require(clfftSetResultLocation(plan_, CLFFT_INPLACE), "a place");
    require(clfftSetPlanBatchSize(plan_, batch), "a batch");
    require(clfftSetPlanInStride(plan_, CLFFT_2D, rows_in), "rows");
    require(clfftSetPlanOutStride(plan_, CLFFT_2D, rows_out), "rows");
    require(clfftSetPlanDistance(plan_, side * 2 * columns, side * columns), "windows");
    cl_command_queue of = queue();
    require(clfftBakePlan(plan_, 1, &of, nullptr, nullptr), "baking a plan");
  }
  ~Clfft() override { clfftDestroyPlan(&plan_); }

  void start() override {
    cl_command_queue of = queue();
    cl_mem in_place = buffer();
    require(clfftEnqueueTransform(plan_, CLFFT_FORWARD, 1, &of, 0, nullptr, nullptr, &in_place,
                                  nullptr, nullptr),
            "a transform");
  }

 private:
  Library library_;  // until the plan is gone
  clfftPlanHandle plan_ = 0;
};

}  // namespace

std::unique_ptr<BatchedFft> make_clfft(const opencl::PhysicalDevice& device, int n,
                                       std::size_t batch) {
  return std::make_unique<Clfft>(device, n, batch);
}

}  // namespace fathom::bench
