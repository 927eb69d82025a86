// SPDX-License-Identifier: Apache-2.0
// The arithmetic of one pixel and of one coefficient, which the plain kernels and cuFFT's callbacks
// share. The host compiles it too: callback_math_test.cpp holds it against `reference`.
#pragma once

#include <cmath>

#ifdef __CUDACC__
#define PEER_BOTH __host__ __device__ __forceinline__
#else
#define PEER_BOTH inline
#endif

namespace fathom::peer {

/// The half plane that cuFFT gives of a real window, [v][u], u = 0 .. N/2.
template <int kLogN>
struct HalfPlane {
  static constexpr unsigned kN = 1U << kLogN;
  static constexpr unsigned kRow = kN / 2 + 1;
  static constexpr unsigned kCount = kN * kRow;
};

/// A pixel times the taper of its row and of its column.
PEER_BOTH float tapered(float pixel, float row_taper, float column_taper) {
  return pixel * row_taper * column_taper;
}

/// What multiplies the magnitude of coefficient i of a half plane: the squared lever arm, doubled
/// for all but u = 0 and N/2, which stand for two.
template <int kLogN>
PEER_BOTH float weight(unsigned i) {
  using Plane = HalfPlane<kLogN>;
  const unsigned row = i / Plane::kRow, u = i % Plane::kRow;
  const unsigned v = row <= Plane::kN / 2 ? row : Plane::kN - row;
  return (u == 0 || u == Plane::kN / 2 ? 1.0F : 2.0F) * static_cast<float>(u * u + v * v);
}

/// A coefficient's power or magnitude.
template <bool kPower>
PEER_BOTH float mass(float re, float im) {
  const float power = re * re + im * im;
  return kPower ? power : sqrtf(power);
}

}  // namespace fathom::peer
