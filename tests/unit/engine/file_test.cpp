// SPDX-License-Identifier: Apache-2.0
// Files that are written whole or not at all.
#include "engine/file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <vector>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

class File : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "fathom_file_test.XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_))
      all.push_back(entry.path().filename());
    return all;
  }

  fs::path folder_;
};

/// As much as a file may grow, and a write beyond it fails as on a full disk, until the end of the
/// scope.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(File, ReadsBackWhatWasWritten) {
  const std::string bytes("a\0b\r\n\xff", 6);
  write_file(folder_ / "x", bytes);
  EXPECT_EQ(read_file(folder_ / "x"), bytes);
  write_file(folder_ / "x", "shorter");
  EXPECT_EQ(read_file(folder_ / "x"), "shorter");
  write_file(folder_ / "empty", "");
  EXPECT_EQ(read_file(folder_ / "empty"), "");
  EXPECT_EQ(names().size(), 2U) << "no temporary file stays";
}

TEST_F(File, MakesMissingFolders) {
  write_file(folder_ / "a/b/c.json", "{}");
  EXPECT_EQ(read_file(folder_ / "a/b/c.json"), "{}");
}

TEST_F(File, AFullDiskLeavesTheOldFileWhole) {
  write_file(folder_ / "record", "the old record");
  {
    const FullDisk full(1000);
    expect_error(ErrorCode::io, [&] { write_file(folder_ / "record", std::string(5000, 'x')); },
                 {"record"});
    expect_error(ErrorCode::io, [&] { write_file(folder_ / "fresh", std::string(5000, 'x')); });
  }
  EXPECT_EQ(read_file(folder_ / "record"), "the old record");
  EXPECT_EQ(names(), std::vector<std::string>{"record"}) << "half a file stayed";
}

TEST_F(File, ADeviceIsWrittenStraight) {
  EXPECT_NO_THROW(write_file("/dev/null", "gone"));
  if (fs::exists("/dev/full")) {
    expect_error(ErrorCode::io, [] { write_file("/dev/full", "never"); }, {"/dev/full", "space"});
  }
}

TEST_F(File, RefusesWhatCannotBeWritten) {
  expect_error(ErrorCode::io, [&] { write_file(folder_, "x"); }, {"directory"});
  expect_error(ErrorCode::io, [&] { write_file("", "x"); });
  write_file(folder_ / "file", "x");
  expect_error(ErrorCode::io, [&] { write_file(folder_ / "file" / "below", "x"); });
  EXPECT_EQ(read_file(folder_ / "file"), "x");
}

TEST_F(File, AFolderThatMayNotBeWrittenKeepsItsFile) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  write_file(folder_ / "file", "old");
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  expect_error(ErrorCode::io, [&] { write_file(folder_ / "file", "new"); }, {"ermission"});
  EXPECT_EQ(read_file(folder_ / "file"), "old");
}

TEST_F(File, FollowsASymbolicLink) {
  write_file(folder_ / "real", "old");
  fs::create_symlink("real", folder_ / "link");
  write_file(folder_ / "link", "new");
  EXPECT_EQ(read_file(folder_ / "real"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  fs::create_symlink("nowhere", folder_ / "dangling");
  expect_error(ErrorCode::io, [&] { write_file(folder_ / "dangling", "x"); });
}

TEST_F(File, GivesOrdinaryPermissionsAndKeepsOldOnes) {
  const auto mode = [&](const char* name) {
    struct stat status {};
    ::stat((folder_ / name).c_str(), &status);
    return status.st_mode & 07777;
  };
  const mode_t old = ::umask(027);
  write_file(folder_ / "fresh", "x");
  EXPECT_EQ(mode("fresh"), 0640U);
  ::umask(old);
  write_file(folder_ / "private", "x");
  ::chmod((folder_ / "private").c_str(), 0600);
  write_file(folder_ / "private", "y");
  EXPECT_EQ(mode("private"), 0600U);
}

TEST_F(File, ReadRefusesWhatIsNotAFileOrTooLarge) {
  expect_error(ErrorCode::io, [&] { read_file(folder_ / "absent"); }, {"absent", "No such file"});
  expect_error(ErrorCode::io, [&] { read_file(folder_); }, {"directory"});
  write_file(folder_ / "large", std::string(1001, 'x'));
  EXPECT_EQ(read_file(folder_ / "large", 1001).size(), 1001U);
  expect_error(ErrorCode::bad_data, [&] { read_file(folder_ / "large", 1000); }, {"1000"});
  expect_error(ErrorCode::bad_data, [] { read_file("/dev/zero", 1 << 20); });
}

TEST_F(File, APipeIsReadOnlyWhereItWasGivenOpen) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_error(ErrorCode::bad_data, [&] { read_file(pipe); }, {"pipe is a pipe and no file"});
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "hello", 5), 5);
  ::close(ends[1]);
  EXPECT_EQ(read_file("/dev/fd/" + std::to_string(ends[0])), "hello");
  ::close(ends[0]);
}

TEST_F(File, NewFilesNeverMeet) {
  const fs::path head = folder_ / "new" / "run";
  const fs::path one = write_new_file(head, ".json", "one"),
                 two = write_new_file(head, ".json", "two");
  EXPECT_NE(one, two);
  EXPECT_EQ(read_file(one), "one");
  EXPECT_EQ(read_file(two), "two");
  EXPECT_TRUE(one.filename().string().starts_with("run-")) << one;
  EXPECT_EQ(one.extension(), ".json");
}

}  // namespace
}  // namespace fathom
