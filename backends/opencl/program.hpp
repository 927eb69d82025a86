// SPDX-License-Identifier: Apache-2.0
// A kernel made ready for one metric: compiled, with its tables and scratch memory.
#pragma once

#include <array>

#include "backends/opencl/context.hpp"

namespace fathom::opencl {

class Program {
 public:
  /// depth: of the pixels; exact.cl takes any. capacity: most windows of one call; scratch memory
  /// is for no more. Throws Error(out_of_memory, unavailable).
  Program(Context& context, const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
          std::size_t capacity);

  const MetricSpec& spec() const { return spec_; }
  const gpu::Shape& shape() const { return shape_; }

  /// Compiles what that takes, where it was not before. Throws Error(out_of_memory, unavailable).
  void prepare(gpu::Wanted wanted);

  /// What kernels read and write, by number (kernels/args.h); tables and scratch memory are the
  /// program's own.
  using Buffers = std::array<cl_mem, FATHOM_ARGUMENTS>;

  /// Scores windows 0 .. windows - 1; args says the rest. The caller waits for the queue if this
  /// throws: Error(out_of_memory, device_lost).
  void enqueue(const Buffers& buffers, kernels::ScoreArgs args, std::size_t windows,
               gpu::Wanted wanted) const;

  /// Scores the windows that an earlier program listed as doubtful.
  void enqueue_doubtful(const Buffers& buffers, const kernels::ScoreArgs& args) const;

 private:
  cl_kernel ready(Buffers buffers, gpu::Wanted wanted) const;
  void dispatch(cl_kernel kernel, const kernels::ScoreArgs& args, std::size_t workgroups) const;

  Context& context_;
  MetricSpec spec_;
  gpu::Shape shape_;
  Depth depth_;
  Buffer tables_;
  Buffer scratch_;
  std::size_t workgroups_;  ///< Most in one dispatch.
  Handle<cl_kernel>
      kernels_[2];  ///< By Wanted; that for coefficients only once somebody wants them.
};

}  // namespace fathom::opencl
