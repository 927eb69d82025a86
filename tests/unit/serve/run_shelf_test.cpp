// SPDX-License-Identifier: Apache-2.0
#include "serve/run_shelf.hpp"

#include <gtest/gtest.h>

#include "engine/file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::serve {
namespace {

TEST(RunShelf, NoNameLeadsOutOfItsFolder) {
  const test::TemporaryFolder home;
  write_file(home / "secret.json", "{}");
  write_file(home.path() / "runs" / "a.json", "{}");
  std::filesystem::create_symlink(home / "secret.json", home.path() / "runs" / "link.json");
  const RunShelf shelf(home.path() / "runs");
  EXPECT_EQ(shelf.file("a"), "{}");
  for (const char* name :
       {"../secret", "..", ".", "", "/etc/passwd", "link", "b", "a.json", ".a", "a/../a"})
    EXPECT_FALSE(shelf.file(name)) << name;
}

TEST(RunShelf, ListsTheNewestFirstAndSaysWhatItCannotRead) {
  const test::TemporaryFolder home;
  RunShelf shelf(home.path());
  EXPECT_EQ(shelf.list(), "[]");
  write_file(home / "2026-01-01T00-00-00-focus-aaaa.json", "no JSON");
  write_file(home / "2026-01-02T00-00-00-focus-bbbb.json", "{}");
  write_file(home / "notes.txt", "");
  const std::string list = shelf.list();
  EXPECT_LT(list.find("bbbb"), list.find("aaaa"));
  EXPECT_NE(list.find("\"error\""), std::string::npos);
  EXPECT_EQ(list.find("notes"), std::string::npos);
  EXPECT_EQ(shelf.list(), list);
  test::expect_error(ErrorCode::bad_data, [&] { shelf.rerun("2026-01-01T00-00-00-focus-aaaa"); });
}

}  // namespace
}  // namespace fathom::serve
