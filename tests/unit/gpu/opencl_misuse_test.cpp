// SPDX-License-Identifier: Apache-2.0
// A kernel with a race on purpose: proves to tests/unit/gpu/checked that Oclgrind listens.
#include <gtest/gtest.h>

#include "backends/opencl/handle.hpp"
#include "backends/opencl/physical.hpp"

namespace fathom::opencl {
namespace {

constexpr const char* kRace =
    "__kernel void race(__global int* number) { *number = (int)get_local_id(0); }";

// Disabled, because it is wrong; the script asks for it by name.
TEST(OpenclMisuse, DISABLED_TwoThreadsWriteOneNumber) {
  const auto devices = list_devices();
  ASSERT_FALSE(devices.empty());
  cl_device_id device = devices[0].id;
  cl_int result = CL_SUCCESS;
  const Handle<cl_context> context(
      cl().CreateContext(nullptr, 1, &device, nullptr, nullptr, &result));
  const Handle<cl_command_queue> queue(cl().CreateCommandQueue(context.get(), device, 0, &result));
  const Handle<cl_mem> number(
      cl().CreateBuffer(context.get(), CL_MEM_READ_WRITE, 4, nullptr, &result));
  const char* text = kRace;
  const Handle<cl_program> program(
      cl().CreateProgramWithSource(context.get(), 1, &text, nullptr, &result));
  ASSERT_EQ(cl().BuildProgram(program.get(), 1, &device, "", nullptr, nullptr), CL_SUCCESS);
  const Handle<cl_kernel> kernel(cl().CreateKernel(program.get(), "race", &result));
  ASSERT_EQ(result, CL_SUCCESS);
  const cl_mem argument = number.get();
  ASSERT_EQ(cl().SetKernelArg(kernel.get(), 0, sizeof argument, &argument), CL_SUCCESS);
  const std::size_t threads = 2;
  ASSERT_EQ(cl().EnqueueNDRangeKernel(queue.get(), kernel.get(), 1, nullptr, &threads, &threads, 0,
                                      nullptr, nullptr),
            CL_SUCCESS);
  cl().Finish(queue.get());
}

}  // namespace
}  // namespace fathom::opencl
