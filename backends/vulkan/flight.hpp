// SPDX-License-Identifier: Apache-2.0
// One batch on its way through the device: its pixels, its windows, its scores, its commands.
#pragma once

#include <span>

#include "backends/gpu/batch.hpp"
#include "backends/vulkan/commands.hpp"
#include "backends/vulkan/program.hpp"

namespace fathom::vulkan {

class Flight {
 public:
  /// windows: most of one batch; words: that the kernel leaves of each. Throws
  /// Error(out_of_memory).
  Flight(Context& context, std::size_t windows, std::size_t words);

  /// Copies pixels to where the device takes them, growing the buffer where no part was as large,
  /// and tells the kernel where each window starts: those of `ids`, or all in their order where
  /// `ids` is empty.
  void load(const Frame& frame, const gpu::Rectangle& part, std::span<const Window> windows,
            std::span<const std::uint32_t> ids);

  /// Starts the program, and `rescue`, if any, for windows that it is in doubt about, on what was
  /// loaded. What the flight's last batch was must be over. Pixels that an earlier start has
  /// uploaded stay on the device until the next load(). Coefficients are window 0's alone.
  void start(const Program& program, const Program* rescue, const kernels::ScoreArgs& args,
             gpu::Wanted wanted);

  /// Waits until what was started is over. Throws Error(device_lost, timeout).
  void finish();

  /// What the kernel wrote, window by window.
  const std::uint32_t* results() const { return static_cast<const std::uint32_t*>(scores_.mapped); }
  /// What it wrote instead: gpu::spectrum_words() of them.
  const std::uint32_t* coefficients() const {
    return static_cast<const std::uint32_t*>(spectrum_.mapped);
  }

 private:
  void show(VkDescriptorSet set, const Program& program, gpu::Wanted wanted) const;
  void record_copy(VkCommandBuffer commands) const;
  void record(VkCommandBuffer commands, const Program& program, const Program* rescue,
              kernels::ScoreArgs args, gpu::Wanted wanted) const;
  bool must_upload() const { return staging_.bytes > 0 && !is_uploaded_; }

  Context& context_;
  Handle<VkFence> done_;
  Handle<VkSemaphore> uploaded_;  // null without a queue for copies
  Commands compute_;
  Commands transfer_;
  Handle<VkDescriptorPool> descriptor_pool_;
  VkDescriptorSet sets_[2] = {};  // of the pool: for the program and for its rescue
  Buffer staging_;                // empty where the host writes straight to the device
  Buffer frame_;                  // where each window starts, then the pixels
  Buffer scores_;
  Buffer doubtful_;
  Buffer spectrum_;  // once coefficients were wanted
  std::size_t frame_bytes_ = 0;
  std::size_t windows_ = 0;
  std::uint32_t stride_words_ = 0;
  Depth depth_ = Depth::bits8;
  bool is_uploaded_ = false;
};

}  // namespace fathom::vulkan
