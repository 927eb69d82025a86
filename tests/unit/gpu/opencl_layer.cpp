// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer for tests: counts objects, lets calls fail, and makes a device look smaller or
// richer than it is (control.hpp). The way in is the one that loaders prescribe (CL/cl_layer.h).
#include <CL/cl_layer.h>

#include <cstring>
#include <mutex>
#include <set>
#include <string>

#include "tests/unit/gpu/control.hpp"

#define FATHOM_LAYER_EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using fathom::test::fails;
using fathom::test::LayerControl;

enum Counted { Memory, Context, CommandQueue, Program, Kernel, Event };
constexpr const char* kNames[] = {"Memory",  "Context", "CommandQueue",
                                  "Program", "Kernel",  "Event"};

LayerControl& control() {
  static LayerControl* const settings = fathom::test::new_control(kNames);
  return *settings;
}

/// What comes after this layer, and this layer's own functions before it.
cl_icd_dispatch next = {}, own = {};

/// Queues that have computed.
struct Computing {
  std::mutex mutex;
  std::set<cl_command_queue> queues;
};
Computing& computing() {
  static auto* const all = new Computing;
  return *all;
}

template <class Object>
Object counted(Object object, Counted what) {
  if (object != nullptr) control().born(what);
  return object;
}

template <class Number>
void set(void* value, std::size_t size, Number number) {
  if (value != nullptr && size >= sizeof number) std::memcpy(value, &number, sizeof number);
}

cl_int CL_API_CALL get_device_info(cl_device_id device, cl_device_info what, std::size_t size,
                                   void* value, std::size_t* returned) {
  const cl_int result = next.clGetDeviceInfo(device, what, size, value, returned);
  if (result != CL_SUCCESS) return result;
  if (control().is_small) {  // OpenCL 1.2's minimum, but for threads, which may be one
    if (what == CL_DEVICE_LOCAL_MEM_SIZE) set(value, size, cl_ulong{32768});
    if (what == CL_DEVICE_MAX_WORK_GROUP_SIZE) set(value, size, std::size_t{128});
    if (what == CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT) set(value, size, cl_uint{1});
  }
  if (control().threads != 0 && what == CL_DEVICE_MAX_WORK_GROUP_SIZE) {
    set(value, size, std::size_t{control().threads});
  }
  if (control().shared_bytes != 0 && what == CL_DEVICE_LOCAL_MEM_SIZE) {
    set(value, size, cl_ulong{control().shared_bytes});
  }
  if (control().has_transfer_queue && what == CL_DEVICE_HOST_UNIFIED_MEMORY) {
    set(value, size, cl_bool{CL_FALSE});
  }
  if (control().buffer_bytes != 0 && what == CL_DEVICE_MAX_MEM_ALLOC_SIZE) {
    set(value, size, cl_ulong{control().buffer_bytes});
  }
  if (control().pretends_to_be_gpu && what == CL_DEVICE_TYPE) {
    set(value, size, cl_device_type{CL_DEVICE_TYPE_GPU});
  }
  return result;
}

cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, std::size_t size,
                                 void* host, cl_int* result) {
  if (fails(control().allocations_left)) {
    if (result != nullptr) *result = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return nullptr;
  }
  return counted(next.clCreateBuffer(context, flags, size, host, result), Memory);
}

cl_context CL_API_CALL create_context(const cl_context_properties* properties, cl_uint count,
                                      const cl_device_id* devices,
                                      void(CL_CALLBACK* notify)(const char*, const void*,
                                                                std::size_t, void*),
                                      void* user, cl_int* result) {
  return counted(next.clCreateContext(properties, count, devices, notify, user, result), Context);
}

cl_command_queue CL_API_CALL create_queue(cl_context context, cl_device_id device,
                                          cl_command_queue_properties properties, cl_int* result) {
  return counted(next.clCreateCommandQueue(context, device, properties, result), CommandQueue);
}

cl_program CL_API_CALL create_from_source(cl_context context, cl_uint count, const char** texts,
                                          const std::size_t* lengths, cl_int* result) {
  return counted(next.clCreateProgramWithSource(context, count, texts, lengths, result), Program);
}

cl_program CL_API_CALL create_from_binary(cl_context context, cl_uint count,
                                          const cl_device_id* devices, const std::size_t* lengths,
                                          const unsigned char** binaries, cl_int* is_right,
                                          cl_int* result) {
  if (control().refuses_programs) {
    if (result != nullptr) *result = CL_INVALID_BINARY;
    return nullptr;
  }
  return counted(
      next.clCreateProgramWithBinary(context, count, devices, lengths, binaries, is_right, result),
      Program);
}

/// A compiler that takes float arithmetic for arithmetic, as some do unasked.
cl_int CL_API_CALL build(cl_program program, cl_uint count, const cl_device_id* devices,
                         const char* options, void(CL_CALLBACK* notify)(cl_program, void*),
                         void* user) {
  const std::string all =
      std::string(options) +
      (control().miscompiles ? " -cl-fast-relaxed-math -Dfma(a,b,c)=(a*b+c)" : "");
  if (control().failing_builds > 0) {
    --control().failing_builds;
    return CL_BUILD_PROGRAM_FAILURE;
  }
  return next.clBuildProgram(program, count, devices, all.c_str(), notify, user);
}

cl_kernel CL_API_CALL create_kernel(cl_program program, const char* name, cl_int* result) {
  return counted(next.clCreateKernel(program, name, result), Kernel);
}

cl_int CL_API_CALL compute(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                           const std::size_t* offset, const std::size_t* all,
                           const std::size_t* local, cl_uint waits, const cl_event* wait_list,
                           cl_event* event) {
  if (fails(control().submissions_left)) return CL_OUT_OF_RESOURCES;
  {
    const std::lock_guard lock(computing().mutex);
    computing().queues.insert(queue);
  }
  return next.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, all, local, waits,
                                     wait_list, event);
}

cl_int CL_API_CALL write(cl_command_queue queue, cl_mem buffer, cl_bool blocks, std::size_t offset,
                         std::size_t size, const void* from, cl_uint waits,
                         const cl_event* wait_list, cl_event* event) {
  if (fails(control().commands_left)) return CL_OUT_OF_RESOURCES;
  const cl_int result =
      next.clEnqueueWriteBuffer(queue, buffer, blocks, offset, size, from, waits, wait_list, event);
  if (result == CL_SUCCESS && event != nullptr) control().born(Event);
  const std::lock_guard lock(computing().mutex);
  // The list of windows, which is copied last, comes with an event.
  const bool is_pixels = blocks == CL_FALSE && event == nullptr;
  if (is_pixels && !computing().queues.contains(queue)) ++control().copies;
  return result;
}

cl_int CL_API_CALL read(cl_command_queue queue, cl_mem buffer, cl_bool blocks, std::size_t offset,
                        std::size_t size, void* to, cl_uint waits, const cl_event* wait_list,
                        cl_event* event) {
  if (fails(control().commands_left)) return CL_OUT_OF_RESOURCES;
  const cl_int result =
      next.clEnqueueReadBuffer(queue, buffer, blocks, offset, size, to, waits, wait_list, event);
  if (result == CL_SUCCESS && event != nullptr) control().born(Event);
  return result;
}

/// One look is a wait that is over, so that a lost device is found lost at the first.
cl_int CL_API_CALL get_event_info(cl_event event, cl_event_info what, std::size_t size, void* value,
                                  std::size_t* returned) {
  if (fails(control().waits_left)) return CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST;
  if (control().waits_left >= 0) next.clWaitForEvents(1, &event);
  const cl_int result = next.clGetEventInfo(event, what, size, value, returned);
  if (control().hangs && what == CL_EVENT_COMMAND_EXECUTION_STATUS) {
    set(value, size, cl_int{CL_RUNNING});
  }
  return result;
}

cl_int CL_API_CALL fill(cl_command_queue queue, cl_mem buffer, const void* pattern,
                        std::size_t pattern_size, std::size_t offset, std::size_t size,
                        cl_uint waits, const cl_event* wait_list, cl_event* event) {
  if (fails(control().commands_left)) return CL_OUT_OF_RESOURCES;
  return next.clEnqueueFillBuffer(queue, buffer, pattern, pattern_size, offset, size, waits,
                                  wait_list, event);
}

void* CL_API_CALL map(cl_command_queue queue, cl_mem buffer, cl_bool blocks, cl_map_flags flags,
                      std::size_t offset, std::size_t size, cl_uint waits,
                      const cl_event* wait_list, cl_event* event, cl_int* result) {
  if (fails(control().commands_left)) {
    if (result != nullptr) *result = CL_MAP_FAILURE;
    return nullptr;
  }
  return next.clEnqueueMapBuffer(queue, buffer, blocks, flags, offset, size, waits, wait_list,
                                 event, result);
}

cl_int CL_API_CALL unmap(cl_command_queue queue, cl_mem buffer, void* mapped, cl_uint waits,
                         const cl_event* wait_list, cl_event* event) {
  // Done all the same, or the memory would stay mapped for ever.
  const cl_int result =
      next.clEnqueueUnmapMemObject(queue, buffer, mapped, waits, wait_list, event);
  return fails(control().commands_left) ? CL_OUT_OF_HOST_MEMORY : result;
}

cl_int CL_API_CALL barrier(cl_command_queue queue, cl_uint waits, const cl_event* wait_list,
                           cl_event* event) {
  if (fails(control().commands_left)) return CL_OUT_OF_HOST_MEMORY;
  return next.clEnqueueBarrierWithWaitList(queue, waits, wait_list, event);
}

cl_int CL_API_CALL flush(cl_command_queue queue) {
  if (fails(control().commands_left)) return CL_OUT_OF_RESOURCES;
  return next.clFlush(queue);
}

cl_int CL_API_CALL release_queue(cl_command_queue queue) {
  {
    const std::lock_guard lock(computing().mutex);
    computing().queues.erase(queue);
  }
  control().dead(CommandQueue);
  return next.clReleaseCommandQueue(queue);
}

#define FATHOM_LAYER_RELEASE(function, type, entry, what) \
  cl_int CL_API_CALL function(type object) {              \
    control().dead(what);                                 \
    return next.entry(object);                            \
  }
FATHOM_LAYER_RELEASE(release_buffer, cl_mem, clReleaseMemObject, Memory)
FATHOM_LAYER_RELEASE(release_context, cl_context, clReleaseContext, Context)
FATHOM_LAYER_RELEASE(release_program, cl_program, clReleaseProgram, Program)
FATHOM_LAYER_RELEASE(release_kernel, cl_kernel, clReleaseKernel, Kernel)
FATHOM_LAYER_RELEASE(release_event, cl_event, clReleaseEvent, Event)

}  // namespace

FATHOM_LAYER_EXPORT LayerControl* fathom_test_layer_control() { return &control(); }

FATHOM_LAYER_EXPORT cl_int CL_API_CALL clGetLayerInfo(cl_layer_info what, std::size_t size,
                                                      void* value, std::size_t* returned) {
  if (what != CL_LAYER_API_VERSION) return CL_INVALID_VALUE;
  set(value, size, cl_layer_api_version{CL_LAYER_API_VERSION_100});
  if (returned != nullptr) *returned = sizeof(cl_layer_api_version);
  return CL_SUCCESS;
}

FATHOM_LAYER_EXPORT cl_int CL_API_CALL clInitLayer(cl_uint entries, const cl_icd_dispatch* target,
                                                   cl_uint* own_entries,
                                                   const cl_icd_dispatch** own_dispatch) {
  if (entries > sizeof own / sizeof(void*)) entries = sizeof own / sizeof(void*);
  std::memcpy(static_cast<void*>(&next), target, entries * sizeof(void*));
  own = next;
  own.clGetDeviceInfo = get_device_info;
  own.clCreateBuffer = create_buffer;
  own.clCreateContext = create_context;
  own.clCreateCommandQueue = create_queue;
  own.clCreateProgramWithSource = create_from_source;
  own.clCreateProgramWithBinary = create_from_binary;
  own.clBuildProgram = build;
  own.clCreateKernel = create_kernel;
  own.clEnqueueNDRangeKernel = compute;
  own.clEnqueueWriteBuffer = write;
  own.clEnqueueReadBuffer = read;
  own.clGetEventInfo = get_event_info;
  own.clEnqueueFillBuffer = fill;
  own.clEnqueueMapBuffer = map;
  own.clEnqueueUnmapMemObject = unmap;
  own.clEnqueueBarrierWithWaitList = barrier;
  own.clFlush = flush;
  own.clReleaseMemObject = release_buffer;
  own.clReleaseContext = release_context;
  own.clReleaseCommandQueue = release_queue;
  own.clReleaseProgram = release_program;
  own.clReleaseKernel = release_kernel;
  own.clReleaseEvent = release_event;
  *own_entries = entries;
  *own_dispatch = &own;
  return CL_SUCCESS;
}
