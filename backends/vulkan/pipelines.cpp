// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/pipelines.hpp"

#include <chrono>

#include "backends/vulkan/spirv.hpp"
#include "engine/cache.hpp"
#include "engine/error.hpp"

namespace fathom::vulkan {
namespace {

/// Compiling that took so long is kept at once, in case the process never ends in peace.
constexpr double kWorthKeeping_s = 0.5;

Handle<VkDescriptorSetLayout> make_set_layout(const DeviceApi& api, VkDevice device) {
  std::array<VkDescriptorSetLayoutBinding, FATHOM_BINDINGS> bindings = {};
  for (std::uint32_t i = 0; i < bindings.size(); ++i) {
    bindings[i].binding = i;
    bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  VkDescriptorSetLayoutCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  check(api.vkCreateDescriptorSetLayout(device, &info, nullptr, &layout), "a descriptor layout");
  return {device, layout, api.vkDestroyDescriptorSetLayout};
}

Handle<VkPipelineLayout> make_layout(const DeviceApi& api, VkDevice device,
                                     VkDescriptorSetLayout set_layout) {
  const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(kernels::ScoreArgs)};
  VkPipelineLayoutCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(api.vkCreatePipelineLayout(device, &info, nullptr, &layout), "a pipeline layout");
  return {device, layout, api.vkDestroyPipelineLayout};
}

std::string data_of(const DeviceApi& api, VkDevice device, VkPipelineCache cache) {
  std::size_t bytes = 0;
  if (api.vkGetPipelineCacheData(device, cache, &bytes, nullptr) != VK_SUCCESS) return {};
  std::string data(bytes, '\0');
  if (api.vkGetPipelineCacheData(device, cache, &bytes, data.data()) != VK_SUCCESS) return {};
  data.resize(bytes);
  return data;
}

}  // namespace

Pipelines::Pipelines(const DeviceApi& api, VkDevice device, std::string identity)
    : api_(api),
      device_(device),
      identity_(std::move(identity)),
      set_layout_(make_set_layout(api, device)),
      layout_(make_layout(api, device, set_layout_.get())),
      cache_(open_cache(read_cached(file_name(), kernels_key()).value_or(std::string()))) {}

Pipelines::~Pipelines() {
  if (unkept_s_ > 0) try_to_keep();
}

void Pipelines::try_to_keep() noexcept {
  try {
    keep();
  } catch (const std::exception&) {
    // The next process compiles again.
  }
}

std::string Pipelines::file_name() const { return "vulkan-" + identity_ + ".pipelines"; }

Handle<VkPipelineCache> Pipelines::open_cache(std::string_view data) const {
  VkPipelineCacheCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  VkPipelineCache cache = VK_NULL_HANDLE;
  VkResult result = api_.vkCreatePipelineCache(device_, &info, nullptr, &cache);
  if (result != VK_SUCCESS && !data.empty()) {  // a driver that does not like its own data
    info.initialDataSize = 0;
    result = api_.vkCreatePipelineCache(device_, &info, nullptr, &cache);
  }
  check(result, "a pipeline cache");
  return {device_, cache, api_.vkDestroyPipelineCache};
}

void Pipelines::keep() {
  unkept_s_ = 0;
  const auto kept = read_cached(file_name(), kernels_key());
  if (kept) {  // maybe by another process, since this one started
    const Handle<VkPipelineCache> cache = open_cache(*kept);
    const VkPipelineCache source = cache.get();
    api_.vkMergePipelineCaches(device_, cache_.get(), 1, &source);
  }
  const std::string data = data_of(api_, device_, cache_.get());
  if (data.empty()) return;
  if (!kept || kept->size() != data.size()) write_cached(file_name(), kernels_key(), data);
}

Handle<VkShaderModule> Pipelines::module(gpu::Kernel kernel) const {
  const std::span<const std::uint32_t> code = spirv(kernel);
  VkShaderModuleCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  info.codeSize = code.size_bytes();
  info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(api_.vkCreateShaderModule(device_, &info, nullptr, &module), "a shader module");
  return {device_, module, api_.vkDestroyShaderModule};
}

VkPipeline Pipelines::get(gpu::Kernel kernel, const gpu::Constants& constants) {
  // Plans that want the same wait for the one that compiles it.
  const std::lock_guard lock(mutex_);
  const auto known = pipelines_.find({kernel, constants});
  if (known != pipelines_.end()) return known->second.get();
  std::array<VkSpecializationMapEntry, FATHOM_CONSTANTS> entries = {};
  for (std::uint32_t id = 0; id < entries.size(); ++id) {
    entries[id] = {id, static_cast<std::uint32_t>(id * sizeof(std::uint32_t)),
                   sizeof(std::uint32_t)};
  }
  const VkSpecializationInfo specialization = {static_cast<std::uint32_t>(entries.size()),
                                               entries.data(), sizeof(constants), constants.data()};
  const Handle<VkShaderModule> code = module(kernel);
  VkComputePipelineCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = code.get();
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout_.get();
  const auto start = std::chrono::steady_clock::now();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(api_.vkCreateComputePipelines(device_, cache_.get(), 1, &info, nullptr, &pipeline),
        "compiling a kernel");
  pipelines_[{kernel, constants}] = {device_, pipeline, api_.vkDestroyPipeline};
  unkept_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (unkept_s_ > kWorthKeeping_s) try_to_keep();
  return pipeline;
}

}  // namespace fathom::vulkan
