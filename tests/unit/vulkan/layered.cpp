// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/vulkan/layered.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>

#include "backends/backends.hpp"

namespace fathom::test {
namespace {

// Before the first look at Vulkan.
const bool layer_is_asked_for = [] {
  setenv("VK_ADD_LAYER_PATH", FATHOM_TEST_LAYER_FOLDER, 1);
  const char* const others = std::getenv("VK_INSTANCE_LAYERS");
  const std::string layers =
      (others != nullptr ? std::string(others) + ":" : "") + "VK_LAYER_FATHOM_test";
  setenv("VK_INSTANCE_LAYERS", layers.c_str(), 1);
  return true;
}();

LayerControl* find_layer() {
  void* const library = dlopen(FATHOM_TEST_LAYER_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return nullptr;
  const auto find = reinterpret_cast<decltype(&fathom_test_layer_control)>(
      dlsym(library, "fathom_test_layer_control"));
  return find == nullptr ? nullptr : find();
}

constexpr const char* kNames[] = {
#define FATHOM_LAYER_NAME(name) #name,
    FATHOM_LAYER_COUNTED(FATHOM_LAYER_NAME)
#undef FATHOM_LAYER_NAME
        "Pipeline",
    "Memory", "Device", "Instance"};

void reset(LayerControl& layer) {
  layer.allocations_left = layer.submissions_left = layer.waits_left = -1;
  layer.copies = 0;
  layer.buffer_bytes = 0;
  layer.is_small = layer.has_transfer_queue = layer.pretends_to_be_gpu = false;
  layer.miscompiles = false;
  for (auto& count : layer.created) count = 0;
}

}  // namespace

const Backend& Layered::vulkan() {
  for (const Backend* backend : all_backends()) {
    if (backend->name() == std::string("vulkan")) return *backend;
  }
  throw std::runtime_error("this build has no backend vulkan");
}

void Layered::SetUp() {
  ASSERT_TRUE(layer_is_asked_for);
  layer_ = find_layer();
  ASSERT_NE(layer_, nullptr) << dlerror();
  reset(*layer_);
  const bool is_required =
      std::string(std::getenv("FATHOM_REQUIRE_BACKENDS") ? std::getenv("FATHOM_REQUIRE_BACKENDS")
                                                         : "")
          .find("vulkan") != std::string::npos;
  if (vulkan().devices().empty()) {
    ASSERT_FALSE(is_required) << "vulkan is required and has no device";
    GTEST_SKIP() << "NOTHING IS TESTED HERE: no Vulkan device";
  }
  open();  // takes the connection that devices() has left
  ASSERT_GT(layer().created_of(Counted::Instance), 0) << "the loader did not load the layer";
  ASSERT_EQ(alive(), "");
  reset(*layer_);
}

void Layered::TearDown() {
  if (layer_ == nullptr || IsSkipped()) return;
  EXPECT_EQ(alive(), "") << "created and not destroyed";
  reset(*layer_);
}

std::unique_ptr<Device> Layered::open() { return vulkan().open(0, {}); }

std::string Layered::alive() const {
  std::string text;
  for (int i = 0; i < static_cast<int>(Counted::kCount); ++i) {
    const int count = layer_->alive[i];
    if (count != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, kNames[i]);
  }
  return text;
}

}  // namespace fathom::test
