// SPDX-License-Identifier: Apache-2.0
// The checks that the thesis made of its own transforms (T11): the 1-D Fourier transform of an
// exponentially damped sine, and the Fourier and Walsh transforms of an 8 x 8 matrix. Its figures
// came from textbooks; these come from closed forms and from exact integer arithmetic.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "tests/conformance/spectra.hpp"
#include "tests/conformance/suite.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

class ThesisChecks : public Conformance {};
FATHOM_EVERY_DEVICE(ThesisChecks);

/// SUM_x exp(-a x) sin(b x) exp(-2 pi i u x/N): two geometric series.
Coefficient damped_sine_transform(double a, double b, int u, int n) {
  const double angle = 2 * std::numbers::pi * u / n;
  const auto series = [&](double sign) {
    const Coefficient ratio = std::exp(Coefficient(-a, sign * b - angle));
    return (1.0 - std::pow(ratio, n)) / (1.0 - ratio);
  };
  return (series(1) - series(-1)) / Coefficient(0, 2);
}

/// Row v = 0 of the spectrum: the 1-D transform (with 1/N) of the mean over the rows.
void expect_one_dimensional(const Spectrum& got, double offset, double height, double a, double b,
                            double bound) {
  const int n = got.n();
  double largest = 0;
  for (int u = -n / 2; u < n / 2; ++u) {
    Coefficient expected = height * damped_sine_transform(a, b, u, n) / double(n);
    largest = std::max(largest, std::abs(expected));
    if (u == 0) expected += offset;
    EXPECT_TRUE(test::within(std::abs(got.frequency(u, 0) - expected), 0, bound)) << "u = " << u;
  }
  EXPECT_GT(largest, 100 * bound) << "the bound would pass anything";
}

// Halved every pixel with period 4, the damped sine is a row of integers (2^14, -2^12, .. 1 between
// zeros), so the closed form holds without any quantisation.
TEST_P(ThesisChecks, DampedSineInIntegers) {
  each({{MetricSpec::parse("fft:16:none"), "damped-sine", 16, 0}}, 1,
       [&](const Case& tested, Plan& plan) {
         constexpr int n = 16, sine[] = {0, 1, 0, -1};
         test::Pixels pixels{n, n, 16, std::vector<std::uint16_t>(n * n)};
         for (int y = 0; y < n; ++y) {
           for (int x = 0; x < n; ++x) {
             pixels.at(x, y) = static_cast<std::uint16_t>(32768 + sine[x % 4] * (32768 >> x));
           }
         }
         const Spectrum got = spectrum_of(plan, test::to_frame(pixels));
         expect_one_dimensional(got, 32768, 32768, std::log(2), std::numbers::pi / 2,
                                32768 * tolerance(tested.spec));
       });
}

// Any damping and period, as a textbook has them. The N rows round the same sample to both sides so
// that their mean is right to 1/(2 N) grey levels: 2.5e-7 of the height, the thesis' six places.
TEST_P(ThesisChecks, DampedSineToSixPlaces) {
  each({{MetricSpec::parse("fft:64:none"), "damped-sine", 16, 0}}, 1,
       [&](const Case& tested, Plan& plan) {
         constexpr int n = 64;
         constexpr double height = 32000, a = 0.1, b = 0.7;
         test::Pixels pixels{n, n, 16, std::vector<std::uint16_t>(n * n)};
         for (int x = 0; x < n; ++x) {
           const double sample = 32768 + height * std::exp(-a * x) * std::sin(b * x);
           const auto column_sum = std::lround(n * sample);
           for (int y = 0; y < n; ++y) {
             pixels.at(x, y) = static_cast<std::uint16_t>((column_sum + y) / n);
           }
         }
         const Spectrum got = spectrum_of(plan, test::to_frame(pixels));
         expect_one_dimensional(got, 32768, height, a, b, 0.5 / n + 32768 * tolerance(tested.spec));
       });
}

constexpr int kMatrix[8][8] = {
    {12, 200, 31, 7, 90, 255, 0, 64},    {3, 18, 140, 77, 254, 1, 99, 160},
    {250, 45, 6, 88, 121, 33, 71, 19},   {0, 255, 0, 255, 128, 127, 64, 63},
    {17, 34, 51, 68, 85, 102, 119, 136}, {222, 5, 173, 2, 58, 91, 240, 10},
    {81, 9, 230, 144, 26, 201, 8, 113},  {39, 166, 54, 190, 11, 72, 208, 255}};

Frame matrix_frame() {
  std::vector<std::uint8_t> pixels;
  for (const auto& row : kMatrix) pixels.insert(pixels.end(), std::begin(row), std::end(row));
  return Frame(8, 8, std::move(pixels));
}

// The eighth roots of unity are 0, +-1 and +-sqrt(1/2): 64 F is p + q sqrt(1/2) with integers p, q.
TEST_P(ThesisChecks, FourierTransformOfAMatrix) {
  constexpr int whole[] = {1,  0, 0, 0,
                           -1, 0, 0, 0};  // cos(2 pi k/8) = whole[k] + half[k] sqrt(1/2)
  constexpr int half[] = {0, 1, 0, -1, 0, -1, 0, 1};
  each({{MetricSpec::parse("fft:8:none"), "matrix", 8, 0}}, 1, [&](const Case& tested, Plan& plan) {
    Spectrum expected(8);
    for (int v = -4; v < 4; ++v) {
      for (int u = -4; u < 4; ++u) {
        int re[2] = {}, im[2] = {};
        for (int y = 0; y < 8; ++y) {
          for (int x = 0; x < 8; ++x) {
            const int k = (u * x + v * y) & 7, quarter = (k + 2) & 7;  // -sin(a) = cos(a + pi/2)
            re[0] += kMatrix[y][x] * whole[k];
            re[1] += kMatrix[y][x] * half[k];
            im[0] += kMatrix[y][x] * whole[quarter];
            im[1] += kMatrix[y][x] * half[quarter];
          }
        }
        expected.frequency(u, v) =
            Coefficient(re[0] + re[1] * std::sqrt(0.5), im[0] + im[1] * std::sqrt(0.5)) / 64.0;
      }
    }
    const Spectrum got = spectrum_of(plan, matrix_frame());
    EXPECT_TRUE(test::spectrum_matches(got.values(), expected.values(), tolerance(tested.spec)));
  });
}

using WalshMatrix = std::array<const char*, 8>;
constexpr WalshMatrix kSequency = {"++++++++", "++++----", "++----++", "++--++--",
                                   "+--++--+", "+--+-++-", "+-+--+-+", "+-+-+-+-"};
constexpr WalshMatrix kPaley = {"++++++++", "++++----", "++--++--", "++----++",
                                "+-+-+-+-", "+-+--+-+", "+--++--+", "+--+-++-"};
constexpr WalshMatrix kHadamard = {"++++++++", "+-+-+-+-", "++--++--", "+--++--+",
                                   "++++----", "+-+--+-+", "++----++", "+--+-++-"};

TEST_P(ThesisChecks, WalshTransformsOfAMatrix) {
  each({{MetricSpec::parse("walsh-paley:8"), "matrix", 8, 0},
        {MetricSpec::parse("walsh-sequency:8"), "matrix", 8, 0},
        {MetricSpec::parse("walsh-hadamard:8"), "matrix", 8, 0}},
       1, [&](const Case& tested, Plan& plan) {
         const Transform order = tested.spec.transform;
         const WalshMatrix& wal = order == Transform::walsh_paley      ? kPaley
                                  : order == Transform::walsh_sequency ? kSequency
                                                                       : kHadamard;
         Spectrum expected(8);
         int moment = 0;
         for (int i = 0; i < 8; ++i) {
           for (int j = 0; j < 8; ++j) {
             int sum = 0;
             for (int y = 0; y < 8; ++y) {
               for (int x = 0; x < 8; ++x)
                 sum += wal[i][y] == wal[j][x] ? kMatrix[y][x] : -kMatrix[y][x];
             }
             expected.at(i, j) = sum / 64.0;
             moment += std::abs(sum) * (i * i + j * j);
           }
         }
         const Frame frame = matrix_frame();
         EXPECT_TRUE(
             test::spectrum_matches(spectrum_of(plan, frame).values(), expected.values(), 0));
         EXPECT_TRUE(test::bit_equal(plan.score(frame, {0, 0, 8}), moment / std::pow(8.0, 6)));
       });
}

}  // namespace
}  // namespace fathom::conformance
