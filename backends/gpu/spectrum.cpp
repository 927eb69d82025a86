// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/spectrum.hpp"

#include <bit>

#include "backends/gpu/tables.hpp"
#include "engine/tables.hpp"

namespace fathom::gpu {
namespace {

using Complex = std::complex<double>;

double number(std::uint32_t word) { return double{std::bit_cast<float>(word)}; }

/// Where zero frequency stands.
int centre_of(TransformFamily family, int n) {
  switch (family) {
    case TransformFamily::fourier:
      return n / 2;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 0;
  }
  return 0;
}

/// [row][column] of Plan::spectrum, by the frequencies or indices of a coefficient.
class Plane {
 public:
  Plane(const MetricSpec& spec, std::span<Complex> coefficients)
      : n_(spec.n),
        centre_(centre_of(family_of(spec.transform), spec.n)),
        coefficients_(coefficients) {}

  Complex& at(int row, int column) {
    const int mask = n_ - 1;
    return coefficients_[static_cast<std::size_t>((row + centre_) & mask) * n_ +
                         ((column + centre_) & mask)];
  }

 private:
  int n_, centre_;
  std::span<Complex> coefficients_;
};

/// fft: half of the plane, of the rows 0 and N/2 half again: the rest are mirror images.
void arrange_half_plane(Plane plane, int n, double scale, const std::uint32_t* raw) {
  const int half = n / 2;
  for (int v = 0; v <= half; ++v) {
    for (int u = 0; u < (v % half == 0 ? half + 1 : n); ++u) {
      const std::uint32_t* const words = raw + 2 * (static_cast<std::size_t>(v) * n + u);
      const Complex f(number(words[0]), number(words[1]));
      plane.at(-v, -u) = std::conj(f) * scale;
      plane.at(v, u) = f * scale;
    }
  }
}

/// walsh: integers in two parts.
Complex walsh_coefficient(const std::uint32_t* words) {
  return 4096.0 * static_cast<std::int32_t>(words[0]) + static_cast<std::int32_t>(words[1]);
}

/// exact: numbers of two floats.
Complex exact_coefficient(const std::uint32_t* words) {
  return {number(words[0]) + number(words[1]), number(words[2]) + number(words[3])};
}

}  // namespace

void arrange_spectrum(const MetricSpec& spec, Kernel kernel, Depth depth, const std::uint32_t* raw,
                      std::span<Complex> coefficients) {
  const double scale = tables::coefficient_scale(spec.transform, spec.n);
  Plane plane(spec, coefficients);
  if (kernel == Kernel::fft) return arrange_half_plane(plane, spec.n, scale, raw);
  const auto index = index_by_position(spec);
  const bool is_exact = kernel == Kernel::exact;
  for (const int row : index) {
    for (const int column : index) {
      plane.at(row, column) = scale * (is_exact ? exact_coefficient(raw) : walsh_coefficient(raw));
      raw += is_exact ? 4 : 2;
    }
  }
  // walsh leaves the middle of the range out of every pixel.
  if (!is_exact) plane.at(0, 0) += depth == Depth::bits8 ? 0x80 : 0x8000;
}

}  // namespace fathom::gpu
