// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer for tests: counts objects, lets calls fail, and makes a device look smaller or
// richer than it is (control.hpp). The way in and the chain of functions are those that the loader
// prescribes (Vulkan-Loader, LoaderLayerInterface.md, interface version 2).
#include "tests/unit/gpu/control.hpp"

#define VK_NO_PROTOTYPES
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan_core.h>

#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#define FATHOM_LAYER_EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using fathom::test::fails;
using fathom::test::LayerControl;

/// Objects of a device that are made and destroyed in the same way.
#define FATHOM_LAYER_COUNTED(X) \
  X(Buffer)                     \
  X(Fence)                      \
  X(Semaphore)                  \
  X(ShaderModule)               \
  X(PipelineLayout)             \
  X(DescriptorSetLayout)        \
  X(DescriptorPool)             \
  X(CommandPool)                \
  X(PipelineCache)

enum Counted {
#define FATHOM_LAYER_ENUM(name) name,
  FATHOM_LAYER_COUNTED(FATHOM_LAYER_ENUM)
#undef FATHOM_LAYER_ENUM
      Pipeline,
  Memory,
  Device,
  Instance
};
constexpr const char* kNames[] = {
#define FATHOM_LAYER_NAME(name) #name,
    FATHOM_LAYER_COUNTED(FATHOM_LAYER_NAME)
#undef FATHOM_LAYER_NAME
        "Pipeline",
    "Memory", "Device", "Instance"};

LayerControl& control() {
  static LayerControl* const settings = fathom::test::new_control(kNames);
  return *settings;
}

/// A family number that no driver has.
constexpr std::uint32_t kTransferFamily = 1;

/// Of a shader stage, on the least device that Vulkan allows.
constexpr std::uint32_t kLeastStorageBuffers = 4;

using Functions = std::map<std::string, PFN_vkVoidFunction>;

/// This layer's functions by their Vulkan names.
const Functions& own_functions();

/// What comes after this layer, of one instance or device.
template <class Owner, class Get>
struct Chain {
  Owner owner;
  Get get;
  /// Of own_functions(), taken while the instance is made: later the loader answers with the whole
  /// chain, and that starts with this layer.
  Functions next;

  Chain(Owner its_owner, Get its_get) : owner(its_owner), get(its_get) {
    for (const auto& [name, own] : own_functions()) next[name] = get(owner, name.c_str());
  }
};

struct Chains {
  std::mutex mutex;
  // By dispatch table.
  std::map<void*, Chain<VkInstance, PFN_vkGetInstanceProcAddr>> instances;
  std::map<void*, Chain<VkDevice, PFN_vkGetDeviceProcAddr>> devices;
};

Chains& chains() {
  static auto* const all = new Chains;
  return *all;
}

/// Dispatchable handles point to their dispatch table, which instance and physical devices, and
/// device, queues and command buffers, have in common.
template <class Handle>
void* dispatch_of(Handle handle) {
  return *reinterpret_cast<void**>(handle);
}

template <class Function, class Handle>
Function next_of_instance(Handle handle, const char* name) {
  const std::lock_guard lock(chains().mutex);
  return reinterpret_cast<Function>(chains().instances.at(dispatch_of(handle)).next.at(name));
}

template <class Function, class Handle>
Function next_of_device(Handle handle, const char* name) {
  const std::lock_guard lock(chains().mutex);
  return reinterpret_cast<Function>(chains().devices.at(dispatch_of(handle)).next.at(name));
}

#define NEXT_OF_INSTANCE(handle, name) next_of_instance<PFN_vk##name>(handle, "vk" #name)
#define NEXT_OF_DEVICE(handle, name) next_of_device<PFN_vk##name>(handle, "vk" #name)

void born(Counted what) { control().born(what); }
void dead(Counted what) { control().dead(what); }

template <class CreateInfo, class LayerCreateInfo>
LayerCreateInfo* link_info(const CreateInfo* info, VkStructureType type) {
  auto* link = static_cast<const LayerCreateInfo*>(info->pNext);
  while (link != nullptr && !(link->sType == type && link->function == VK_LAYER_LINK_INFO)) {
    link = static_cast<const LayerCreateInfo*>(link->pNext);
  }
  return const_cast<LayerCreateInfo*>(link);
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkInstance* instance) {
  auto* const link = link_info<VkInstanceCreateInfo, VkLayerInstanceCreateInfo>(
      info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  const auto get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create =
      reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(chains().mutex);
  chains().instances.insert_or_assign(dispatch_of(*instance), Chain(*instance, get));
  born(Instance);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance,
                                            const VkAllocationCallbacks* allocator) {
  if (instance == VK_NULL_HANDLE) return;
  const auto destroy = NEXT_OF_INSTANCE(instance, DestroyInstance);
  {
    const std::lock_guard lock(chains().mutex);
    chains().instances.erase(dispatch_of(instance));
  }
  destroy(instance, allocator);
  dead(Instance);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical,
                                             const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator,
                                             VkDevice* device) {
  auto* const link = link_info<VkDeviceCreateInfo, VkLayerDeviceCreateInfo>(
      info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const auto get_of_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const auto get = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  VkInstance instance;
  {
    const std::lock_guard lock(chains().mutex);
    instance = chains().instances.at(dispatch_of(physical)).owner;
  }
  const auto create =
      reinterpret_cast<PFN_vkCreateDevice>(get_of_instance(instance, "vkCreateDevice"));
  VkDeviceCreateInfo without_fake = *info;
  if (control().has_transfer_queue) without_fake.queueCreateInfoCount = 1;
  const VkResult result = create(physical, &without_fake, allocator, device);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(chains().mutex);
  chains().devices.insert_or_assign(dispatch_of(*device), Chain(*device, get));
  born(Device);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* allocator) {
  if (device == VK_NULL_HANDLE) return;
  const auto destroy = NEXT_OF_DEVICE(device, DestroyDevice);
  {
    const std::lock_guard lock(chains().mutex);
    chains().devices.erase(dispatch_of(device));
  }
  destroy(device, allocator);
  dead(Device);
}

VKAPI_ATTR void VKAPI_CALL get_properties(VkPhysicalDevice physical,
                                          VkPhysicalDeviceProperties2* properties) {
  NEXT_OF_INSTANCE(physical, GetPhysicalDeviceProperties2)(physical, properties);
  VkPhysicalDeviceLimits& limits = properties->properties.limits;
  if (control().is_small) {  // Vulkan's required limits
    limits.maxComputeSharedMemorySize = 16384;
    limits.maxComputeWorkGroupInvocations = 128;
    limits.maxComputeWorkGroupSize[0] = 128;
    limits.maxComputeWorkGroupCount[0] = 50;
    limits.maxPerStageDescriptorStorageBuffers = kLeastStorageBuffers;
  }
  if (control().threads != 0) limits.maxComputeWorkGroupInvocations = control().threads;
  if (control().shared_bytes != 0) limits.maxComputeSharedMemorySize = control().shared_bytes;
  if (control().buffer_bytes != 0) limits.maxStorageBufferRange = control().buffer_bytes;
  if (control().pretends_to_be_gpu) {
    properties->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  }
}

VKAPI_ATTR void VKAPI_CALL get_queue_families(VkPhysicalDevice physical, std::uint32_t* count,
                                              VkQueueFamilyProperties* families) {
  const auto get = NEXT_OF_INSTANCE(physical, GetPhysicalDeviceQueueFamilyProperties);
  if (!control().has_transfer_queue) return get(physical, count, families);
  std::uint32_t real = 1;
  if (families != nullptr) {
    get(physical, &real, families);
    families[kTransferFamily] = families[0];
    families[kTransferFamily].queueFlags = VK_QUEUE_TRANSFER_BIT;
  }
  *count = 2;
}

VKAPI_ATTR void VKAPI_CALL get_queue(VkDevice device, std::uint32_t family, std::uint32_t index,
                                     VkQueue* queue) {
  const bool is_fake = control().has_transfer_queue && family == kTransferFamily;
  NEXT_OF_DEVICE(device, GetDeviceQueue)(device, is_fake ? 0 : family, index, queue);
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* infos,
                                      VkFence fence) {
  if (fails(control().submissions_left)) return VK_ERROR_DEVICE_LOST;
  if (count > 0 && infos[0].signalSemaphoreCount > 0) ++control().copies;
  return NEXT_OF_DEVICE(queue, QueueSubmit)(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice device, std::uint32_t count,
                                               const VkFence* fences, VkBool32 all,
                                               std::uint64_t timeout) {
  // At once: the device may be at it still.
  if (fails(control().waits_left)) return VK_ERROR_DEVICE_LOST;
  constexpr std::uint64_t kForEver = ~std::uint64_t{0};
  if (control().hangs) return timeout == kForEver ? VK_ERROR_UNKNOWN : VK_TIMEOUT;
  return NEXT_OF_DEVICE(device, WaitForFences)(device, count, fences, all, timeout);
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkDeviceMemory* memory) {
  if (fails(control().allocations_left)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const VkResult result = NEXT_OF_DEVICE(device, AllocateMemory)(device, info, allocator, memory);
  if (result == VK_SUCCESS) born(Memory);
  return result;
}

VKAPI_ATTR void VKAPI_CALL free_memory(VkDevice device, VkDeviceMemory memory,
                                       const VkAllocationCallbacks* allocator) {
  if (memory != VK_NULL_HANDLE) dead(Memory);
  NEXT_OF_DEVICE(device, FreeMemory)(device, memory, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache,
                                                std::uint32_t count,
                                                const VkComputePipelineCreateInfo* infos,
                                                const VkAllocationCallbacks* allocator,
                                                VkPipeline* pipelines) {
  const VkResult result = NEXT_OF_DEVICE(device, CreateComputePipelines)(
      device, cache, count, infos, allocator, pipelines);
  if (result == VK_SUCCESS) born(Pipeline);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_pipeline(VkDevice device, VkPipeline pipeline,
                                            const VkAllocationCallbacks* allocator) {
  if (pipeline != VK_NULL_HANDLE) dead(Pipeline);
  NEXT_OF_DEVICE(device, DestroyPipeline)(device, pipeline, allocator);
}

/// The driver knows one family only, so what the fake one is asked for is the real one's.
template <class CreateInfo>
CreateInfo for_the_driver(const CreateInfo& info) {
  return info;
}
VkBufferCreateInfo for_the_driver(const VkBufferCreateInfo& info) {
  VkBufferCreateInfo real = info;
  if (control().has_transfer_queue) {
    real.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    real.queueFamilyIndexCount = 0;
  }
  return real;
}
VkCommandPoolCreateInfo for_the_driver(const VkCommandPoolCreateInfo& info) {
  VkCommandPoolCreateInfo real = info;
  if (control().has_transfer_queue) real.queueFamilyIndex = 0;
  return real;
}

/// The module with every floating-point product of two numbers turned into a sum.
std::vector<std::uint32_t> miscompiled(const VkShaderModuleCreateInfo& info) {
  constexpr std::size_t kHeader = 5;  // words before the first instruction (SPIR-V 2.3)
  constexpr std::uint32_t kFMul = 133, kFAdd = 129, kOpcode = 0xffff;
  std::vector<std::uint32_t> words(info.pCode, info.pCode + info.codeSize / 4);
  for (std::size_t at = kHeader; at < words.size(); at += words[at] >> 16) {
    if ((words[at] & kOpcode) == kFMul) words[at] = (words[at] & ~kOpcode) | kFAdd;
  }
  return words;
}
VkPipelineCacheCreateInfo for_the_driver(const VkPipelineCacheCreateInfo& info) {
  VkPipelineCacheCreateInfo real = info;
  if (control().refuses_programs) real.initialDataSize = 0;  // what a driver does that knows better
  return real;
}
VkShaderModuleCreateInfo for_the_driver(const VkShaderModuleCreateInfo& info) {
  static thread_local std::vector<std::uint32_t> words;
  VkShaderModuleCreateInfo real = info;
  if (control().miscompiles) {
    words = miscompiled(info);
    real.pCode = words.data();
  }
  return real;
}

/// What a device that keeps to its own limits makes.
template <class CreateInfo>
bool is_within_limits(const CreateInfo&) {
  return true;
}
bool is_within_limits(const VkDescriptorSetLayoutCreateInfo& info) {
  return !control().is_small || info.bindingCount <= kLeastStorageBuffers;
}

#define FATHOM_LAYER_FUNCTIONS(name)                                                              \
  VKAPI_ATTR VkResult VKAPI_CALL create_##name(VkDevice device, const Vk##name##CreateInfo* info, \
                                               const VkAllocationCallbacks* allocator,            \
                                               Vk##name* object) {                                \
    if (!is_within_limits(*info)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;                           \
    const auto real = for_the_driver(*info);                                                      \
    const VkResult result =                                                                       \
        NEXT_OF_DEVICE(device, Create##name)(device, &real, allocator, object);                   \
    if (result == VK_SUCCESS) born(Counted::name);                                                \
    return result;                                                                                \
  }                                                                                               \
  VKAPI_ATTR void VKAPI_CALL destroy_##name(VkDevice device, Vk##name object,                     \
                                            const VkAllocationCallbacks* allocator) {             \
    if (object != VK_NULL_HANDLE) dead(Counted::name);                                            \
    NEXT_OF_DEVICE(device, Destroy##name)(device, object, allocator);                             \
  }
FATHOM_LAYER_COUNTED(FATHOM_LAYER_FUNCTIONS)

const Functions& own_functions() {
#define FATHOM_LAYER_ENTRY(vulkan, own) \
  { vulkan, reinterpret_cast<PFN_vkVoidFunction>(own) }
#define FATHOM_LAYER_ENTRIES(name)                     \
  FATHOM_LAYER_ENTRY("vkCreate" #name, create_##name), \
      FATHOM_LAYER_ENTRY("vkDestroy" #name, destroy_##name),
  static const Functions functions = {
      FATHOM_LAYER_COUNTED(FATHOM_LAYER_ENTRIES)  //
      FATHOM_LAYER_ENTRY("vkCreateInstance", create_instance),
      FATHOM_LAYER_ENTRY("vkDestroyInstance", destroy_instance),
      FATHOM_LAYER_ENTRY("vkCreateDevice", create_device),
      FATHOM_LAYER_ENTRY("vkDestroyDevice", destroy_device),
      FATHOM_LAYER_ENTRY("vkGetPhysicalDeviceProperties2", get_properties),
      FATHOM_LAYER_ENTRY("vkGetPhysicalDeviceQueueFamilyProperties", get_queue_families),
      FATHOM_LAYER_ENTRY("vkGetDeviceQueue", get_queue),
      FATHOM_LAYER_ENTRY("vkQueueSubmit", submit),
      FATHOM_LAYER_ENTRY("vkWaitForFences", wait_for_fences),
      FATHOM_LAYER_ENTRY("vkAllocateMemory", allocate_memory),
      FATHOM_LAYER_ENTRY("vkFreeMemory", free_memory),
      FATHOM_LAYER_ENTRY("vkCreateComputePipelines", create_pipelines),
      FATHOM_LAYER_ENTRY("vkDestroyPipeline", destroy_pipeline)};
  return functions;
}

PFN_vkVoidFunction own_function(const char* name) {
  const auto found = own_functions().find(name);
  return found == own_functions().end() ? nullptr : found->second;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(get_device_function);
  }
  if (const auto own = own_function(name)) return own;
  const std::lock_guard lock(chains().mutex);
  return chains().devices.at(dispatch_of(device)).get(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance,
                                                               const char* name) {
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(get_instance_function);
  }
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(get_device_function);
  }
  if (const auto own = own_function(name)) return own;
  if (instance == VK_NULL_HANDLE) return nullptr;
  const std::lock_guard lock(chains().mutex);
  return chains().instances.at(dispatch_of(instance)).get(instance, name);
}

}  // namespace

FATHOM_LAYER_EXPORT LayerControl* fathom_test_layer_control() { return &control(); }

FATHOM_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = get_instance_function;
  version->pfnGetDeviceProcAddr = get_device_function;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
