// SPDX-License-Identifier: Apache-2.0
// Eqs. 3-10, 5-1 and 5-2 and the cosine transform once more, in 113-bit arithmetic and as literally as can be: no fast
// transform, nothing taken off the mean, no line shared with the library. Slow, and nobody's
// habits.
#pragma once

#include <quadmath.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "tests/support/patterns.hpp"

namespace fathom::golden {

__extension__ typedef __float128 Quad;

/// [row][col] of an N x N table.
template <class T>
class Square {
 public:
  explicit Square(int n) : n_(n), values_(static_cast<std::size_t>(n) * n) {}
  int n() const { return n_; }
  T& at(int row, int col) { return values_[static_cast<std::size_t>(row) * n_ + col]; }
  const T& at(int row, int col) const { return values_[static_cast<std::size_t>(row) * n_ + col]; }

 private:
  int n_;
  std::vector<T> values_;
};

/// cosine_fraction: 0 none, 1 hann. Squared radii that count: low < r^2 <= high.
struct Options {
  bool power = false;
  std::optional<std::pair<Quad, Quad>> squared_radii;
};

/// w(x) of thesis T3.
std::vector<Quad> taper(Quad cosine_fraction, int n);

/// SUM w f / SUM w, w(x) w(y) the weights.
Quad weighted_mean(const test::Pixels& picture, const std::vector<Quad>& w);

/// |F(u,v)|^2 of the tapered picture less a constant, [v + N/2][u + N/2] (eq. 3-10).
Square<Quad> fourier_power(const test::Pixels& picture, const std::vector<Quad>& w,
                           Quad constant = 0);

/// phi of eq. 5-1.
Quad fourier_quality(const Square<Quad>& power, const Options& options);

enum class WalshOrder { paley, sequency, hadamard };

/// wal_i(x), [i][x]: Sylvester's matrix by doubling; its rows sorted by their sign changes;
/// products of square waves (thesis T5).
Square<int> walsh_functions(WalshOrder order, int n);

/// N^2 W(i,j) of the picture as it is, [i][j].
Square<std::int64_t> walsh_sums(const test::Pixels& picture, const Square<int>& wal);

/// S = SUM N^2 |W| (i^2 + j^2): phi of eq. 5-2 is S / N^6.
std::uint64_t walsh_moment(const Square<std::int64_t>& sums, const Options& options);

/// W(i,j) of the tapered picture, [i][j].
Square<Quad> tapered_walsh(const test::Pixels& picture, const std::vector<Quad>& w,
                           const Square<int>& wal);

/// C(i,j) of the picture as it is, [i][j] (docs/metrics.md, "Cosine").
Square<Quad> cosine_spectrum(const test::Pixels& picture);

/// Bits per coefficient (docs/metrics.md, "Entropy").
Quad entropy(const Square<Quad>& spectrum, const Options& options);

/// phi of eq. 5-2, of W or C.
Quad real_quality(const Square<Quad>& spectrum, const Options& options);

/// Mean masses in rings (docs/metrics.md, "Rings"). squared_edges: e(k)^2, the rings' number and
/// one; zero: row and column of zero frequency; cycles: indices to one cycle per window.
std::vector<Quad> ring_means(const Square<Quad>& masses, const std::vector<double>& squared_edges,
                             int zero, int cycles);

}  // namespace fathom::golden
