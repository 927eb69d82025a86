// SPDX-License-Identifier: Apache-2.0
// What cuFFT's callbacks do: a pixel of the frame by its place in the batch, and a coefficient into
// its window's sums. Plain C++ on the host, where callback_math_test.cpp calls the same functions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "window_math.hpp"

namespace fathom::peer {

/// What the callbacks know of the windows that are transformed; it lies on the device.
struct CallbackInfo {
  const unsigned char* frame;
  std::size_t stride;            ///< Bytes from row to row.
  const std::uint32_t* origins;  ///< Bytes from the frame's first to each window's first pixel.
  const float* taper;            ///< w(x), n values.
  float* sums;                   ///< sum_slots(n) of each window.
};

/// Sums that a window's coefficients are dealt out to, so that the threads of a warp, which store
/// neighbours, do not wait for each other at one address.
PEER_BOTH constexpr int sum_slots(int n) { return n < 32 ? n : 32; }

/// Element `offset` of the batch of windows, [window][row][column], widened and tapered.
template <int kLogN, class Pixel>
PEER_BOTH float load_pixel(const CallbackInfo& info, unsigned long long offset) {
  constexpr unsigned kLast = (1U << kLogN) - 1;
  const auto place = static_cast<unsigned>(offset);  // a batch has less than 2^32 of them
  const unsigned row = place >> kLogN & kLast, column = place & kLast;
  const unsigned char* const line =
      info.frame + info.origins[place >> (2 * kLogN)] + row * info.stride;
  const Pixel pixel = reinterpret_cast<const Pixel*>(line)[column];
  return tapered(static_cast<float>(pixel), info.taper[row], info.taper[column]);
}

PEER_BOTH void add(float* sum, float value) {
#ifdef __CUDA_ARCH__
  atomicAdd(sum, value);
#else
  *sum += value;
#endif
}

/// Adds coefficient `offset` of the batch, [window][v][u], to one of its window's sums.
template <int kLogN, bool kPower>
PEER_BOTH void add_coefficient(const CallbackInfo& info, unsigned long long offset, float re,
                               float im) {
  constexpr unsigned kCount = HalfPlane<kLogN>::kCount, kSlots = sum_slots(1 << kLogN);
  const auto place = static_cast<unsigned>(offset);
  const unsigned window = place / kCount, i = place % kCount;
  add(info.sums + window * kSlots + i % kSlots, weight<kLogN>(i) * mass<kPower>(re, im));
}

}  // namespace fathom::peer
