// SPDX-License-Identifier: Apache-2.0
// Files: what they are called in errors, and writing.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "make_pictures.hpp"
#include "pictures/picture.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;

template <class Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return Error(ErrorCode::io, "");
}

class Files : public testing::Test {
 protected:
  fs::path at(const char* name) const { return folder_ / name; }
  TemporaryFolder folder_;
};

TEST_F(Files, MissingEmptyAndForeignFilesAreNamed) {
  const Error missing = error_of([&] { read_picture(at("none.png")); });
  EXPECT_EQ(missing.code(), ErrorCode::io);
  EXPECT_EQ(missing.what(),
            "cannot read " + at("none.png").string() + ": No such file or directory");

  write_file(at("empty.png"), "");
  const Error empty = error_of([&] { read_picture(at("empty.png")); });
  EXPECT_EQ(empty.code(), ErrorCode::bad_data);
  EXPECT_EQ(empty.what(), "cannot read " + at("empty.png").string() + ": it is empty");

  write_file(at("notes.png"), "a shopping list");
  const Error foreign = error_of([&] { count_pages(at("notes.png")); });
  EXPECT_EQ(foreign.code(), ErrorCode::bad_data);
  EXPECT_EQ(foreign.what(), at("notes.png").string() + " is no PNG, JPEG, TIFF or PGM picture");

  EXPECT_EQ(error_of([&] { read_picture(folder_.path()); }).code(), ErrorCode::io);
}

TEST_F(Files, APageBeyondTheOnlyOneIsRefused) {
  write_picture(at("one.png"), noise_frame(8, 8, Depth::bits8, 1));
  const Error error = error_of([&] { read_picture(at("one.png"), 3); });
  EXPECT_EQ(error.code(), ErrorCode::out_of_bounds);
  EXPECT_EQ(error.what(), at("one.png").string() + " page 3: the file has one page, 0");
}

TEST_F(Files, WhatIsWrittenIsReadBack) {
  for (const char* name : {"a.png", "a.tif", "a.TIFF", "a.pgm"}) {
    for (const Depth depth : {Depth::bits8, Depth::bits16}) {
      const Frame frame = noise_frame(33, 21, depth, 2);
      write_picture(at(name), frame);
      PictureFile file(at(name));
      EXPECT_EQ(file.page_count(), 1u);
      EXPECT_EQ(file.shape(), (PictureShape{33, 21, depth})) << name;
      EXPECT_EQ(values_of(file.read()), values_of(frame)) << name;
    }
  }
}

TEST_F(Files, FramesWithGapsBetweenRowsAreWrittenWithoutThem) {
  std::vector<std::uint8_t> buffer(3 * 11 + 1);
  for (std::size_t i = 0; i < buffer.size(); ++i) buffer[i] = static_cast<std::uint8_t>(i);
  // Rows of five 16-bit pixels, 11 bytes apart and so not aligned.
  const Frame frame = Frame::view(buffer.data() + 1, 5, 3, Depth::bits16, 11);
  for (const char* name : {"v.png", "v.tif", "v.pgm"}) {
    write_picture(at(name), frame);
    EXPECT_EQ(values_of(read_picture(at(name))), values_of(frame)) << name;
  }
}

TEST_F(Files, UnknownEndingsAndEmptyFramesAreNotWritten) {
  const Frame frame = noise_frame(8, 8, Depth::bits8, 3);
  EXPECT_EQ(error_of([&] { write_picture(at("a.jpg"), frame); }).code(), ErrorCode::bad_argument);
  EXPECT_EQ(error_of([&] { write_picture(at("a"), frame); }).code(), ErrorCode::bad_argument);
  EXPECT_EQ(error_of([&] { write_picture(at("a.png"), Frame()); }).code(), ErrorCode::bad_argument);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(Files, ADiskThatRefusesIsAnInputOutputError) {
  const Error error =
      error_of([&] { write_picture("/proc/none/a.png", noise_frame(8, 8, Depth::bits8, 4)); });
  EXPECT_EQ(error.code(), ErrorCode::io);
}

TEST_F(Files, AFileCutShortWhileOpenIsAnError) {
  write_picture(at("cut.pgm"), noise_frame(64, 64, Depth::bits8, 5));
  PictureFile file(at("cut.pgm"));
  fs::resize_file(at("cut.pgm"), 1000);
  EXPECT_EQ(error_of([&] { file.read(); }).code(), ErrorCode::bad_data);
}

TEST_F(Files, APipeThatWasGivenOpenIsReadToo) {
  const Frame frame = noise_frame(40, 30, Depth::bits16, 6);
  write_picture(at("a.png"), frame);
  const std::string bytes = read_file(at("a.png"));
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  ::close(ends[1]);
  EXPECT_EQ(values_of(read_picture("/dev/fd/" + std::to_string(ends[0]))), values_of(frame));
  ::close(ends[0]);
}

TEST_F(Files, ADeviceIsNotRead) {
  expect_error(ErrorCode::bad_data, [] { PictureFile("/dev/zero"); }, {"/dev/zero is a device"});
}

TEST_F(Files, TheLimitOfPixelsIsSaidAndCanBeMoved) {
  const std::string header = "P5 20000 20000 255 ";  // 382 times 2^20 px, and no pixels
  expect_error(ErrorCode::bad_data, [&] { PictureFile(header, "big.pgm"); },
               {"20000 x 20000", "256 megapixels", "FATHOM_MEGAPIXELS to 382"});
  ASSERT_EQ(setenv("FATHOM_MEGAPIXELS", "400", 1), 0);
  EXPECT_EQ(PictureFile(header, "big.pgm").shape().width_px, 20000);
  ASSERT_EQ(setenv("FATHOM_MEGAPIXELS", "many", 1), 0);
  expect_error(ErrorCode::bad_argument, [&] { PictureFile(header, "big.pgm"); }, {"many"});
  ASSERT_EQ(unsetenv("FATHOM_MEGAPIXELS"), 0);
}

TEST_F(Files, AMovedFileIsStillOpen) {
  const Frame frame = noise_frame(8, 8, Depth::bits8, 7);
  write_picture(at("a.tif"), frame);
  PictureFile first(at("a.tif"));
  PictureFile second(std::move(first));
  first = std::move(second);
  EXPECT_EQ(values_of(first.read()), values_of(frame));
}

}  // namespace
}  // namespace fathom::test
