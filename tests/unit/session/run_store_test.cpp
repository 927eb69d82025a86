// SPDX-License-Identifier: Apache-2.0
#include "session/run_store.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "engine/file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

fs::path written(const fs::path& path, fs::file_time_type when) {
  write_file(path, "{}");
  fs::last_write_time(path, when);
  return path;
}

TEST(RunStore, KnowsTheNewerRunAlsoOfOneSecond) {
  const test::TemporaryFolder folder;
  const auto then = fs::file_time_type::clock::now() - 1h;
  const fs::path first = written(folder / "2026-01-02T03-04-05-focus-bbbb.json", then);
  const fs::path second = written(folder / "2026-01-02T03-04-05-focus-aaaa.json", then + 10ms);
  const fs::path later = written(folder / "2026-01-02T03-04-06-focus-0000.json", then - 1s);
  EXPECT_TRUE(is_newer_run(second, first));
  EXPECT_FALSE(is_newer_run(first, second));
  EXPECT_TRUE(is_newer_run(later, second)) << "the name counts first";
  EXPECT_FALSE(is_newer_run(first, first));
}

}  // namespace
}  // namespace fathom
