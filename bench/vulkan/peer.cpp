// SPDX-License-Identifier: Apache-2.0
#include "bench/vulkan/peer.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <vector>

#include "backends/vulkan/flight.hpp"
#include "bench/peers/device_batch.hpp"
#include "bench/peers/tables.hpp"
#include "bench/vulkan/kernel.hpp"
#include "bench/vulkan/vkfft.hpp"
#include "engine/error.hpp"

namespace fathom::bench {
namespace {

using vulkan::Buffer;
using vulkan::Place;

constexpr std::uint32_t kGroup = 256;  // invocations of a workgroup, as in the kernels

// Written by glslc.
constexpr std::uint32_t kWiden[] = {
#include "peer_widen.spirv"
};
constexpr std::uint32_t kSum[] = {
#include "peer_sum.spirv"
};

/// The first device that can be opened.
std::optional<vulkan::PhysicalDevice> first_device(const vulkan::Instance& instance) {
  const auto& devices = instance.devices();
  const auto found = std::find_if(devices.begin(), devices.end(),
                                  [](const auto& device) { return device.refusal.empty(); });
  if (found == devices.end()) return std::nullopt;
  return *found;
}

/// One for all peers that live: VkFFT knows of one device at a time.
std::shared_ptr<vulkan::Context> shared_context() {
  static std::weak_ptr<vulkan::Context> shared;
  if (auto context = shared.lock()) return context;
  const auto instance = std::make_shared<const vulkan::Instance>();
  const auto device = first_device(*instance);
  if (!device) throw std::runtime_error("Vulkan peer: no Vulkan device");
  auto context = std::make_shared<vulkan::Context>(instance, *device);
  shared = context;
  return context;
}

class VulkanPeer final : public PreparedPeer {
 public:
  VulkanPeer(std::shared_ptr<vulkan::Context> context, int n, std::size_t batch)
      : context_(std::move(context)),
        n_(static_cast<std::uint32_t>(n)),
        batch_(batch),
        factor_(score_factor(n)),
        taper_(constant(hann_taper(n), "a taper")),
        weights_(constant(half_plane_weights(n), "weights")),
        data_(context_->buffer(batch * n_ * (n_ + 2) * sizeof(float), Place::device, "a batch")),
        origins_(context_->buffer(4 * batch, Place::host_written, "a list of windows")),
        scores_(context_->buffer(4 * batch, Place::device_written, "scores")),
        widen_(*context_, kWiden, n_, 4),
        fft_(make_vulkan_fft(*context_, n, batch, data_)),
        sum_(*context_, kSum, n_, 3),
        commands_(*context_, context_->physical().compute_family),
        done_(context_->fence()) {
    sum_.bind({&data_, &weights_, &scores_});
  }
  ~VulkanPeer() override { context_->drain(); }

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    load(frame);
    for (std::size_t first = 0; first < windows.size(); first += batch_) {
      const std::size_t count = std::min(batch_, windows.size() - first);
      score_batch(frame, windows.subspan(first, count), scores.subspan(first, count), first == 0);
    }
  }

 private:
  Buffer constant(const std::vector<float>& numbers, const char* what) const {
    Buffer made = context_->buffer(4 * numbers.size(), Place::host_written, what);
    std::memcpy(made.mapped, numbers.data(), 4 * numbers.size());
    return made;
  }

  /// To where the device takes it.
  void load(const Frame& frame) {
    const std::size_t bytes = frame.stride_bytes() * static_cast<std::size_t>(frame.height_px());
    const std::size_t whole_words = (bytes + 3) / 4 * 4;
    if (whole_words > frame_.bytes) {
      staging_ = context_->buffer(whole_words, Place::upload, "a frame to upload");
      frame_ = context_->buffer(whole_words, Place::device, "a frame");
      widen_.bind({&frame_, &origins_, &taper_, &data_});
    }
    std::memcpy(staging_.mapped, frame.row(0), bytes);
  }

  void barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written,
               VkPipelineStageFlags to, VkAccessFlags wanted) const {
    const VkMemoryBarrier memory = {VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, written, wanted};
    context_->api().vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
  }

  void between_kernels(VkCommandBuffer commands) const {
    barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
            VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  }

  void upload(VkCommandBuffer commands) const {
    const VkBufferCopy region = {0, 0, frame_.bytes};
    context_->api().vkCmdCopyBuffer(commands, staging_.buffer.get(), frame_.buffer.get(), 1,
                                    &region);
    barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
  }

  void compute(VkCommandBuffer commands, const Frame& frame, std::size_t windows) const {
    const KernelArgs args = {static_cast<std::uint32_t>(windows),
                             static_cast<std::uint32_t>(frame.stride_bytes())};
    widen_.record(commands, args, (args.windows * n_ * n_ + kGroup - 1) / kGroup);
    between_kernels(commands);
    fft_->record(commands);
    between_kernels(commands);
    sum_.record(commands, args, args.windows);
    barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
            VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
  }

  void score_batch(const Frame& frame, std::span<const Window> windows, std::span<double> scores,
                   bool is_first) {
    const auto origins = window_origins(frame, windows);
    std::memcpy(origins_.mapped, origins.data(), 4 * origins.size());
    const VkCommandBuffer commands = commands_.begin();
    if (is_first) upload(commands);
    compute(commands, frame, windows.size());
    commands_.end();
    context_->submit(commands, VK_NULL_HANDLE, done_.get());
    context_->wait(done_.get(), 0);
    const auto* const sums = static_cast<const float*>(scores_.mapped);
    std::transform(sums, sums + windows.size(), scores.begin(),
                   [this](float sum) { return factor_ * double{sum}; });
  }

  std::shared_ptr<vulkan::Context> context_;
  std::uint32_t n_;
  std::size_t batch_;
  double factor_;
  Buffer taper_, weights_, data_, origins_, scores_;
  VulkanKernel widen_;
  std::unique_ptr<VulkanFft> fft_;
  VulkanKernel sum_;
  vulkan::Commands commands_;
  vulkan::Handle<VkFence> done_;
  Buffer staging_, frame_;
};

}  // namespace

bool has_vulkan_device() {
  try {
    return first_device(vulkan::Instance()).has_value();
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<PreparedPeer> prepare_vkfft_vulkan(int n, Planning) {
  return std::make_unique<VulkanPeer>(shared_context(), n, device_batch(n));
}

}  // namespace fathom::bench
