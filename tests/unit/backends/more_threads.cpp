// SPDX-License-Identifier: Apache-2.0
// Lets oneTBB have more threads than processors while these tests run: seven threads that take
// turns on two processors find more than two threads do.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <optional>

namespace {

class MoreThreads : public ::testing::Environment {
 public:
  void SetUp() override { limit_.emplace(oneapi::tbb::global_control::max_allowed_parallelism, 8); }
  void TearDown() override { limit_.reset(); }

 private:
  std::optional<oneapi::tbb::global_control> limit_;
};

const ::testing::Environment* const registered =
    ::testing::AddGlobalTestEnvironment(new MoreThreads);

}  // namespace
