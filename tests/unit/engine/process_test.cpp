// SPDX-License-Identifier: Apache-2.0
#include "engine/process.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fathom {
namespace {

TEST(Process, CountsItsForks) {
  const unsigned here = forks();
  const pid_t child = ::fork();
  if (child == 0) ::_exit(static_cast<int>(forks() - here));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(forks(), here) << "the parent stays what it was";
}

TEST(Process, StartsThreadsWhereNothingForbidsIt) {
  EXPECT_EQ(startable_threads(3), 3U);
  EXPECT_EQ(startable_threads(0), 0U);
  EXPECT_TRUE(can_start_drivers());
}

}  // namespace
}  // namespace fathom
