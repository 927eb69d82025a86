// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/gpu/layered.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>

#include "backends/backends.hpp"

namespace fathom::test {
namespace {

void append(const char* variable, const std::string& value) {
  const char* const others = std::getenv(variable);
  setenv(variable, ((others != nullptr ? std::string(others) + ":" : "") + value).c_str(), 1);
}

// Before the first look at Vulkan or OpenCL.
const bool layers_are_asked_for = [] {
  setenv("VK_ADD_LAYER_PATH", FATHOM_TEST_LAYER_FOLDER, 1);
  append("VK_INSTANCE_LAYERS", "VK_LAYER_FATHOM_test");
  append("OPENCL_LAYERS", FATHOM_TEST_LAYER_FOLDER "/libfathom_opencl_test_layer.so");
  return true;
}();

LayerControl* find_layer(const std::string& backend) {
  const auto file = fmt::format("{}/libfathom_{}_test_layer.so", FATHOM_TEST_LAYER_FOLDER, backend);
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return nullptr;
  const auto find = reinterpret_cast<decltype(&fathom_test_layer_control)>(
      dlsym(library, "fathom_test_layer_control"));
  return find == nullptr ? nullptr : find();
}

void reset(LayerControl& layer) {
  layer.allocations_left = layer.submissions_left = layer.waits_left = -1;
  layer.commands_left = -1;
  layer.copies = 0;
  layer.buffer_bytes = layer.threads = layer.shared_bytes = 0;
  layer.is_small = layer.has_transfer_queue = layer.pretends_to_be_gpu = false;
  layer.failing_builds = 0;
  layer.miscompiles = layer.refuses_programs = layer.hangs = false;
  for (auto& kind : layer.kinds) kind.created = 0;
}

bool is_required(const std::string& backend) {
  const char* const required = std::getenv("FATHOM_REQUIRE_BACKENDS");
  return required != nullptr && std::string(required).find(backend) != std::string::npos;
}

}  // namespace

std::vector<std::string> backends_with_layers() {
  std::vector<std::string> names;
  for (const Backend* backend : all_backends()) {
    if (backend->is_for_gpus()) names.emplace_back(backend->name());
  }
  return names;
}

const Backend& Layered::backend() const {
  for (const Backend* backend : all_backends()) {
    if (backend->name() == name()) return *backend;
  }
  throw std::runtime_error("this build has no backend " + name());
}

void Layered::SetUp() {
  ASSERT_TRUE(layers_are_asked_for);
  layer_ = find_layer(name());
  ASSERT_NE(layer_, nullptr) << dlerror();
  reset(*layer_);
  if (backend().devices().empty()) {
    ASSERT_FALSE(is_required(name())) << name() << " is required and has no device";
    GTEST_SKIP() << "NOTHING IS TESTED HERE: no device for " << name();
  }
  open();  // of Vulkan: takes the connection that devices() has left
  int created = 0;
  for (const auto& kind : layer().kinds) created += kind.created;
  ASSERT_GT(created, 0) << "the loader did not load the layer";
  ASSERT_EQ(alive(), "");
  reset(*layer_);
}

void Layered::TearDown() {
  if (layer_ == nullptr || IsSkipped()) return;
  EXPECT_EQ(alive(), "") << "created and not destroyed";
  reset(*layer_);
}

std::unique_ptr<Device> Layered::open() const { return backend().open(0, {}); }

std::string Layered::alive() const {
  std::string text;
  for (const auto& kind : layer_->kinds) {
    if (kind.alive == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kind.alive.load(), kind.name);
  }
  return text;
}

}  // namespace fathom::test
