// SPDX-License-Identifier: Apache-2.0
// What needs no camera: how pixels are unpacked, and what a camera's clock says on ours.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "hal/drivers/aravis/camera_clock.hpp"
#include "hal/drivers/aravis/pixels.hpp"

namespace fathom::aravis {
namespace {

/// Bits, lowest first, as the standard's figures have them; written bit by bit.
class Bits {
 public:
  void add(unsigned value, int bits) {
    for (int i = 0; i < bits; ++i) set(next_++, value >> i & 1);
  }
  /// At a place counted from the first byte's lowest bit.
  void set(std::size_t place, unsigned bit) {
    if (bytes.size() <= place / 8) bytes.resize(place / 8 + 1);
    bytes[place / 8] = static_cast<std::uint8_t>(bytes[place / 8] | bit << place % 8);
  }
  std::vector<std::uint8_t> bytes;

 private:
  std::size_t next_ = 0;
};

/// One row of pixels, as the standard lays them.
std::vector<std::uint8_t> packed(const PixelFormat& format, const std::vector<unsigned>& values) {
  Bits bits;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const unsigned value = values[i];
    if (format.packing != Packing::pairs) {
      bits.add(value, format.packing == Packing::stream ? format.bits : format.bits > 8 ? 16 : 8);
      continue;
    }
    // Two pixels in 24 bits: their upper 8 bits outside, their lower ones in the middle byte.
    const std::size_t first = i / 2 * 24, low_bits = static_cast<std::size_t>(format.bits) - 8;
    for (std::size_t k = 0; k < 8; ++k)
      bits.set(first + (i % 2 == 0 ? 0 : 16) + k, value >> (low_bits + k) & 1);
    for (std::size_t k = 0; k < low_bits; ++k)
      bits.set(first + 8 + (i % 2 == 0 ? 0 : 4) + k, value >> k & 1);
  }
  return bits.bytes;
}

std::vector<unsigned> random_values(std::size_t count, int bits, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<unsigned> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<unsigned>(random() & ((1u << bits) - 1)));
  return values;
}

TEST(AravisPixels, EveryGreyFormatIsUnpackedAsTheStandardPacksIt) {
  int formats = 0;
  for (const PixelFormat& format : pixel_formats()) {
    if (format.is_mosaic()) continue;
    ++formats;
    for (const auto& [width, height] : {std::pair{6, 4}, {5, 3}, {1, 1}, {16, 2}}) {
      const auto count = static_cast<std::size_t>(width) * height;
      const auto values = random_values(count, format.bits, 7 + static_cast<unsigned>(count));
      const auto frame =
          to_grey(format, {width, height, 0}, MosaicUse::luma, packed(format, values));
      ASSERT_TRUE(frame) << format.name << width;
      EXPECT_EQ(frame->depth(), format.bits > 8 ? Depth::bits16 : Depth::bits8);
      for (std::size_t i = 0; i < count; ++i) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        EXPECT_EQ(frame->at(x, y), values[i]) << format.name << " " << i;
      }
    }
  }
  EXPECT_EQ(formats, 9);
}

TEST(AravisPixels, PaddedRowsBeginWithAByteOfTheirOwn) {
  for (const PixelFormat& format : pixel_formats()) {
    if (format.is_mosaic()) continue;
    std::vector<std::uint8_t> bytes;
    std::vector<std::vector<unsigned>> rows;
    for (unsigned y = 0; y < 3; ++y) {
      rows.push_back(random_values(5, format.bits, y));
      const auto row = packed(format, rows.back());
      bytes.insert(bytes.end(), row.begin(), row.end());
      bytes.insert(bytes.end(), 3, 0xff);
    }
    const auto frame = to_grey(format, {5, 3, 3}, MosaicUse::luma, bytes);
    ASSERT_TRUE(frame) << format.name;
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 5; ++x) EXPECT_EQ(frame->at(x, y), rows[y][x]) << format.name;
  }
}

TEST(AravisPixels, MissingBytesAreNoPicture) {
  for (const PixelFormat& format : pixel_formats()) {
    const auto values = random_values(24, format.bits, 3);
    auto bytes = packed(format, values);
    EXPECT_TRUE(to_grey(format, {6, 4, 0}, MosaicUse::luma, bytes)) << format.name;
    bytes.pop_back();
    EXPECT_FALSE(to_grey(format, {6, 4, 0}, MosaicUse::luma, bytes)) << format.name;
    EXPECT_FALSE(to_grey(format, {0, 4, 0}, MosaicUse::luma, bytes)) << format.name;
  }
}

/// Which colour the mosaic's name puts at a pixel.
char colour_at(const PixelFormat& format, int x, int y) {
  const std::string name(format.name);
  const std::string first = name.substr(5, 2);
  const std::string second = first == "GR"   ? "BG"
                             : first == "RG" ? "GB"
                             : first == "GB" ? "RG"
                                             : "GR";
  return (y % 2 == 0 ? first : second)[static_cast<std::size_t>(x % 2)];
}

TEST(AravisPixels, AMosaicOfOneColourIsThatColoursLumaEverywhere) {
  int formats = 0;
  for (const PixelFormat& format : pixel_formats()) {
    if (!format.is_mosaic()) continue;
    ++formats;
    const unsigned red = 200, green = 100, blue = 40;
    std::vector<unsigned> values;
    for (int i = 0; i < 6 * 4; ++i) {
      const char colour = colour_at(format, i % 6, i / 6);
      values.push_back(colour == 'R' ? red : colour == 'G' ? green : blue);
    }
    const auto bytes = packed(format, values);
    const auto luma = to_grey(format, {6, 4, 0}, MosaicUse::luma, bytes);
    ASSERT_TRUE(luma) << format.name;
    const auto expected =
        static_cast<unsigned>(std::lround(.299 * red + .587 * green + .114 * blue));
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 6; ++x) EXPECT_EQ(luma->at(x, y), expected) << format.name << x << y;
    const std::pair<MosaicUse, unsigned> uses[] = {
        {MosaicUse::red, red}, {MosaicUse::green, green}, {MosaicUse::blue, blue}};
    for (const auto& [use, grey] : uses) {
      const auto half = to_grey(format, {6, 4, 0}, use, bytes);
      ASSERT_TRUE(half && half->width_px() == 3 && half->height_px() == 2) << format.name;
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) EXPECT_EQ(half->at(x, y), grey) << format.name;
    }
  }
  EXPECT_EQ(formats, 32);
}

TEST(AravisPixels, AColourThatAPixelHasNotIsTheMeanOfItsNeighbours) {
  const PixelFormat& format = *find_pixel_format(0x01080009);  // BayerRG8
  std::vector<std::uint8_t> bytes(6 * 6, 0);
  bytes[2 * 6 + 2] = 200;  // a red pixel
  const auto luma = to_grey(format, {6, 6, 0}, MosaicUse::luma, bytes);
  EXPECT_EQ(luma->at(2, 2), 60u);  // 0.299 * 200
  EXPECT_EQ(luma->at(3, 2), 30u);  // half of it
  EXPECT_EQ(luma->at(3, 3), 15u);  // a quarter
  EXPECT_EQ(luma->at(1, 1), 15u);
  EXPECT_EQ(luma->at(4, 2), 0u);  // red too, and dark
}

TEST(AravisClock, NeverTellsATimeThatIsTooLateAndSeldomOneMuchTooEarly) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part(0, 1);
  for (const double drift : {-150e-6, -20e-6, 0.0, 60e-6, 150e-6}) {
    // The camera counts from an hour ago; its second is 1 + drift of ours.
    const auto camera_at = [&](std::int64_t ns) {
      return static_cast<std::int64_t>(3.6e12 + static_cast<double>(ns) * (1 + drift));
    };
    CameraClock clock;
    std::int64_t now_ns = 1'000'000'000, worst_ns = 0;
    for (int latch = 0; latch < 30; ++latch) {
      const auto there_ns = static_cast<std::int64_t>(3e5 + 2e6 * part(random));
      const auto back_ns = static_cast<std::int64_t>(3e5 + 2e6 * part(random));
      clock.add({now_ns, now_ns + there_ns + back_ns, camera_at(now_ns + there_ns)});
      for (int frame = 0; frame < 20; ++frame) {
        const std::int64_t true_ns = now_ns + static_cast<std::int64_t>(1.1e10 * part(random));
        const std::int64_t told_ns = clock.earliest_ns(camera_at(true_ns));
        ASSERT_LE(told_ns, true_ns) << "late, drift " << drift << ", latch " << latch;
        if (latch > 5) worst_ns = std::max(worst_ns, true_ns - told_ns);
      }
      now_ns += 10'000'000'000;
    }
    EXPECT_LT(worst_ns, 4'000'000) << drift;
  }
}

TEST(AravisClock, StartsAnewWhereTheCameraWasResetOrCountsSomethingElse) {
  CameraClock clock;
  clock.add({1'000'000'000, 1'001'000'000, 5'000'000'000'000});
  clock.add({12'000'000'000, 12'001'000'000, 700'000'000});  // switched off and on
  EXPECT_LE(clock.earliest_ns(700'000'000), 12'001'000'000);
  EXPECT_GE(clock.earliest_ns(700'000'000), 12'000'000'000);
  clock.add({22'000'000'000, 22'001'000'000, 1'700'000'000});  // ten times too slow: no ns
  EXPECT_GE(clock.earliest_ns(1'700'000'000), 22'000'000'000);
  EXPECT_LE(clock.earliest_ns(1'700'000'000), 22'001'000'000);
}

TEST(AravisFrames, MissingNumbersAreCountedAndAResetIsNone) {
  EXPECT_EQ(missing_between(1, 2), 0u);
  EXPECT_EQ(missing_between(1, 5), 3u);
  EXPECT_EQ(missing_between(65535, 1), 0u);  // GigE Vision has no number 0
  EXPECT_EQ(missing_between(65534, 2), 2u);
  EXPECT_EQ(missing_between(70000, 70002), 1u);  // numbers of 64 bits
  EXPECT_EQ(missing_between(500, 1), 0u);
  EXPECT_EQ(missing_between(70000, 1), 0u);
  EXPECT_EQ(missing_between(7, 7), 0u);
}

}  // namespace
}  // namespace fathom::aravis
