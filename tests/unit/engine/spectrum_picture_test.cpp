// SPDX-License-Identifier: Apache-2.0
#include "engine/spectrum_picture.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

std::vector<std::complex<double>> black(int n) {
  return std::vector<std::complex<double>>(static_cast<std::size_t>(n) * n);
}

TEST(SpectrumPicture, FourierRepeatsItsFirstRowAndColumn) {
  auto spectrum = black(8);
  for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] = static_cast<double>(k);
  const Frame picture = spectrum_picture(Transform::fft, 8, spectrum, MagnitudeScale::linear);
  ASSERT_EQ(picture.width_px(), 9);
  ASSERT_EQ(picture.height_px(), 9);
  EXPECT_EQ(picture.depth(), Depth::bits8);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(picture.at(i, 8), picture.at(i, 0));
    EXPECT_EQ(picture.at(8, i), picture.at(0, i));
  }
  EXPECT_EQ(picture.at(7, 7), 255U);
  EXPECT_EQ(picture.at(0, 4), static_cast<unsigned>(std::lround(255 * 32 / 63.0)));
}

TEST(SpectrumPicture, WalshIsAsLargeAsItsWindow) {
  auto spectrum = black(16);
  spectrum[3 * 16 + 5] = -2;
  spectrum[7] = {0, 1};
  for (const Transform order :
       {Transform::walsh_paley, Transform::walsh_sequency, Transform::walsh_hadamard}) {
    const Frame picture = spectrum_picture(order, 16, spectrum, MagnitudeScale::linear);
    EXPECT_EQ(picture.width_px(), 16);
    EXPECT_EQ(picture.at(5, 3), 255U) << "column 5 of row 3, magnitude of -2";
    EXPECT_EQ(picture.at(7, 0), 128U);
    EXPECT_EQ(picture.at(0, 0), 0U);
  }
}

TEST(SpectrumPicture, DecibelsSpreadEightyBelowTheLargest) {
  auto spectrum = black(8);
  const double steps[] = {1e3, 1e2, 1e1, 1, 1e-1, 1e-2};  // 0, -20, .. -100 dB
  for (int i = 0; i < 6; ++i) spectrum[i] = steps[i];
  const Frame picture =
      spectrum_picture(Transform::walsh_paley, 8, spectrum, MagnitudeScale::decibel);
  const unsigned expected[] = {255, 191, 128, 64, 0, 0};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(picture.at(i, 0), expected[i]) << i;
  EXPECT_EQ(picture.at(7, 7), 0U) << "nothing is minus infinity, and black";
}

TEST(SpectrumPicture, NothingIsBlack) {
  for (const MagnitudeScale scale : {MagnitudeScale::linear, MagnitudeScale::decibel}) {
    const Frame picture = spectrum_picture(Transform::fft, 8, black(8), scale);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 9; ++x) EXPECT_EQ(picture.at(x, y), 0U);
    }
  }
}

TEST(SpectrumPicture, RefusesAnotherNumberOfCoefficients) {
  test::expect_error(ErrorCode::bad_argument,
                     [] { spectrum_picture(Transform::fft, 8, black(4), MagnitudeScale::linear); });
  test::expect_error(ErrorCode::bad_argument, [] {
    spectrum_picture(Transform::fft, -8, black(8), MagnitudeScale::linear);
  });
  test::expect_error(ErrorCode::bad_argument,
                     [] { spectrum_picture(Transform::fft, 0, {}, MagnitudeScale::linear); });
}

}  // namespace
}  // namespace fathom
