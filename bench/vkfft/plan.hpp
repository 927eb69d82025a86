// SPDX-License-Identifier: Apache-2.0
// VkFFT on an OpenCL device: batched 2-D transforms of N x N, in place, and nothing else.
#pragma once

#include <cstddef>
#include <memory>

#include "backends/opencl/physical.hpp"

namespace fathom::bench {

class VkfftPlan {
 public:
  /// is_real: N x N floats to N x (N/2 + 1) complex ones; else complex to complex, of which a
  /// careful user packs two real windows into one. Throws std::runtime_error.
  VkfftPlan(const opencl::PhysicalDevice& device, int n, std::size_t batch, bool is_real);
  ~VkfftPlan();
  VkfftPlan(const VkfftPlan&) = delete;
  VkfftPlan& operator=(const VkfftPlan&) = delete;

  /// Transforms the batch, and waits. Throws std::runtime_error.
  void run();
  /// The same without waiting: queue() goes on in order.
  void start();

  cl_context context() const;
  cl_command_queue queue() const;
  /// [window][N][N/2 + 1] complex numbers, or in their place N floats a row; of complex transforms
  /// [window][N][N].
  cl_mem buffer() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fathom::bench
