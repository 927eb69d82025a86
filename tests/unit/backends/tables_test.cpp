// SPDX-License-Identifier: Apache-2.0
// The kernels' constants against their definitions, in the order in which the kernels read them.
#include "backends/cpu/tables.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "engine/window.hpp"

namespace fathom::cpu {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;

const std::vector<int> kSides = {8, 16, 32, 64, 128, 256, 512};
const std::vector<Band> kBands = {{0, 0.25}, {0.1, 0.3}, {0.05, 0.5}, {0.4, 0.7}};

std::complex<Real> root(int turns, int n) { return std::polar(Real{1}, -2 * kPi * turns / n); }

MetricSpec fourier(int n, Taper taper = Taper::hann(), std::optional<Band> band = {}) {
  return {Transform::fft, n, taper, false, band};
}

MetricSpec walsh(Transform order, int n, std::optional<Band> band = {}) {
  return {order, n, Taper::none(), false, band};
}

int signed_frequency(int k, int n) { return k < n / 2 ? k : k - n; }

TEST(CpuTables, RadicesMakeN) {
  for (const int n : kSides) {
    const Radices stages = radices(n);
    int product = 1;
    for (int i = 0; i < stages.count; ++i) product *= stages.radix[i];
    EXPECT_EQ(product, n);
  }
}

TEST(CpuTables, EveryFrequencyHasOnePosition) {
  for (const int n : kSides) {
    const auto frequency = frequency_by_position(n);
    const FourierTables<float> tables(fourier(n));
    ASSERT_EQ(frequency.size(), static_cast<std::size_t>(n));
    ASSERT_EQ(tables.position.size(), static_cast<std::size_t>(n));
    EXPECT_EQ(tables.frequency, frequency);
    for (int p = 0; p < n; ++p) {
      ASSERT_TRUE(frequency[p] >= 0 && frequency[p] < n);
      EXPECT_EQ(tables.position[frequency[p]], p) << "so no frequency stands twice";
    }
  }
}

// The stages of a decimation in frequency, in long double and without any thought of speed, give at
// position p the frequency that the table says.
TEST(CpuTables, TwiddlesAndPositionsMakeAFourierTransform) {
  for (const int n : kSides) {
    const FourierTables<double> tables(fourier(n));
    std::vector<std::complex<Real>> x(n), input(n);
    for (int k = 0; k < n; ++k) x[k] = input[k] = {Real(k * k % 17), Real(k * 5 % 7)};
    const Radices stages = radices(n);
    const double* twiddle = tables.twiddle.data();
    int span = n;
    for (int stage = 0; stage < stages.count; ++stage) {
      const int radix = stages.radix[stage], groups = span / radix;
      const bool is_last = stage + 1 == stages.count;
      for (int block = 0; block < n; block += span) {
        for (int s = 0; s < groups; ++s) {
          std::vector<std::complex<Real>> out(radix);
          for (int q = 0; q < radix; ++q) {
            for (int r = 0; r < radix; ++r)
              out[q] += x[block + s + r * groups] * root(q * r, radix);
            if (q == 0 || is_last) continue;
            const double* const factor = twiddle + 2 * (s * (radix - 1) + q - 1);
            out[q] *= std::complex<Real>(factor[0], factor[1]);
          }
          for (int q = 0; q < radix; ++q) x[block + s + q * groups] = out[q];
        }
      }
      if (!is_last) twiddle += 2 * (radix - 1) * groups;
      span = groups;
    }
    EXPECT_EQ(twiddle, tables.twiddle.data() + tables.twiddle.size());
    for (int p = 0; p < n; ++p) {
      std::complex<Real> expected = 0;
      for (int k = 0; k < n; ++k) expected += input[k] * root(k * tables.frequency[p] % n, n);
      EXPECT_LT(std::abs(x[p] - expected), 1e-12L * n) << n << ", position " << p;
    }
  }
}

template <class T>
void expect_flat_is_the_transform_of_the_taper(Taper taper, int n) {
  SCOPED_TRACE(to_string(taper) + ", N = " + std::to_string(n));
  const FourierTables<T> tables(fourier(n, taper));
  ASSERT_EQ(tables.taper.size(), static_cast<std::size_t>(n));
  ASSERT_EQ(tables.is_touched.size(), static_cast<std::size_t>(n));
  int touched_until = 0;
  for (int p = 0; p < n; ++p) {
    const int k = tables.frequency[p];
    std::complex<Real> sum = 0;
    for (int x = 0; x < n; ++x) sum += Real{tables.taper[x]} * root(k * x % n, n);
    // The taper itself is rounded to T, its transform only once at the end.
    const Real bound = n * Real{std::numeric_limits<T>::epsilon()};
    EXPECT_LT(std::abs(tables.flat_re[p] - sum.real()), bound) << k;
    EXPECT_LT(std::abs(tables.flat_im[p] - sum.imag()), bound) << k;
    EXPECT_EQ(tables.is_touched[p] != 0, tables.flat_re[p] != 0 || tables.flat_im[p] != 0) << k;
    if (tables.is_touched[p] && k <= n / 2) touched_until = std::max(touched_until, k);
  }
  EXPECT_EQ(tables.touched_until, touched_until);
  if (taper == Taper::none()) {
    EXPECT_EQ(touched_until, 0);
  } else if (taper == Taper::hann()) {
    EXPECT_EQ(touched_until, 1);
  }
}

TEST(CpuTables, AConstantIsTheTransformOfTheTaper) {
  for (const int n : kSides) {
    for (const Taper taper : {Taper::none(), Taper::hann(), Taper{0.25}, Taper{0.6}}) {
      expect_flat_is_the_transform_of_the_taper<float>(taper, n);
      expect_flat_is_the_transform_of_the_taper<double>(taper, n);
    }
  }
}

TEST(CpuTables, FourierLeverArmsFollowTheirPositions) {
  for (const int n : kSides) {
    const FourierTables<float> tables(fourier(n));
    ASSERT_EQ(tables.arm.size(), static_cast<std::size_t>(n));
    ASSERT_EQ(tables.arm_by_frequency.size(), static_cast<std::size_t>(n / 2 + 1));
    ASSERT_EQ(tables.share.size(), static_cast<std::size_t>(n / 2 + 1));
    for (int p = 0; p < n; ++p) {
      const int u = signed_frequency(tables.frequency[p], n);
      EXPECT_EQ(tables.arm[p], static_cast<float>(u * u));
    }
    for (int v = 0; v <= n / 2; ++v) {
      EXPECT_EQ(tables.arm_by_frequency[v], static_cast<float>(v * v));
      // Rows 0 and N/2 are their own mirror images; every other row has one in the other half.
      EXPECT_EQ(tables.share[v], (n - v) % n == v ? 0.5F : 1.0F);
    }
  }
}

TEST(CpuTables, FourierMasksAreTheBand) {
  for (const int n : kSides) {
    EXPECT_TRUE(FourierTables<float>(fourier(n)).mask.empty());
    for (const Band& band : kBands) {
      const FourierTables<float> tables(fourier(n, Taper::hann(), band));
      const std::size_t row = n / 2 + 1;
      ASSERT_EQ(tables.mask.size(), n * row);
      for (int p = 0; p < n; ++p) {
        const int u = signed_frequency(tables.frequency[p], n);
        for (int v = 0; v <= n / 2; ++v) {
          const bool counts = band.contains(Transform::fft, n, double(u) * u + double(v) * v);
          ASSERT_EQ(tables.mask[p * row + v], counts ? 1.0F : 0.0F) << n << ": " << u << "," << v;
        }
      }
    }
  }
}

/// The coefficient that an order gives to row p of the Sylvester matrix, (-1)^(bits of p and x).
int index_by_definition(Transform order, int p, int n) {
  if (order == Transform::walsh_hadamard) return p;
  if (order == Transform::walsh_paley) {
    int reversed = 0;
    for (int bit = 1; bit < n; bit *= 2) reversed = 2 * reversed + ((p & bit) != 0);
    return reversed;
  }
  int crossings = 0;
  for (int x = 1; x < n; ++x) {
    crossings += (std::popcount(unsigned(p & x)) + std::popcount(unsigned(p & (x - 1)))) % 2;
  }
  return crossings;
}

const std::vector<Transform> kOrders = {Transform::walsh_paley, Transform::walsh_sequency,
                                        Transform::walsh_hadamard};

TEST(CpuTables, WalshPositionsAreRowsOfTheSylvesterMatrix) {
  for (const int n : kSides) {
    for (const Transform order : kOrders) {
      const WalshTables tables(walsh(order, n));
      ASSERT_EQ(tables.index.size(), static_cast<std::size_t>(n));
      ASSERT_EQ(tables.arm.size(), static_cast<std::size_t>(n));
      for (int p = 0; p < n; ++p) {
        const int i = index_by_definition(order, p, n);
        EXPECT_EQ(tables.index[p], i) << to_string(order) << " " << n << " position " << p;
        EXPECT_EQ(tables.arm[p], i * i);
      }
    }
  }
}

TEST(CpuTables, WalshMasksAreTheBand) {
  const Transform order = Transform::walsh_sequency;  // the only one that has bands
  for (const int n : kSides) {
    EXPECT_TRUE(WalshTables(walsh(order, n)).mask.empty());
    std::vector<double> index;
    for (int p = 0; p < n; ++p) index.push_back(index_by_definition(order, p, n));
    for (const Band& band : kBands) {
      const WalshTables tables(walsh(order, n, band));
      ASSERT_EQ(tables.mask.size(), static_cast<std::size_t>(n) * n);
      for (int p = 0; p < n; ++p) {
        for (int q = 0; q < n; ++q) {
          const double i = index[q], j = index[p];
          const bool counts = band.contains(order, n, i * i + j * j);
          ASSERT_EQ(tables.mask[p * n + q], counts ? -1 : 0) << n << ": " << i << "," << j;
        }
      }
    }
  }
}

TEST(CpuTables, OnlyWhatTheTransformNeedsIsMade) {
  const Tables of_fourier(fourier(8)), of_walsh(walsh(Transform::walsh_paley, 8));
  EXPECT_TRUE(of_fourier.fourier_float && of_fourier.fourier_double && !of_fourier.walsh);
  EXPECT_TRUE(!of_walsh.fourier_float && !of_walsh.fourier_double && of_walsh.walsh);
}

}  // namespace
}  // namespace fathom::cpu
