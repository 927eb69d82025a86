// SPDX-License-Identifier: Apache-2.0
// main() of a test program that needs a device.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace fathom::test {

/// Runs the tests, or says loudly that there is no device and answers 77 (1 where one must be).
inline int run_on_device(int argc, char** argv, const char* variable, const char* what) {
  testing::InitGoogleTest(&argc, argv);
  const char* const device = std::getenv(variable);
  if (device != nullptr && *device != '\0') return RUN_ALL_TESTS();
  const char* const required = std::getenv("FATHOM_REQUIRE_HARDWARE");
  std::printf("== NOT RUN: no %s (%s is not set); tools/check --hardware brings one\n", what,
              variable);
  return required != nullptr && std::strcmp(required, "1") == 0 ? 1 : 77;
}

}  // namespace fathom::test
