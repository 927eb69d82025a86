// SPDX-License-Identifier: Apache-2.0
// A device of a backend under that backend's test layer.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>

#include "engine/backend.hpp"
#include "tests/unit/gpu/control.hpp"

namespace fathom::test {

/// Every test starts with a layer that does nothing and has counted nothing, and ends with every
/// object destroyed that was created.
class Layered : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// "vulkan" or "opencl".
  virtual std::string name() const = 0;

  LayerControl& layer() { return *layer_; }

  /// The backend's first device as the layer now makes it look.
  std::unique_ptr<Device> open() const;
  const Backend& backend() const;

  /// "2 Buffer, 1 Memory", of what is alive; empty if nothing is.
  std::string alive() const;

 private:
  LayerControl* layer_ = nullptr;
};

/// The same of every backend that this build has and that there is a layer for.
class OnEveryGpuBackend : public Layered, public ::testing::WithParamInterface<std::string> {
 protected:
  std::string name() const override { return GetParam(); }
};

std::vector<std::string> backends_with_layers();

#define FATHOM_ON_EVERY_GPU_BACKEND(suite)                                                         \
  INSTANTIATE_TEST_SUITE_P(On, suite, ::testing::ValuesIn(::fathom::test::backends_with_layers()), \
                           [](const auto& on) { return on.param; })

}  // namespace fathom::test
