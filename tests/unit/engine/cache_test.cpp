// SPDX-License-Identifier: Apache-2.0
#include "engine/cache.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "engine/file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;

class Cache : public ::testing::Test {
 protected:
  void SetUp() override { setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  fs::path file() const { return folder_ / "fathom" / "kernels"; }

  test::TemporaryFolder folder_;
  const std::string bytes_ = std::string("compiled\0\n kernels", 18);
};

TEST_F(Cache, GivesBackWhatWasKept) {
  EXPECT_FALSE(read_cached("kernels", "driver 1"));
  EXPECT_TRUE(write_cached("kernels", "driver 1", bytes_));
  EXPECT_EQ(read_cached("kernels", "driver 1"), bytes_);
  EXPECT_TRUE(write_cached("kernels", "driver 1", ""));
  EXPECT_EQ(read_cached("kernels", "driver 1"), "");
}

TEST_F(Cache, GoesWhereTheUserSays) {
  const fs::path own = folder_ / "own";
  setenv("FATHOM_CACHE", own.c_str(), 1);
  EXPECT_TRUE(write_cached("kernels", "key", bytes_));
  EXPECT_TRUE(fs::exists(own / "kernels"));
  setenv("FATHOM_CACHE", "none", 1);
  EXPECT_FALSE(write_cached("kernels", "key", bytes_));
  EXPECT_FALSE(read_cached("kernels", "key"));
  unsetenv("FATHOM_CACHE");
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(Cache, IsForOneKey) {
  write_cached("kernels", "driver 1", bytes_);
  EXPECT_FALSE(read_cached("kernels", "driver 2"));
  EXPECT_FALSE(read_cached("others", "driver 1"));
}

TEST_F(Cache, TruncatedAtAnyByteIsAsGoodAsNone) {
  write_cached("kernels", "key", bytes_);
  const std::string whole = read_file(file());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_file(file(), whole.substr(0, size));
    EXPECT_FALSE(read_cached("kernels", "key")) << size << " of " << whole.size() << " bytes";
  }
  write_file(file(), whole + "x");
  EXPECT_FALSE(read_cached("kernels", "key")) << "a byte too many";
}

TEST_F(Cache, WithAnyByteChangedIsAsGoodAsNone) {
  write_cached("kernels", "key", bytes_);
  const std::string whole = read_file(file());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] ^= 0x20;
    write_file(file(), damaged);
    EXPECT_FALSE(read_cached("kernels", "key")) << "byte " << i;
  }
}

TEST_F(Cache, WithoutAFolderKeepsNothing) {
  // Whoever is root may write everywhere, but nobody makes a folder in a file.
  const auto in_a_file = folder_ / "file";
  write_file(in_a_file, "x");
  setenv("XDG_CACHE_HOME", in_a_file.c_str(), 1);
  EXPECT_FALSE(write_cached("kernels", "key", bytes_));
  EXPECT_FALSE(read_cached("kernels", "key"));
  if (::geteuid() != 0) {
    setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
    fs::create_directory(folder_ / "fathom");
    fs::permissions(folder_ / "fathom", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_FALSE(write_cached("kernels", "key", bytes_));
  }
}

TEST_F(Cache, IsWhereTheXdgVariablesSay) {
  EXPECT_EQ(cache_folder(), folder_ / "fathom");
  const char* const home = std::getenv("HOME");
  const std::string old_home = home != nullptr ? home : "";
  setenv("XDG_CACHE_HOME", "relative/is/ignored", 1);
  setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(cache_folder(), "/home/somebody/.cache/fathom");
  unsetenv("HOME");
  EXPECT_EQ(cache_folder(), "");
  EXPECT_FALSE(write_cached("kernels", "key", bytes_));
  setenv("HOME", old_home.c_str(), 1);
}

TEST_F(Cache, TwoWritersLeaveOneWholeFile) {
  const std::string other(100'000, 'x');
  const auto write = [&](const std::string& what) {
    for (int i = 0; i < 20; ++i) write_cached("kernels", "key", what);
  };
  write_cached("kernels", "key", bytes_);
  std::thread first(write, bytes_), second(write, other);
  for (int i = 0; i < 200; ++i) {
    const auto found = read_cached("kernels", "key");
    ASSERT_TRUE(found && (*found == bytes_ || *found == other));
  }
  first.join();
  second.join();
}

}  // namespace
}  // namespace fathom
