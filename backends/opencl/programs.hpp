// SPDX-License-Identifier: Apache-2.0
// The kernels of a device, compiled once and kept on disk for the next process.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "backends/gpu/constants.hpp"
#include "backends/opencl/handle.hpp"
#include "backends/opencl/physical.hpp"

namespace fathom::opencl {

/// As the kernel is called in its file.
const char* kernel_name(gpu::Kernel kernel);

/// Changes with every change of any kernel.
const std::string& kernels_key();

/// Safe to use from several threads. Must end before its context.
class Programs {
 public:
  Programs(cl_context context, const PhysicalDevice& physical)
      : context_(context), device_(physical.id), name_("opencl-" + physical.identity) {}

  /// The program of a kernel with these constants; the same for everybody who asks: what an earlier
  /// process compiled, if the file cache has it and the driver takes it back. Throws
  /// Error(unavailable) with the compiler's first words, Error(out_of_memory).
  cl_program get(gpu::Kernel kernel, const gpu::Constants& constants);

 private:
  Handle<cl_program> load(gpu::Kernel of, const std::string& file,
                          const std::string& options) const;
  Handle<cl_program> build(gpu::Kernel kernel, const std::string& options) const;
  Handle<cl_program> compile(gpu::Kernel kernel, const std::string& options) const;
  void keep(cl_program program, const std::string& file, const std::string& options) const;

  cl_context context_;
  cl_device_id device_;
  std::string name_;
  std::mutex mutex_;
  std::map<std::pair<gpu::Kernel, gpu::Constants>, Handle<cl_program>> programs_;
};

}  // namespace fathom::opencl
