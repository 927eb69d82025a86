// SPDX-License-Identifier: Apache-2.0
// Other libraries' batched 2-D transforms of N x N on an OpenCL device, in place, and nothing else.
#pragma once

#include <cstddef>
#include <memory>

#include "backends/opencl/handle.hpp"
#include "backends/opencl/physical.hpp"

namespace fathom::bench {

/// A device opened for one library, with a buffer of a whole batch.
class BatchedFft {
 public:
  virtual ~BatchedFft() = default;
  BatchedFft(const BatchedFft&) = delete;
  BatchedFft& operator=(const BatchedFft&) = delete;

  /// Transforms the batch, and waits. Throws std::runtime_error.
  void run();
  /// The same without waiting: queue() goes on in order.
  virtual void start() = 0;

  cl_context context() const { return context_.get(); }
  cl_command_queue queue() const { return queue_.get(); }
  /// [window][N][N/2 + 1] complex numbers, or in their place N floats a row; of complex transforms
  /// [window][N][N].
  cl_mem buffer() const { return buffer_.get(); }

 protected:
  /// is_real: N x N floats to N x (N/2 + 1) complex ones; else complex to complex, of which a
  /// careful user packs two real windows into one. Throws std::runtime_error.
  BatchedFft(const opencl::PhysicalDevice& device, int n, std::size_t batch, bool is_real);

  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_;
  opencl::Handle<cl_context> context_;
  opencl::Handle<cl_command_queue> queue_;
  opencl::Handle<cl_mem> buffer_;
};

/// All throw std::runtime_error.
std::unique_ptr<BatchedFft> make_vkfft(const opencl::PhysicalDevice& device, int n,
                                       std::size_t batch, bool is_real);
std::unique_ptr<BatchedFft> make_clfft(const opencl::PhysicalDevice& device, int n,
                                       std::size_t batch);

}  // namespace fathom::bench
