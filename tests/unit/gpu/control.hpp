// SPDX-License-Identifier: Apache-2.0
// What the test layers (vulkan_layer.cpp, opencl_layer.cpp) do to calls, as the test that loads
// them says. A layer sits between the loader and the driver, so what is tested is the library as it
// is, on a real driver.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace fathom::test {

struct LayerControl {
  /// Objects whose creations and destructions are counted, each kind under its API's name; what
  /// holds memory is "Memory" in both. Kinds without a name are none.
  struct Kind {
    const char* name = nullptr;
    std::atomic<int> alive = 0, created = 0;
  };
  std::array<Kind, 16> kinds = {};

  /// Allocations of memory until one fails; below zero: none does.
  std::atomic<int> allocations_left = -1;
  /// Submissions, and waits for the device, until the device is lost; below zero: it is not.
  std::atomic<int> submissions_left = -1;
  std::atomic<int> waits_left = -1;
  /// What was submitted never ends.
  std::atomic<bool> hangs = false;
  /// OpenCL: other commands until one fails.
  std::atomic<int> commands_left = -1;
  /// Copies of pixels that another queue than the computing one was given.
  std::atomic<int> copies = 0;
  /// Largest buffer that the driver admits to; 0: what it says itself.
  std::atomic<std::uint32_t> buffer_bytes = 0;
  /// Least of everything that the API allows, but for buffers; Vulkan: also few workgroups a
  /// dispatch; OpenCL: single numbers, no vectors.
  std::atomic<bool> is_small = false;
  /// Most threads of a workgroup, and bytes that they share, that the driver admits to; 0: what it
  /// says itself.
  std::atomic<std::uint32_t> threads = 0, shared_bytes = 0;
  /// Vulkan: a second queue family that only copies. OpenCL: memory of the device's own.
  std::atomic<bool> has_transfer_queue = false;
  /// Kernels compute wrong.
  std::atomic<bool> miscompiles = false;
  /// OpenCL: builds of programs that fail from now on.
  std::atomic<int> failing_builds = 0;
  /// The driver takes no program back that it compiled.
  std::atomic<bool> refuses_programs = false;
  /// The device says that it is a GPU.
  std::atomic<bool> pretends_to_be_gpu = false;

  Kind* find(std::string_view name) {
    for (Kind& kind : kinds) {
      if (kind.name != nullptr && kind.name == name) return &kind;
    }
    return nullptr;
  }
  int created_of(std::string_view name) {
    const Kind* const kind = find(name);
    return kind == nullptr ? 0 : kind->created.load();
  }
  void born(int kind) {
    ++kinds[kind].alive;
    ++kinds[kind].created;
  }
  void dead(int kind) { --kinds[kind].alive; }

  /// FATHOM_TEST_LAYER=small,transfer,gpu, for programs that are not tests of their own.
  void obey_environment() {
    const char* const wished = std::getenv("FATHOM_TEST_LAYER");
    const std::string wishes = wished != nullptr ? wished : "";
    is_small = wishes.find("small") != std::string::npos;
    has_transfer_queue = wishes.find("transfer") != std::string::npos;
    pretends_to_be_gpu = wishes.find("gpu") != std::string::npos;
  }
};

/// A layer's control, which lives as long as the process: drivers end late. names: of its kinds, in
/// order.
template <std::size_t count>
LayerControl* new_control(const char* const (&names)[count]) {
  auto* const made = new LayerControl;
  static_assert(count <= std::tuple_size_v<decltype(made->kinds)>);
  for (std::size_t i = 0; i < count; ++i) made->kinds[i].name = names[i];
  made->obey_environment();
  return made;
}

/// Whether this is the call that was chosen to fail.
inline bool fails(std::atomic<int>& calls_left) { return calls_left >= 0 && calls_left-- == 0; }

}  // namespace fathom::test

/// The layer's own.
extern "C" fathom::test::LayerControl* fathom_test_layer_control();
