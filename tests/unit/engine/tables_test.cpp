// SPDX-License-Identifier: Apache-2.0
// Every table against its definition, worked out here in long double.
#include "engine/tables.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "engine/error.hpp"
#include "engine/window.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;

const std::vector<int>& sides() {
  static const std::vector<int> all = {8, 16, 32, 64, 128, 256, 512};
  return all;
}

std::complex<Real> root(int turns, int n) { return std::polar(Real{1}, -2 * kPi * turns / n); }

TEST(Tables, TaperIsARaisedCosineAtBothEnds) {
  for (const int n : sides()) {
    const auto hann = tables::taper(Taper::hann(), n);
    ASSERT_EQ(hann.size(), static_cast<std::size_t>(n));
    for (int x = 0; x < n; ++x) {
      const Real w = (1 - std::cos(2 * kPi * (x + Real{0.5}) / n)) / 2;
      EXPECT_LT(std::abs(hann[x] - w), 1e-15) << "N = " << n << ", x = " << x;
      EXPECT_EQ(hann[x], hann[n - 1 - x]) << "symmetric to the last bit";
      EXPECT_EQ(tables::taper(Taper::none(), n)[x], 1);
    }
  }
}

TEST(Tables, TukeyIsFlatBetweenItsFlanks) {
  const auto w = tables::taper({0.25}, 64);  // flanks of 8 px
  for (int x = 0; x < 64; ++x) {
    const int nearest = std::min(x, 63 - x);
    const Real expected = nearest < 8 ? (1 - std::cos(kPi * (nearest + Real{0.5}) / 8)) / 2 : 1;
    EXPECT_LT(std::abs(w[x] - expected), 1e-15) << x;
  }
}

TEST(Tables, TaperSpectrumIsTheTransformOfTheTaper) {
  for (const int n : sides()) {
    for (const double fraction : {0.0, 1.0, 0.25, 0.6}) {
      const auto w = tables::taper({fraction}, n);
      const auto spectrum = tables::taper_spectrum({fraction}, n);
      ASSERT_EQ(spectrum.size(), static_cast<std::size_t>(n));
      for (int u = 0; u < n; ++u) {
        std::complex<Real> sum = 0;
        for (int x = 0; x < n; ++x) sum += Real{w[x]} * root(u * x % n, n);
        const auto got = std::complex<Real>(spectrum[u].real(), spectrum[u].imag());
        EXPECT_LT(std::abs(got - sum / Real(n)), 1e-15) << n << ":" << fraction << " u = " << u;
      }
    }
  }
  const auto hann = tables::taper_spectrum(Taper::hann(), 64);
  for (int u = 2; u < 63; ++u) EXPECT_EQ(hann[u], 0.0) << "Hann has three coefficients";
}

TEST(Tables, TwiddlesAreRootsOfUnity) {
  for (const int n : sides()) {
    const auto roots = tables::twiddles(n);
    ASSERT_EQ(roots.size(), static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) {
      EXPECT_LT(std::abs(roots[k].real() - root(k, n).real()), 1.2e-16L) << n << " " << k;
      EXPECT_LT(std::abs(roots[k].imag() - root(k, n).imag()), 1.2e-16L) << n << " " << k;
      EXPECT_EQ(roots[(n - k) % n].real(), roots[k].real());
    }
    using Complex = std::complex<double>;
    EXPECT_EQ(roots[0], Complex(1, 0));
    EXPECT_EQ(roots[n / 4], Complex(0, -1));
    EXPECT_EQ(roots[n / 2], Complex(-1, 0));
    EXPECT_EQ(roots[3 * n / 4], Complex(0, 1));
  }
}

int sign_changes(int paley, int n) {
  int changes = 0, previous = 0;
  for (int x = 0; x < n; ++x) {
    int negative = 0;
    for (int bit = 1, other = n / 2; bit < n; bit *= 2, other /= 2) {
      negative ^= (paley & bit) != 0 && (x & other) != 0;
    }
    changes += x > 0 && negative != previous;
    previous = negative;
  }
  return changes;
}

TEST(Tables, OrdersAreByDefinition) {
  for (const int n : sides()) {
    const auto paley = tables::paley_index(Transform::walsh_paley, n);
    const auto sequency = tables::paley_index(Transform::walsh_sequency, n);
    const auto hadamard = tables::paley_index(Transform::walsh_hadamard, n);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(paley[i], i);
      EXPECT_EQ(sign_changes(sequency[i], n), i) << "sequency counts sign changes";
      // Row i of Sylvester's matrix is -1 at 2^b where bit b of i is set; Paley's is so from the
      // top.
      for (int bit = 1, mirrored = n / 2; bit < n; bit *= 2, mirrored /= 2) {
        EXPECT_EQ((hadamard[i] & mirrored) != 0, (i & bit) != 0);
      }
    }
    EXPECT_EQ(std::set<int>(hadamard.begin(), hadamard.end()).size(), hadamard.size());
  }
  EXPECT_EQ(tables::paley_index(Transform::walsh_sequency, 8),
            (std::vector<int>{0, 1, 3, 2, 6, 7, 5, 4}));
  test::expect_error(ErrorCode::bad_argument, [] { tables::paley_index(Transform::fft, 8); });
}

TEST(Tables, LeverArmsAreSquaredIndices) {
  EXPECT_EQ(tables::lever_arms(Transform::fft, 8), (std::vector<double>{0, 1, 4, 9, 16, 9, 4, 1}));
  EXPECT_EQ(tables::lever_arms(Transform::walsh_paley, 8),
            (std::vector<double>{0, 1, 4, 9, 16, 25, 36, 49}));
}

TEST(Tables, MomentWeightsAreLeverArmsInsideTheBand) {
  for (const char* text : {"fft:16", "walsh-sequency:16", "fft:16:hann:band=0.125-0.25",
                           "walsh-sequency:16:band=0.125-0.25", "fft:64:hann:power:band=0-0.3"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const int n = spec.n;
    const bool fft = spec.transform == Transform::fft;
    const auto weights = tables::moment_weights(spec);
    ASSERT_EQ(weights.size(), static_cast<std::size_t>(n) * n);
    int counted = 0;
    for (int row = 0; row < n; ++row) {
      for (int col = 0; col < n; ++col) {
        const int v = fft && row >= n / 2 ? row - n : row, u = fft && col >= n / 2 ? col - n : col;
        const double squared = u * u + v * v, cycles = n * (fft ? 1.0 : 2.0);
        bool counts = true;
        if (spec.band) {
          counts = std::pow(spec.band->low * cycles, 2) < squared &&
                   squared <= std::pow(spec.band->high * cycles, 2);
        }
        counted += counts;
        EXPECT_EQ(weights[row * n + col], counts ? squared : 0) << text << " " << row << " " << col;
      }
    }
    EXPECT_GT(counted, 0) << text;
  }
}

}  // namespace
}  // namespace fathom
