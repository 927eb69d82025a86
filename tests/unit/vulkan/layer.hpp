// SPDX-License-Identifier: Apache-2.0
// What the test layer (layer.cpp) does to Vulkan calls, as the test that loads it says. A layer
// sits between the loader and the driver, so what is tested is the library as it is, on a real
// driver.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace fathom::test {

/// Objects whose creations and destructions are counted.
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

enum class Counted {
#define FATHOM_LAYER_ENUM(name) name,
  FATHOM_LAYER_COUNTED(FATHOM_LAYER_ENUM)
#undef FATHOM_LAYER_ENUM
      Pipeline,
  Memory,
  Device,
  Instance,
  kCount
};

struct LayerControl {
  std::array<std::atomic<int>, static_cast<int>(Counted::kCount)> alive = {};
  std::array<std::atomic<int>, static_cast<int>(Counted::kCount)> created = {};

  /// Allocations of memory until one fails; below zero: none does.
  std::atomic<int> allocations_left = -1;
  /// Submissions, and waits for a fence, until the device is lost; below zero: it is not.
  std::atomic<int> submissions_left = -1;
  std::atomic<int> waits_left = -1;
  /// Submissions to the queue that only copies, which is really the other one.
  std::atomic<int> copies = 0;
  /// Largest storage buffer that the driver admits to; 0: what it says itself.
  std::atomic<std::uint32_t> buffer_bytes = 0;
  /// Least of everything that Vulkan allows, but for buffers, and few workgroups a dispatch.
  std::atomic<bool> is_small = false;
  /// A second queue family that only copies.
  std::atomic<bool> has_transfer_queue = false;
  /// Kernels add where they should multiply.
  std::atomic<bool> miscompiles = false;
  /// The device says that it is a GPU.
  std::atomic<bool> pretends_to_be_gpu = false;

  int alive_of(Counted what) const { return alive[static_cast<int>(what)]; }
  int created_of(Counted what) const { return created[static_cast<int>(what)]; }
};

}  // namespace fathom::test

/// The layer's own; also set from FATHOM_TEST_LAYER=small,transfer when it is loaded.
extern "C" fathom::test::LayerControl* fathom_test_layer_control();
