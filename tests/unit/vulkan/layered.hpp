// SPDX-License-Identifier: Apache-2.0
// A Vulkan device under the test layer.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/backend.hpp"
#include "tests/unit/vulkan/layer.hpp"

namespace fathom::test {

/// Every test starts with a layer that does nothing and has counted nothing, and ends with every
/// object destroyed that was created.
class Layered : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  LayerControl& layer() { return *layer_; }

  /// The first Vulkan device as the layer now makes it look.
  static std::unique_ptr<Device> open();
  static const Backend& vulkan();

  /// "2 Buffer, 1 Memory", of what is alive; empty if nothing is.
  std::string alive() const;

 private:
  LayerControl* layer_ = nullptr;
};

}  // namespace fathom::test
