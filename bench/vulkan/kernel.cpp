// SPDX-License-Identifier: Apache-2.0
#include "bench/vulkan/kernel.hpp"

namespace fathom::bench {
namespace {

using vulkan::Buffer;
using vulkan::check;
using vulkan::Context;
using vulkan::Handle;

Handle<VkDescriptorSetLayout> make_set_layout(const Context& context, std::uint32_t buffers) {
  std::vector<VkDescriptorSetLayoutBinding> bindings(buffers);
  for (std::uint32_t i = 0; i < buffers; ++i) {
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  info.bindingCount = buffers;
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  check(context.api().vkCreateDescriptorSetLayout(context.device(), &info, nullptr, &layout),
        "a descriptor layout");
  return {context.device(), layout, context.api().vkDestroyDescriptorSetLayout};
}

Handle<VkPipelineLayout> make_layout(const Context& context, VkDescriptorSetLayout set_layout) {
  const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(KernelArgs)};
  VkPipelineLayoutCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(context.api().vkCreatePipelineLayout(context.device(), &info, nullptr, &layout),
        "a pipeline layout");
  return {context.device(), layout, context.api().vkDestroyPipelineLayout};
}

Handle<VkShaderModule> make_module(const Context& context, std::span<const std::uint32_t> spirv) {
  VkShaderModuleCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  info.codeSize = spirv.size_bytes();
  info.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(context.api().vkCreateShaderModule(context.device(), &info, nullptr, &module),
        "a shader module");
  return {context.device(), module, context.api().vkDestroyShaderModule};
}

Handle<VkPipeline> make_pipeline(const Context& context, VkPipelineLayout layout,
                                 std::span<const std::uint32_t> spirv, std::uint32_t n) {
  const Handle<VkShaderModule> module = make_module(context, spirv);
  const VkSpecializationMapEntry entry = {0, 0, sizeof n};
  const VkSpecializationInfo specialization = {1, &entry, sizeof n, &n};
  VkComputePipelineCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module.get();
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(context.api().vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr,
                                               &pipeline),
        "compiling a kernel");
  return {context.device(), pipeline, context.api().vkDestroyPipeline};
}

Handle<VkDescriptorPool> make_pool(const Context& context, std::uint32_t buffers) {
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, buffers};
  VkDescriptorPoolCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.maxSets = 1;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(context.api().vkCreateDescriptorPool(context.device(), &info, nullptr, &pool),
        "a descriptor pool");
  return {context.device(), pool, context.api().vkDestroyDescriptorPool};
}

}  // namespace

VulkanKernel::VulkanKernel(const Context& context, std::span<const std::uint32_t> spirv,
                           std::uint32_t n, std::uint32_t buffers)
    : context_(context),
      set_layout_(make_set_layout(context, buffers)),
      layout_(make_layout(context, set_layout_.get())),
      pipeline_(make_pipeline(context, layout_.get(), spirv, n)),
      pool_(make_pool(context, buffers)) {
  const VkDescriptorSetLayout layout = set_layout_.get();
  VkDescriptorSetAllocateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = pool_.get();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  check(context.api().vkAllocateDescriptorSets(context.device(), &info, &set_), "a descriptor set");
}

void VulkanKernel::bind(std::initializer_list<const Buffer*> buffers) {
  std::uint32_t binding = 0;
  for (const Buffer* buffer : buffers) {
    const VkDescriptorBufferInfo whole = {buffer->buffer.get(), 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write = {};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set_;
    write.dstBinding = binding++;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &whole;
    context_.api().vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
  }
}

void VulkanKernel::record(VkCommandBuffer commands, const KernelArgs& args,
                          std::uint32_t workgroups) const {
  const auto& api = context_.api();
  api.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
  api.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set_,
                              0, nullptr);
  api.vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof args,
                         &args);
  api.vkCmdDispatch(commands, workgroups, 1, 1);
}

}  // namespace fathom::bench
