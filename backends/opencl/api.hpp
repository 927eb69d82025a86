// SPDX-License-Identifier: Apache-2.0
// OpenCL's functions, found at run time, so that Fathom starts where there is no OpenCL; and what
// their results mean.
#pragma once

// Of OpenCL 3.0 only numbers are used, and only where a device is that new; functions are of 1.2.
#define CL_TARGET_OPENCL_VERSION 300
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

namespace fathom::opencl {

#define FATHOM_OPENCL_FUNCTIONS(X) \
  X(GetPlatformIDs)                \
  X(GetPlatformInfo)               \
  X(GetDeviceIDs)                  \
  X(GetDeviceInfo)                 \
  X(CreateContext)                 \
  X(ReleaseContext)                \
  X(CreateCommandQueue)            \
  X(ReleaseCommandQueue)           \
  X(CreateBuffer)                  \
  X(ReleaseMemObject)              \
  X(CreateProgramWithSource)       \
  X(CreateProgramWithBinary)       \
  X(BuildProgram)                  \
  X(GetProgramInfo)                \
  X(GetProgramBuildInfo)           \
  X(ReleaseProgram)                \
  X(CreateKernel)                  \
  X(ReleaseKernel)                 \
  X(SetKernelArg)                  \
  X(EnqueueNDRangeKernel)          \
  X(EnqueueWriteBuffer)            \
  X(EnqueueReadBuffer)             \
  X(EnqueueFillBuffer)             \
  X(EnqueueMapBuffer)              \
  X(EnqueueUnmapMemObject)         \
  X(EnqueueBarrierWithWaitList)    \
  X(GetEventInfo)                  \
  X(ReleaseEvent)                  \
  X(Flush)                         \
  X(Finish)

struct Api {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name
#define FATHOM_OPENCL_MEMBER(name) decltype(&::cl##name) name = nullptr;
  FATHOM_OPENCL_FUNCTIONS(FATHOM_OPENCL_MEMBER)
#undef FATHOM_OPENCL_MEMBER
};

/// The functions of this machine's OpenCL loader, found once. Throws Error(unavailable) where there
/// is none.
const Api& cl();

/// Throws an Error that says what was being done, unless the result is CL_SUCCESS.
void check(cl_int result, const char* doing);

/// "the device is out of memory"; null if the result means anything else than memory.
/// CL_OUT_OF_RESOURCES does where something is made; where it runs, it is a fault (Context).
const char* memory_fault(cl_int result);

}  // namespace fathom::opencl
