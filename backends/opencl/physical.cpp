// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/physical.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "backends/gpu/drivers_process.hpp"
#include "engine/cache.hpp"

namespace fathom::opencl {
namespace {

/// Where vendors say how many threads go in step.
struct Extension {
  const char* name;
  cl_device_info what;
};
constexpr Extension kExtensions[] = {{"cl_nv_device_attribute_query", 0x4003},
                                     {"cl_amd_device_attribute_query", 0x4043}};
constexpr cl_uint kNvidia = 0x10de, kAmd = 0x1002;

std::string text_of(cl_platform_id platform, cl_platform_info what) {
  std::size_t bytes = 0;
  if (cl().GetPlatformInfo(platform, what, 0, nullptr, &bytes) != CL_SUCCESS) return {};
  std::string text(bytes, '\0');
  cl().GetPlatformInfo(platform, what, bytes, text.data(), nullptr);
  return text.c_str();  // without the zero at its end, or several
}

/// Empty where the driver does not know.
std::string text_of(cl_device_id device, cl_device_info what) {
  std::size_t bytes = 0;
  if (cl().GetDeviceInfo(device, what, 0, nullptr, &bytes) != CL_SUCCESS) return {};
  std::string text(bytes, '\0');
  cl().GetDeviceInfo(device, what, bytes, text.data(), nullptr);
  return text.c_str();  // without the zero at its end, or several
}

/// What a driver does not know it does not set.
template <class T>
T number_of(cl_device_id device, cl_device_info what, T otherwise = {}) {
  T number = otherwise;
  const cl_int result = cl().GetDeviceInfo(device, what, sizeof number, &number, nullptr);
  return result == CL_SUCCESS ? number : otherwise;
}

/// 10 major + minor of "OpenCL 1.2 ...".
int version_of(const std::string& text) {
  int major = 0, minor = 0;
  std::sscanf(text.c_str(), "OpenCL %d.%d", &major, &minor);
  return 10 * major + minor;
}

const char* type_name(cl_device_type type) {
  if ((type & CL_DEVICE_TYPE_GPU) != 0) return "GPU";
  if ((type & CL_DEVICE_TYPE_ACCELERATOR) != 0) return "accelerator";
  if ((type & CL_DEVICE_TYPE_CPU) != 0) return "processor";
  return "unknown type";
}

std::uint32_t subgroup_of(cl_device_id id, int version) {
  std::size_t multiple = 0;
  if (version >= 30) {
    multiple = number_of<std::size_t>(id, CL_DEVICE_PREFERRED_WORK_GROUP_SIZE_MULTIPLE);
  }
  const std::string extensions = text_of(id, CL_DEVICE_EXTENSIONS);
  for (const Extension& extension : kExtensions) {
    const bool is_there = extensions.find(extension.name) != std::string::npos;
    if (multiple == 0 && is_there) multiple = number_of<cl_uint>(id, extension.what);
  }
  return multiple > 0 ? static_cast<std::uint32_t>(multiple) : 32;
}

std::uint32_t threads_of(cl_device_id id) {
  // More would be no faster, and a processor keeps what each has in memory.
  constexpr std::size_t kMost = 1024;
  std::vector<std::size_t> sizes(number_of<cl_uint>(id, CL_DEVICE_MAX_WORK_ITEM_DIMENSIONS, 3));
  const cl_int result = cl().GetDeviceInfo(id, CL_DEVICE_MAX_WORK_ITEM_SIZES,
                                           sizes.size() * sizeof sizes[0], sizes.data(), nullptr);
  const std::size_t along = result == CL_SUCCESS && !sizes.empty() ? sizes[0] : kMost;
  return static_cast<std::uint32_t>(
      std::min({along, number_of<std::size_t>(id, CL_DEVICE_MAX_WORK_GROUP_SIZE), kMost}));
}

/// Vectors for a processor whose driver leaves them to the kernel. One that makes them itself, of
/// several threads, says that its own width is one.
int lanes_of(cl_device_id id, cl_device_type type) {
  const auto width = number_of<cl_uint>(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, 1);
  if ((type & CL_DEVICE_TYPE_CPU) == 0 || width < 4) return 1;
  return width >= 16 ? 16 : width >= 8 ? 8 : 4;
}

gpu::Limits limits_of(cl_device_id id, cl_device_type type, int version) {
  gpu::Limits limits;
  limits.shared_bytes = static_cast<std::uint32_t>(
      std::min<cl_ulong>(number_of<cl_ulong>(id, CL_DEVICE_LOCAL_MEM_SIZE), 1U << 30));
  limits.threads = threads_of(id);
  limits.workgroups = 65535;  // OpenCL has no limit; a watchdog may
  limits.buffer_bytes = number_of<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  limits.device_bytes = number_of<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
  limits.subgroup = subgroup_of(id, version);
  limits.processors = std::max(number_of<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS), 1U);
  limits.lanes = lanes_of(id, type);
  const auto vendor = number_of<cl_uint>(id, CL_DEVICE_VENDOR_ID);
  limits.points = vendor == kNvidia || vendor == kAmd ? 64 : 16;
  return limits;
}

std::string refusal_of(cl_device_id id, int version, cl_device_type type) {
  if (version < 12) return "its driver is older than OpenCL 1.2";
  if (number_of<cl_bool>(id, CL_DEVICE_AVAILABLE) == CL_FALSE) return "it is not available now";
  if (number_of<cl_bool>(id, CL_DEVICE_COMPILER_AVAILABLE) == CL_FALSE) {
    return "its driver compiles no kernels";
  }
  if (number_of<cl_bool>(id, CL_DEVICE_ENDIAN_LITTLE) == CL_FALSE) return "it is big-endian";
  if (type == CL_DEVICE_TYPE_CUSTOM) return "it has fixed functions only";
  return {};
}

PhysicalDevice describe(cl_platform_id platform, cl_device_id id) {
  const std::string version_text = text_of(id, CL_DEVICE_VERSION);
  const int version = version_of(version_text);
  const auto type = number_of<cl_device_type>(id, CL_DEVICE_TYPE);
  PhysicalDevice device;
  device.platform = platform;
  device.id = id;
  device.limits = limits_of(id, type, version);
  device.is_unified = number_of<cl_bool>(id, CL_DEVICE_HOST_UNIFIED_MEMORY) == CL_TRUE;
  device.refusal = refusal_of(id, version, type);
  device.info.name = text_of(id, CL_DEVICE_NAME);
  const bool is_gpu = (type & (CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR)) != 0;
  device.info.kind = is_gpu ? DeviceKind::gpu : DeviceKind::software;
  const gpu::Limits& limits = device.limits;
  const std::string maker = text_of(platform, CL_PLATFORM_NAME);
  const std::string driver = text_of(id, CL_DRIVER_VERSION);
  device.info.details =
      fmt::format("{}, OpenCL {}.{}, {} {}, {} KiB shared, {}, {} MiB a buffer", type_name(type),
                  version / 10, version % 10, maker, driver, limits.shared_bytes / 1024,
                  limits.lanes > 1
                      ? fmt::format("vectors of {}", limits.lanes)
                      : fmt::format("{} threads, subgroups of {}", limits.threads, limits.subgroup),
                  limits.buffer_bytes >> 20);
  device.identity = fmt::format(
      "{:016x}",
      hash_of(fmt::format("{}\n{}\n{}\n{}\n{}\n{}", maker, text_of(platform, CL_PLATFORM_VERSION),
                          device.info.name, text_of(id, CL_DEVICE_VENDOR), version_text, driver)));
  return device;
}

std::vector<cl_platform_id> platforms() {
  cl_uint count = 0;
  check(cl().GetPlatformIDs(0, nullptr, &count), "listing platforms");
  std::vector<cl_platform_id> ids(count);
  if (count > 0) check(cl().GetPlatformIDs(count, ids.data(), nullptr), "listing platforms");
  return ids;
}

/// None where the platform fails: others may not.
std::vector<cl_device_id> devices_of(cl_platform_id platform) {
  cl_uint count = 0;
  if (cl().GetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) return {};
  std::vector<cl_device_id> ids(count);
  const cl_int result = cl().GetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr);
  return result == CL_SUCCESS ? ids : std::vector<cl_device_id>();
}

}  // namespace

std::vector<PhysicalDevice> list_devices() {
  gpu::require_process_for_drivers();
  std::vector<PhysicalDevice> devices;
  for (cl_platform_id platform : platforms()) {
    for (cl_device_id id : devices_of(platform)) devices.push_back(describe(platform, id));
  }
  return devices;
}

}  // namespace fathom::opencl
