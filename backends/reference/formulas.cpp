// SPDX-License-Identifier: Apache-2.0
#include "backends/reference/formulas.hpp"

#include <bit>
#include <cmath>
#include <numbers>

namespace fathom::reference {
namespace {

constexpr Real kPi = std::numbers::pi_v<Real>;

std::size_t at(int row, int col, int n) { return static_cast<std::size_t>(row) * n + col; }

/// Tukey-Hanning flanks over the outer fraction A of the axis: 1/2 (1 - cos(2 pi (x + 1/2)/(A N))),
/// which for A = 1 is the hann of thesis T3.
Real taper_at(Real fraction, int x, int n) {
  const int mirrored = std::min(x, n - 1 - x);
  const Real distance = mirrored + Real{0.5};
  if (2 * distance >= fraction * n) return 1;
  return (1 - std::cos(2 * kPi * distance / (fraction * n))) / 2;
}

int bits_of(int n) { return std::countr_zero(static_cast<unsigned>(n)); }

/// wal_i(x) in Paley order: the product of the Rademacher functions that the bits of i select; the
/// lowest bit selects the slowest one, whose sign is the highest bit of x.
int walsh_paley(int i, int x, int n) {
  int sign = 1;
  for (int bit = 0; bit < bits_of(n); ++bit) {
    const int selected = (i >> bit) & 1;
    const int negative = (x >> (bits_of(n) - 1 - bit)) & 1;
    if (selected && negative) sign = -sign;
  }
  return sign;
}

/// wal_i(x) in the order that the metric names (thesis T5).
int walsh_at(Transform order, int i, int x, int n) {
  switch (order) {
    case Transform::walsh_sequency:
      return walsh_paley(i ^ (i >> 1), x, n);  // Gray code of i
    case Transform::walsh_hadamard:
      return std::popcount(static_cast<unsigned>(i & x)) % 2 ? -1 : 1;
    case Transform::walsh_paley:
      return walsh_paley(i, x, n);
    case Transform::fft:
    case Transform::dct:
      break;
  }
  return 0;  // no Walsh function
}

/// The grey level nearest to the window's mean.
long rounded_mean(const Frame& frame, const Window& window) {
  std::int64_t sum = 0;
  for (int y = 0; y < window.n; ++y) {
    for (int x = 0; x < window.n; ++x) sum += frame.at(window.x + x, window.y + y);
  }
  const std::int64_t pixels = std::int64_t{window.n} * window.n;
  return static_cast<long>((sum + pixels / 2) / pixels);
}

/// Whether the coefficient counts, and how much: its squared lever arm, or 0 outside the band.
Real lever_arm(const MetricSpec& spec, int row, int col) {
  const double squared = static_cast<double>(row) * row + static_cast<double>(col) * col;
  return !spec.band || spec.band->contains(spec.transform, spec.n, squared) ? Real{squared}
                                                                            : Real{0};
}

/// phi from an integer sum S = SUM N^2 |W| (i^2 + j^2): S / N^6, rounded once.
double exact_quality(std::uint64_t sum, int n) {
  return std::ldexp(static_cast<double>(sum), -6 * bits_of(n));
}

double exact_walsh_quality(const Basis& basis, const Frame& frame, const Window& window) {
  const int n = basis.spec.n;
  const auto sums = walsh_sums(basis, frame, window);
  std::uint64_t moment = 0;  // at most 2^62: docs/metrics.md, "Why Walsh scores are exact"
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const auto arm = static_cast<std::uint64_t>(lever_arm(basis.spec, i, j));
      moment += static_cast<std::uint64_t>(std::abs(sums[at(i, j, n)])) * arm;
    }
  }
  return exact_quality(moment, n);
}

/// Of W or C, [i][j].
double quality_of_real(const MetricSpec& spec, const std::vector<Real>& spectrum) {
  Real moment = 0;
  for (int i = 0; i < spec.n; ++i) {
    for (int j = 0; j < spec.n; ++j) {
      const Real w = spectrum[at(i, j, spec.n)];
      moment += (spec.power ? w * w : std::abs(w)) * lever_arm(spec, i, j);
    }
  }
  return static_cast<double>(std::ldexp(moment, -4 * bits_of(spec.n)));
}

double fourier_quality(const Basis& basis, const Frame& frame, const Window& window) {
  const MetricSpec& spec = basis.spec;
  const int half = spec.n / 2;
  const auto spectrum = fourier_spectrum(basis, frame, window);
  Real moment = 0;
  for (int v = -half; v < half; ++v) {
    for (int u = -half; u < half; ++u) {
      const Real power = std::norm(spectrum[at(v + half, u + half, spec.n)]);
      moment += (spec.power ? power : std::sqrt(power)) * lever_arm(spec, v, u);
    }
  }
  return static_cast<double>(std::ldexp(moment, -4 * bits_of(spec.n) - 1));
}

}  // namespace

Basis::Basis(const MetricSpec& metric) : spec(metric) {
  const int n = spec.n;
  for (int x = 0; x < n; ++x) taper.push_back(taper_at(spec.taper.cosine_fraction, x, n));
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      make_fourier();
      break;
    case TransformFamily::walsh:
      make_walsh();
      break;
    case TransformFamily::cosine:
      make_cosine();
      break;
  }
}

/// The argument's period is 4 N steps of pi/(2 N): reduced first, so that a large index costs no
/// digits.
void Basis::make_cosine() {
  const int n = spec.n;
  for (int i = 0; i < n; ++i) {
    for (int x = 0; x < n; ++x) {
      const int step = i * (2 * x + 1) % (4 * n);
      cosine.push_back((i == 0 ? 1 : std::sqrt(Real{2})) * std::cos(kPi * step / (2 * n)));
    }
  }
}

void Basis::make_walsh() {
  const int n = spec.n;
  walsh.resize(at(n, 0, n));
  for (int i = 0; i < n; ++i) {
    for (int x = 0; x < n; ++x) {
      walsh[at(i, x, n)] = static_cast<std::int8_t>(walsh_at(spec.transform, i, x, n));
    }
  }
}

void Basis::make_fourier() {
  const int n = spec.n;
  for (int k = 0; k < n; ++k) root.push_back(std::polar(Real{1}, -2 * kPi * k / n));
  if (spec.taper == Taper::none()) {
    // The sum over whole turns is 1 for u = 0 and exactly 0 elsewhere; added up, it would leave
    // 1e-20, and a flat picture would have a score.
    taper_transform.assign(n, 0);
    taper_transform[n / 2] = 1;
    return;
  }
  for (int u = -n / 2; u < n / 2; ++u) {
    Complex sum = 0;
    for (int x = 0; x < n; ++x) sum += taper[x] * root[(u * x) & (n - 1)];
    taper_transform.push_back(sum / Real(n));
  }
}

// The rows first, then the columns of what the rows gave, as the thesis did (T4). A constant m near
// the mean is taken off before and m W(u) W(v) added after: the same sum, but the large mean's
// rounding does not spread over all the coefficients. The picture is real, so F(-u,-v) is the
// conjugate of F(u,v) and half of the columns are enough.
std::vector<Complex> fourier_spectrum(const Basis& basis, const Frame& frame, const Window& window,
                                      Brightness brightness) {
  const int n = basis.spec.n;
  const int half = n / 2;
  const int mask = n - 1;  // -1 & mask = n - 1: exp has period N
  const long mean = rounded_mean(frame, window);
  const Real added_back = brightness == Brightness::kept ? mean : 0;

  std::vector<Complex> rows(at(n, 0, n));  // [y][u + N/2], u <= 0
  for (int y = 0; y < n; ++y) {
    for (int u = -half; u <= 0; ++u) {
      Complex sum = 0;
      for (int x = 0; x < n; ++x) {
        const Real pixel = static_cast<long>(frame.at(window.x + x, window.y + y)) - mean;
        sum += basis.taper[x] * pixel * basis.root[(u * x) & mask];
      }
      rows[at(y, u + half, n)] = sum;
    }
  }

  std::vector<Complex> spectrum(at(n, 0, n));
  const Real scale = Real{1} / (Real(n) * n);
  for (int v = -half; v < half; ++v) {
    for (int u = -half; u <= 0; ++u) {
      Real re = 0, im = 0;
      for (int y = 0; y < n; ++y) {
        const Complex a = basis.taper[y] * rows[at(y, u + half, n)];
        const Complex e = basis.root[(v * y) & mask];
        re += a.real() * e.real() - a.imag() * e.imag();
        im += a.real() * e.imag() + a.imag() * e.real();
      }
      const Complex constant =
          added_back * basis.taper_transform[u + half] * basis.taper_transform[v + half];
      spectrum[at(v + half, u + half, n)] = Complex(re, im) * scale + constant;
    }
  }
  for (int v = -half; v < half; ++v) {
    const int mirrored_v = (half - v) & mask;  // -v + N/2, where -(-N/2) is -N/2 again
    for (int u = 1; u < half; ++u) {
      spectrum[at(v + half, u + half, n)] = std::conj(spectrum[at(mirrored_v, half - u, n)]);
    }
  }
  return spectrum;
}

std::vector<Real> tapered_walsh_spectrum(const Basis& basis, const Frame& frame,
                                         const Window& window) {
  const int n = basis.spec.n;
  std::vector<Real> rows(at(n, 0, n));  // [y][j]
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      Real sum = 0;
      for (int x = 0; x < n; ++x) {
        sum += basis.taper[x] * frame.at(window.x + x, window.y + y) * basis.walsh[at(j, x, n)];
      }
      rows[at(y, j, n)] = sum * basis.taper[y];
    }
  }
  std::vector<Real> spectrum(at(n, 0, n));
  const Real scale = Real{1} / (Real(n) * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Real sum = 0;
      for (int y = 0; y < n; ++y) sum += rows[at(y, j, n)] * basis.walsh[at(i, y, n)];
      spectrum[at(i, j, n)] = sum * scale;
    }
  }
  return spectrum;
}

std::vector<std::int64_t> walsh_sums(const Basis& basis, const Frame& frame, const Window& window) {
  const int n = basis.spec.n;
  std::vector<std::int64_t> rows(at(n, 0, n));  // [y][j]
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      std::int64_t sum = 0;
      for (int x = 0; x < n; ++x) {
        sum += std::int64_t{frame.at(window.x + x, window.y + y)} * basis.walsh[at(j, x, n)];
      }
      rows[at(y, j, n)] = sum;
    }
  }
  std::vector<std::int64_t> sums(at(n, 0, n));
  for (int i = 0; i < n; ++i) {
    for (int y = 0; y < n; ++y) {
      for (int j = 0; j < n; ++j) {
        sums[at(i, j, n)] += rows[at(y, j, n)] * basis.walsh[at(i, y, n)];
      }
    }
  }
  return sums;
}

/// About the grey level nearest to the mean, which zero frequency alone gets back: all others are 0
/// of a flat window.
std::vector<Real> cosine_spectrum(const Basis& basis, const Frame& frame, const Window& window) {
  const int n = basis.spec.n;
  const long mean = rounded_mean(frame, window);
  std::vector<Real> rows(at(n, 0, n));  // [y][j]
  for (int y = 0; y < n; ++y) {
    for (int j = 0; j < n; ++j) {
      Real sum = 0;
      for (int x = 0; x < n; ++x) {
        const long pixel = static_cast<long>(frame.at(window.x + x, window.y + y)) - mean;
        sum += pixel * basis.cosine[at(j, x, n)];
      }
      rows[at(y, j, n)] = sum;
    }
  }
  std::vector<Real> spectrum(at(n, 0, n));
  for (int i = 0; i < n; ++i) {
    for (int y = 0; y < n; ++y) {
      for (int j = 0; j < n; ++j) {
        spectrum[at(i, j, n)] += rows[at(y, j, n)] * basis.cosine[at(i, y, n)];
      }
    }
  }
  for (Real& coefficient : spectrum) coefficient /= Real(n) * n;
  spectrum[0] += mean;
  return spectrum;
}

double focus_quality(const Basis& basis, const Frame& frame, const Window& window) {
  switch (family_of(basis.spec.transform)) {
    case TransformFamily::fourier:
      return fourier_quality(basis, frame, window);
    case TransformFamily::walsh:
      return basis.spec.is_exact()
                 ? exact_walsh_quality(basis, frame, window)
                 : quality_of_real(basis.spec, tapered_walsh_spectrum(basis, frame, window));
    case TransformFamily::cosine:
      return quality_of_real(basis.spec, cosine_spectrum(basis, frame, window));
  }
  return 0;
}

}  // namespace fathom::reference
