// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "engine/error.hpp"
#include "make_pictures.hpp"
#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

using Values = std::vector<std::uint32_t>;
using namespace std::string_literals;

Frame read(const std::string& bytes) { return PictureFile(bytes, "made.pgm").read(); }

std::string error_of(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_data);
    return error.what();
  }
  ADD_FAILURE() << "was read: " << bytes;
  return "";
}

TEST(Pnm, AsciiGreyWithComments) {
  const Frame frame =
      read("P2 # grey\n# two by two\n2 2#width and height\n255\n1 2\n# more\n3 255");
  EXPECT_EQ(frame.depth(), Depth::bits8);
  EXPECT_EQ(values_of(frame), (Values{1, 2, 3, 255}));
}

TEST(Pnm, AsciiColour) {
  EXPECT_EQ(values_of(read("P3\n2 1\n255\n255 0 0  10 200 30\n")),
            (Values{expected_luma(255, 0, 0), expected_luma(10, 200, 30)}));
}

TEST(Pnm, BinaryGreyEightBit) {
  EXPECT_EQ(values_of(read("P5\n3 1\n255\n\x00\x7f\xff"s)), (Values{0, 127, 255}));
  // The one white-space byte after the largest value may be any; what follows it is a pixel.
  EXPECT_EQ(values_of(read("P5 3 1 255 \n\t "s)), (Values{'\n', '\t', ' '}));
}

TEST(Pnm, BinarySixteenBitIsBigEndian) {
  const Frame frame = read("P5 2 1 65535\n\x01\x02\xff\xfe"s);
  EXPECT_EQ(frame.depth(), Depth::bits16);
  EXPECT_EQ(values_of(frame), (Values{0x0102, 0xfffe}));
  EXPECT_EQ(values_of(read("P6 1 1 65535\n\x01\x00\x02\x00\x03\x00"s)),
            (Values{expected_luma(256, 512, 768)}));
}

TEST(Pnm, TwelveBitValuesAreNotRescaled) {
  const Frame frame = read("P2 3 1 4095  0 1000 4095");
  EXPECT_EQ(frame.depth(), Depth::bits16);
  EXPECT_EQ(values_of(frame), (Values{0, 1000, 4095}));
}

TEST(Pnm, DamageIsNamed) {
  EXPECT_NE(error_of("P2 2 2 255 1 2 300 4").find("value 300 is above"), std::string::npos);
  EXPECT_NE(error_of("P2 2 2 255 1 2 x 4").find("no number for a pixel"), std::string::npos);
  EXPECT_NE(error_of("P2 2 2 255 1 2 3x 4").find("stray character"), std::string::npos);
  EXPECT_NE(error_of("P2 2 2 0 1 2 3 4").find("largest value 0"), std::string::npos);
  EXPECT_NE(error_of("P2 2 2 65536 1 2 3 4").find("largest value 65536"), std::string::npos);
  EXPECT_NE(error_of("P5 0 2 255 ").find("0 x 2 px"), std::string::npos);
  EXPECT_NE(error_of("P5 70000 2 255 ").find("claims 70000 x 2 px"), std::string::npos);
  EXPECT_NE(error_of("P5 65536 65536 255 ").find("claims 65536 x 65536"), std::string::npos);
  EXPECT_NE(error_of("P5 10000 20000 255 abc").find("cannot hold"), std::string::npos);
  EXPECT_NE(error_of("P2 10000 20000 255 1 2").find("cannot hold"), std::string::npos);
  EXPECT_NE(error_of("P5 99999999999999999999 1 255 ").find("absurd"), std::string::npos);
  EXPECT_NE(error_of("P5 4 4 255 0123456789abcde").find("ends too early"), std::string::npos);
  EXPECT_NE(error_of("P2 4 1 255                  1 2 3").find("no number"), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
