// SPDX-License-Identifier: Apache-2.0
// The metrics that the peer knows, and their scores straight from the definitions
// (docs/metrics.md).
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace fathom::peer {

/// fft:N:hann[:power] or walsh-sequency:N.
struct Metric {
  bool is_walsh = false;
  bool is_power = false;
  int n = 64;
  int depth = 8;

  std::string text() const {
    const std::string side = std::to_string(n);
    return is_walsh ? "walsh-sequency:" + side
                    : "fft:" + side + ":hann" + (is_power ? ":power" : "");
  }
  std::size_t window_bytes() const { return std::size_t{1} * n * n * (depth / 8); }
};

constexpr double kPi = 3.14159265358979323846;

/// Tukey-Hanning (thesis T3).
inline std::vector<float> hann(int n) {
  std::vector<float> taper(n);
  for (int x = 0; x < n; ++x) {
    taper[x] = static_cast<float>(0.5 * (1 - std::cos(2 * kPi * (x + 0.5) / n)));
  }
  return taper;
}

/// Sign changes of row `position` of Sylvester's matrix, counted; its square is the lever arm.
inline std::vector<float> sequency_arms(int n) {
  std::vector<float> arms(n);
  for (int position = 0; position < n; ++position) {
    int changes = 0;
    for (int x = 1; x < n; ++x) {
      changes += __builtin_parity(position & x) != __builtin_parity(position & (x - 1));
    }
    arms[position] = static_cast<float>(changes) * static_cast<float>(changes);
  }
  return arms;
}

/// The factor from SUM |coefficient| r^2 over the plane, without 1/N^2, to the score.
inline double scale(const Metric& metric) {
  const double n = metric.n;
  return (metric.is_walsh ? 1 : 0.5) * std::pow(n, metric.is_power ? -8 : -6);
}

/// The window's pixels, [row][column].
inline std::vector<double> window_pixels(const Metric& metric, const unsigned char* first,
                                         std::size_t stride) {
  std::vector<double> pixels;
  for (int y = 0; y < metric.n; ++y) {
    for (int x = 0; x < metric.n; ++x) {
      std::uint16_t wide = 0;
      const unsigned char* const pixel = first + y * stride + x * (metric.depth / 8);
      std::memcpy(&wide, pixel, metric.depth / 8);  // little endian, as every host of CUDA
      pixels.push_back(wide);
    }
  }
  return pixels;
}

/// SUM_x SUM_y f(x,y) basis(v,y) basis(u,x) for the first `columns` of u, by direct sums.
template <class T>
std::vector<T> direct(const std::vector<double>& f, const std::vector<T>& basis, int n,
                      int columns) {
  std::vector<T> rows(std::size_t{1} * n * columns), all(rows.size());
  for (int y = 0; y < n; ++y) {
    for (int u = 0; u < columns; ++u) {
      T sum = 0;
      for (int x = 0; x < n; ++x) sum += f[y * n + x] * basis[u * n + x];
      rows[y * columns + u] = sum;
    }
  }
  for (int v = 0; v < n; ++v) {
    for (int y = 0; y < n; ++y) {
      const T factor = basis[v * n + y];
      for (int u = 0; u < columns; ++u) all[v * columns + u] += factor * rows[y * columns + u];
    }
  }
  return all;
}

/// exp(-2 pi i u x / n), [u][x].
inline std::vector<std::complex<double>> fourier_basis(int n) {
  std::vector<std::complex<double>> basis;
  for (int u = 0; u < n; ++u) {
    for (int x = 0; x < n; ++x) basis.push_back(std::polar(1.0, -2 * kPi * (u * x % n) / n));
  }
  return basis;
}

inline double direct_fft_score(const Metric& metric, std::vector<double> f) {
  const int n = metric.n, columns = n / 2 + 1;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      f[y * n + x] *=
          0.25 * (1 - std::cos(2 * kPi * (x + 0.5) / n)) * (1 - std::cos(2 * kPi * (y + 0.5) / n));
    }
  }
  const auto spectrum = direct(f, fourier_basis(n), n, columns);
  double sum = 0;
  for (int row = 0; row < n; ++row) {
    const int v = row < n / 2 ? row : row - n;
    for (int u = 0; u < columns; ++u) {
      const double power = std::norm(spectrum[row * columns + u]);
      const double mass = metric.is_power ? power : std::sqrt(power);
      sum += (u == 0 || u == n / 2 ? 1 : 2) * (double(u) * u + double(v) * v) * mass;
    }
  }
  return scale(metric) * sum;
}

inline double direct_walsh_score(const Metric& metric, const std::vector<double>& f) {
  const int n = metric.n;
  std::vector<double> basis(std::size_t{1} * n * n);
  for (int position = 0; position < n; ++position) {
    int changes = 0;
    for (int x = 1; x < n; ++x) {
      changes += __builtin_parity(position & x) != __builtin_parity(position & (x - 1));
    }
    for (int x = 0; x < n; ++x) {
      basis[changes * n + x] = __builtin_parity(position & x) ? -1 : 1;
    }
  }
  const auto spectrum = direct(f, basis, n, n);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      sum += std::abs(spectrum[i * n + j]) * (double(i) * i + double(j) * j);
    }
  }
  return scale(metric) * sum;
}

/// The score in double precision, by direct sums.
inline double direct_score(const Metric& metric, const unsigned char* first, std::size_t stride) {
  const auto pixels = window_pixels(metric, first, stride);
  return metric.is_walsh ? direct_walsh_score(metric, pixels) : direct_fft_score(metric, pixels);
}

}  // namespace fathom::peer
