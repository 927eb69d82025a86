// SPDX-License-Identifier: Apache-2.0
#include "tests/golden/direct_sums.hpp"

#include <stdexcept>

namespace fathom::golden {
namespace {

const Quad kPi = 4 * atanq(Quad(1));

bool counts(const Options& options, int row, int col) {
  if (!options.squared_radii) return true;
  const Quad squared = Quad(row) * row + Quad(col) * col;
  return options.squared_radii->first < squared && squared <= options.squared_radii->second;
}

int sign_changes(const Square<int>& matrix, int row) {
  int changes = 0;
  for (int x = 1; x < matrix.n(); ++x) changes += matrix.at(row, x) != matrix.at(row, x - 1);
  return changes;
}

/// H_1 = (1), H_2n = (H_n H_n; H_n -H_n).
Square<int> sylvester(int n) {
  Square<int> h(n);
  h.at(0, 0) = 1;
  for (int size = 1; size < n; size *= 2) {
    for (int i = 0; i < size; ++i) {
      for (int x = 0; x < size; ++x) {
        h.at(i, x + size) = h.at(i + size, x) = h.at(i, x);
        h.at(i + size, x + size) = -h.at(i, x);
      }
    }
  }
  return h;
}

/// Row i of the result is the row of Sylvester's matrix with i sign changes.
Square<int> by_sign_changes(int n) {
  const Square<int> h = sylvester(n);
  Square<int> sorted(n);
  for (int i = 0; i < n; ++i) {
    const int changes = sign_changes(h, i);
    if (sorted.at(changes, 0) != 0) throw std::logic_error("two rows with equal sign changes");
    for (int x = 0; x < n; ++x) sorted.at(changes, x) = h.at(i, x);
  }
  return sorted;
}

/// Paley: the function of i is the product of the Rademacher functions r_(b+1) of the bits b set in
/// i, where r_k(x) is a square wave that starts at +1 and has 2^k half periods in the window.
Square<int> rademacher_products(int n) {
  Square<int> products(n);
  for (int i = 0; i < n; ++i) {
    for (int x = 0; x < n; ++x) products.at(i, x) = 1;
    int half_periods = 2;
    for (int bits = i; bits != 0; bits /= 2, half_periods *= 2) {
      if (bits % 2 == 0) continue;
      for (int x = 0; x < n; ++x) {
        if (x * half_periods / n % 2 == 1) products.at(i, x) *= -1;
      }
    }
  }
  return products;
}

}  // namespace

std::vector<Quad> taper(Quad cosine_fraction, int n) {
  std::vector<Quad> w(n, Quad(1));
  const Quad flank = cosine_fraction * n / 2;  // px on either side
  for (int x = 0; x < n; ++x) {
    const Quad left = x + Quad(0.5), right = n - left;
    const Quad nearest = left < right ? left : right;
    if (nearest < flank) w[x] = (1 - cosq(kPi * nearest / flank)) / 2;
  }
  return w;
}

Quad weighted_mean(const test::Pixels& picture, const std::vector<Quad>& w) {
  Quad sum = 0, weights = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      sum += w[x] * w[y] * picture.at(x, y);
      weights += w[x] * w[y];
    }
  }
  return sum / weights;
}

Square<Quad> fourier_power(const test::Pixels& picture, const std::vector<Quad>& w, Quad constant) {
  const int n = picture.width, half = n / 2;
  std::vector<Quad> cosine(n), sine(n);
  for (int k = 0; k < n; ++k) sincosq(2 * kPi * k / n, &sine[k], &cosine[k]);
  // The real picture makes F(-u,-v) the conjugate of F(u,v): columns u <= 0 tell all magnitudes.
  Square<Quad> row_re(n), row_im(n);
  for (int y = 0; y < n; ++y) {
    for (int u = -half; u <= 0; ++u) {
      Quad re = 0, im = 0;
      for (int x = 0; x < n; ++x) {
        const Quad tapered = w[x] * w[y] * (picture.at(x, y) - constant);
        const int turn = -u * x % n;  // exp(-2 pi i u x/N) = exp(+2 pi i turn/N)
        re += tapered * cosine[turn];
        im += tapered * sine[turn];
      }
      row_re.at(y, -u) = re;
      row_im.at(y, -u) = im;
    }
  }
  Square<Quad> power(n);
  const Quad pixels = Quad(n) * n;
  for (int v = -half; v < half; ++v) {
    for (int u = -half; u <= 0; ++u) {
      Quad re = 0, im = 0;
      for (int y = 0; y < n; ++y) {
        const int turn = ((-v * y) % n + n) % n;
        const Quad a = row_re.at(y, -u), b = row_im.at(y, -u);
        re += a * cosine[turn] - b * sine[turn];
        im += a * sine[turn] + b * cosine[turn];
      }
      re /= pixels;
      im /= pixels;
      power.at(v + half, u + half) = re * re + im * im;
      if (u > -half && v > -half) power.at(half - v, half - u) = re * re + im * im;
      if (u > -half && v == -half) power.at(0, half - u) = re * re + im * im;
    }
  }
  return power;
}

Quad fourier_quality(const Square<Quad>& power, const Options& options) {
  const int n = power.n(), half = n / 2;
  Quad moment = 0;
  for (int v = -half; v < half; ++v) {
    for (int u = -half; u < half; ++u) {
      if (!counts(options, v, u)) continue;
      const Quad squared = power.at(v + half, u + half);
      moment += (options.power ? squared : sqrtq(squared)) * (u * u + v * v);
    }
  }
  return moment / 2 / (Quad(n) * n * n * n);
}

Square<int> walsh_functions(WalshOrder order, int n) {
  switch (order) {
    case WalshOrder::paley:
      return rademacher_products(n);
    case WalshOrder::sequency:
      return by_sign_changes(n);
    case WalshOrder::hadamard:
      return sylvester(n);
  }
  throw std::logic_error("no such order");
}

Square<std::int64_t> walsh_sums(const test::Pixels& picture, const Square<int>& wal) {
  const int n = picture.width;
  Square<std::int64_t> rows(n), sums(n);
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      for (int x = 0; x < n; ++x) rows.at(y, j) += wal.at(j, x) * std::int64_t{picture.at(x, y)};
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int y = 0; y < n; ++y) {
      for (int j = 0; j < n; ++j) sums.at(i, j) += wal.at(i, y) * rows.at(y, j);
    }
  }
  return sums;
}

std::uint64_t walsh_moment(const Square<std::int64_t>& sums, const Options& options) {
  std::uint64_t moment = 0;
  for (int i = 0; i < sums.n(); ++i) {
    for (int j = 0; j < sums.n(); ++j) {
      if (!counts(options, i, j)) continue;
      const std::int64_t sum = sums.at(i, j);
      const auto mass = static_cast<std::uint64_t>(sum < 0 ? -sum : sum);
      const auto arm = static_cast<std::uint64_t>(i * i + j * j);
      if (__builtin_add_overflow(moment, mass * arm, &moment)) {
        throw std::overflow_error("S does not fit 64 bits");
      }
    }
  }
  return moment;
}

Square<Quad> tapered_walsh(const test::Pixels& picture, const std::vector<Quad>& w,
                           const Square<int>& wal) {
  const int n = picture.width;
  Square<Quad> rows(n), spectrum(n);
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      Quad sum = 0;
      for (int x = 0; x < n; ++x) {
        const Quad tapered = w[x] * w[y] * picture.at(x, y);
        sum += wal.at(j, x) > 0 ? tapered : -tapered;
      }
      rows.at(y, j) = sum;
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Quad sum = 0;
      for (int y = 0; y < n; ++y) sum += wal.at(i, y) > 0 ? rows.at(y, j) : -rows.at(y, j);
      spectrum.at(i, j) = sum / (Quad(n) * n);
    }
  }
  return spectrum;
}

Square<Quad> cosine_spectrum(const test::Pixels& picture) {
  const int n = picture.width;
  Square<Quad> wave(n), rows(n), spectrum(n);  // wave: [i][x]
  for (int i = 0; i < n; ++i) {
    for (int x = 0; x < n; ++x)
      wave.at(i, x) = (i == 0 ? Quad(1) : sqrtq(Quad(2))) * cosq(kPi * i * (2 * x + 1) / (2 * n));
  }
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      for (int x = 0; x < n; ++x) rows.at(y, j) += wave.at(j, x) * picture.at(x, y);
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Quad sum = 0;
      for (int y = 0; y < n; ++y) sum += wave.at(i, y) * rows.at(y, j);
      spectrum.at(i, j) = sum / (Quad(n) * n);
    }
  }
  return spectrum;
}

Quad entropy(const Square<Quad>& spectrum, const Options& options) {
  const int n = spectrum.n();
  Quad squares = 0, bits = 0;
  int terms = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) squares += spectrum.at(i, j) * spectrum.at(i, j);
  }
  if (squares == 0) return 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if ((i == 0 && j == 0) || !counts(options, i, j)) continue;
      ++terms;
      const Quad p = fabsq(spectrum.at(i, j)) / sqrtq(squares);
      if (p > 0) bits -= p * log2q(p);
    }
  }
  return bits / terms;
}

Quad real_quality(const Square<Quad>& spectrum, const Options& options) {
  const int n = spectrum.n();
  Quad moment = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (!counts(options, i, j)) continue;
      const Quad w = spectrum.at(i, j);
      moment += (options.power ? w * w : fabsq(w)) * (i * i + j * j);
    }
  }
  return moment / (Quad(n) * n * n * n);
}

std::vector<Quad> ring_means(const Square<Quad>& masses, const std::vector<double>& squared_edges,
                             int zero, int cycles) {
  std::vector<Quad> means;
  for (std::size_t k = 0; k + 1 < squared_edges.size(); ++k) {
    Quad sum = 0;
    int count = 0;
    for (int row = 0; row < masses.n(); ++row) {
      for (int col = 0; col < masses.n(); ++col) {
        const int i = row - zero, j = col - zero;
        const Quad squared_radius = Quad(i * i + j * j) / (cycles * cycles);
        if (!(squared_edges[k] < squared_radius && squared_radius <= squared_edges[k + 1]))
          continue;
        sum += masses.at(row, col);
        ++count;
      }
    }
    if (count == 0) throw std::logic_error("a ring without a coefficient");
    means.push_back(sum / count);
  }
  return means;
}

}  // namespace fathom::golden
