// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/program.hpp"

#include <algorithm>

#include "backends/gpu/tables.hpp"

namespace fathom::opencl {
namespace {

Buffer tables_of(Context& context, const MetricSpec& spec, gpu::Kernel kernel) {
  const auto words = gpu::table_words(spec, kernel);
  const std::size_t bytes = words.size() * sizeof words[0];
  Buffer buffer = context.buffer(bytes, CL_MEM_READ_ONLY | CL_MEM_HOST_WRITE_ONLY, "a table");
  context.check_alive(cl().EnqueueWriteBuffer(context.queue(), buffer.memory.get(), CL_TRUE, 0,
                                              bytes, words.data(), 0, nullptr, nullptr),
                      "writing a table");
  return buffer;
}

}  // namespace

Program::Program(Context& context, const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
                 std::size_t capacity)
    : context_(context),
      spec_(spec),
      shape_(shape),
      depth_(depth),
      tables_(tables_of(context, spec, shape.kernel)),
      workgroups_(gpu::workgroups_of(shape, context.limits(), capacity)) {
  prepare(gpu::Wanted::score);
  if (shape.scratch_bytes == 0) return;
  scratch_ = context.buffer(workgroups_ * shape.scratch_bytes,
                            CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS, "scratch memory");
}

void Program::prepare(gpu::Wanted wanted) {
  Handle<cl_kernel>& kernel = kernels_[static_cast<int>(wanted)];
  if (kernel.get() != nullptr) return;
  kernel = context_.kernel(shape_.kernel, gpu::constants_of(spec_, shape_, depth_, wanted));
}

cl_kernel Program::ready(Buffers buffers, gpu::Wanted wanted) const {
  const cl_kernel kernel = kernels_[static_cast<int>(wanted)].get();
  buffers[FATHOM_TABLES] = tables_.memory.get();
  if (scratch_.bytes > 0) buffers[FATHOM_SCRATCH] = scratch_.memory.get();
  for (cl_uint i = 0; i < buffers.size(); ++i) {
    check(cl().SetKernelArg(kernel, i, sizeof(cl_mem), &buffers[i]), "an argument");
  }
  return kernel;
}

void Program::dispatch(cl_kernel kernel, const kernels::ScoreArgs& args,
                       std::size_t workgroups) const {
  check(cl().SetKernelArg(kernel, FATHOM_ARGUMENTS, sizeof args, &args), "an argument");
  const auto threads = static_cast<std::size_t>(shape_.threads);
  const std::size_t all = workgroups * threads;
  context_.check_alive(cl().EnqueueNDRangeKernel(context_.queue(), kernel, 1, nullptr, &all,
                                                 &threads, 0, nullptr, nullptr),
                       "starting a kernel");
}

void Program::enqueue(const Buffers& buffers, kernels::ScoreArgs args, std::size_t windows,
                      gpu::Wanted wanted) const {
  const cl_kernel kernel = ready(buffers, wanted);
  const auto teams = static_cast<std::size_t>(shape_.teams);
  const std::size_t most = workgroups_ * teams;
  // exact.cl takes window after window itself.
  const bool takes_all = shape_.kernel == gpu::Kernel::exact;
  for (std::size_t first = 0; first < windows; first += most) {
    const std::size_t count = takes_all ? windows : std::min(most, windows - first);
    args.first_window = static_cast<std::uint32_t>(first);
    args.windows = static_cast<std::uint32_t>(count);
    dispatch(kernel, args, std::min(workgroups_, (count + teams - 1) / teams));
    if (takes_all) return;
  }
}

void Program::enqueue_doubtful(const Buffers& buffers, const kernels::ScoreArgs& args) const {
  dispatch(ready(buffers, gpu::Wanted::score), args, workgroups_);
}

}  // namespace fathom::opencl
