// SPDX-License-Identifier: Apache-2.0
// A backend that is not there must be seen not to be there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "tests/conformance/suite.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::conformance {
namespace {

TEST(Presence, EveryBackendHasADevice) {
  std::string missing;
  for (const Backend* backend : all_backends()) {
    if (!backend->devices().empty()) continue;
    EXPECT_FALSE(is_required(backend->name()))
        << backend->name() << " is required and has no device on this machine";
    missing += std::string(" ") + backend->name();
  }
  if (!missing.empty()) GTEST_SKIP() << "NOTHING IS TESTED OF:" << missing << " (no device here)";
}

TEST(Presence, RequiredBackendsExist) {
  const char* const required = std::getenv("FATHOM_REQUIRE_BACKENDS");
  if (required == nullptr) GTEST_SKIP() << "FATHOM_REQUIRE_BACKENDS is not set";
  std::set<std::string> known;
  for (const Backend* backend : all_backends()) known.insert(backend->name());
  std::istringstream names(required);
  for (std::string name; std::getline(names, name, ',');) {
    EXPECT_TRUE(known.contains(name)) << "this build has no backend \"" << name << "\"";
  }
}

TEST(Presence, TheOracleComesLastAndNamesAreUnique) {
  ASSERT_FALSE(all_backends().empty());
  EXPECT_STREQ(all_backends().back()->name(), "reference");
  std::set<std::string> names;
  for (const Backend* backend : all_backends()) {
    const std::string name = backend->name();
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_NE(name, "auto");
    EXPECT_TRUE(std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    })) << name;
  }
}

TEST(Presence, ADeviceThatIsNotListedDoesNotOpen) {
  for (const Backend* backend : all_backends()) {
    SCOPED_TRACE(backend->name());
    test::expect_error(ErrorCode::unavailable,
                       [&] { backend->open(backend->devices().size(), {}); });
  }
}

}  // namespace
}  // namespace fathom::conformance
