// SPDX-License-Identifier: Apache-2.0
// The peer's kernels: pixels to floats, what cuFFT does not have, and spectra to scores. As a
// careful user would write them: 16-byte accesses side by side, one warp or block per window in the
// reductions, butterflies in registers between exchanges through shared memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "window_math.hpp"

namespace fathom::peer {

constexpr int kBlock = 256;

/// Pixels that a block transforms on chip.
constexpr int kPoints = 4096;

/// One thread widens four pixels of a row. Pixel4: uchar4 or ushort4, to which rows and origins are
/// aligned. taper: w(x), or null. quads: of all windows.
template <int kLogN, class Pixel4>
__global__ void convert(const unsigned char* __restrict__ frame, std::size_t stride,
                        const std::uint32_t* __restrict__ origins, const float* __restrict__ taper,
                        float4* __restrict__ out, unsigned quads) {
  const unsigned i = blockIdx.x * kBlock + threadIdx.x;
  if (i >= quads) return;
  constexpr unsigned kQuads = 1U << (2 * kLogN - 2);
  constexpr unsigned kRow = 1U << (kLogN - 2);
  const unsigned row = i % kQuads / kRow, quad = i % kRow;
  const unsigned char* const line = frame + origins[i / kQuads] + row * stride;
  const Pixel4 pixel = reinterpret_cast<const Pixel4*>(line)[quad];
  float4 value = make_float4(pixel.x, pixel.y, pixel.z, pixel.w);
  if (taper != nullptr) {
    const float y = taper[row];
    const float4 x = reinterpret_cast<const float4*>(taper)[quad];
    value = make_float4(tapered(value.x, y, x.x), tapered(value.y, y, x.y),
                        tapered(value.z, y, x.z), tapered(value.w, y, x.w));
  }
  out[i] = value;
}

/// The sum over kTeam threads that belong together, in the first of them.
template <int kTeam>
__device__ float team_sum(float value) {
  for (int far = 16; far > 0; far /= 2) value += __shfl_down_sync(0xFFFFFFFFU, value, far);
  if (kTeam == 32) return value;
  __shared__ float sums[32];
  if (threadIdx.x % 32 == 0) sums[threadIdx.x / 32] = value;
  __syncthreads();
  float sum = 0;
  if (threadIdx.x == 0) {
    for (int warp = 0; warp < kTeam / 32; ++warp) sum += sums[warp];
  }
  return sum;
}

/// Threads that reduce one window: a warp, or a block, which is larger for large windows.
template <int kLogN>
struct Team {
  static constexpr int kThreads = kLogN <= 5 ? 32 : kLogN <= 7 ? 256 : 1024;
  static constexpr int kBlockThreads = kThreads < kBlock ? kBlock : kThreads;
  static constexpr int kWindows = kBlockThreads / kThreads;
};

/// Scores from the half planes that cuFFT gives.
template <int kLogN, bool kPower>
__global__ void reduce_fft(const float2* __restrict__ spectrum, float* __restrict__ scores,
                           unsigned windows, float scale) {
  constexpr unsigned kCount = HalfPlane<kLogN>::kCount;
  using Mine = Team<kLogN>;
  const unsigned window = blockIdx.x * Mine::kWindows + threadIdx.x / Mine::kThreads;
  const int lane = threadIdx.x % Mine::kThreads;
  float sum = 0;
  if (window < windows) {
    const float2* const mine = spectrum + std::size_t{window} * kCount;
    for (unsigned i = lane; i < kCount; i += Mine::kThreads) {
      const float2 f = mine[i];
      sum += weight<kLogN>(i) * mass<kPower>(f.x, f.y);
    }
  }
  sum = team_sum<Mine::kThreads>(sum);
  if (lane == 0 && window < windows) scores[window] = scale * sum;
}

/// Scores from Walsh coefficients in natural order; arms: the squared lever arm of each position.
template <int kLogN>
__global__ void reduce_walsh(const float4* __restrict__ spectrum, const float* __restrict__ arms,
                             float* __restrict__ scores, unsigned windows, float scale) {
  constexpr int kQuads = 1 << (2 * kLogN - 2), kRow = 1 << (kLogN - 2);
  using Mine = Team<kLogN>;
  const unsigned window = blockIdx.x * Mine::kWindows + threadIdx.x / Mine::kThreads;
  const int lane = threadIdx.x % Mine::kThreads;
  float sum = 0;
  if (window < windows) {
    const float4* const mine = spectrum + std::size_t{window} * kQuads;
    for (int i = lane; i < kQuads; i += Mine::kThreads) {
      const float y = arms[i / kRow];
      const float4 x = reinterpret_cast<const float4*>(arms)[i % kRow];
      const float4 w = mine[i];
      sum += fabsf(w.x) * (x.x + y) + fabsf(w.y) * (x.y + y) + fabsf(w.z) * (x.z + y) +
             fabsf(w.w) * (x.w + y);
    }
  }
  sum = team_sum<Mine::kThreads>(sum);
  if (lane == 0 && window < windows) scores[window] = scale * sum;
}

/// Where point i lies in shared memory, so that strides of powers of two meet all banks.
__device__ constexpr int place(int i) { return i + i / 32; }

/// Butterflies of kRadix points 2^kBit apart, for all of a block's points.
template <int kRadix, int kBit>
__device__ void butterflies(float* points) {
#pragma unroll
  for (int first = 0; first < kPoints / kRadix; first += kBlock) {
    const int i = first + static_cast<int>(threadIdx.x);
    const int base = (i >> kBit << kBit) * kRadix + (i & ((1 << kBit) - 1));
    float value[kRadix];
#pragma unroll
    for (int k = 0; k < kRadix; ++k) value[k] = points[place(base + (k << kBit))];
#pragma unroll
    for (int half = 1; half < kRadix; half *= 2) {
#pragma unroll
      for (int k = 0; k < kRadix; ++k) {
        if ((k & half) != 0) continue;
        const float a = value[k], b = value[k + half];
        value[k] = a + b;
        value[k + half] = a - b;
      }
    }
#pragma unroll
    for (int k = 0; k < kRadix; ++k) points[place(base + (k << kBit))] = value[k];
  }
  __syncthreads();
}

/// All stages of the bits kFrom .. kTo - 1 of a point's number.
template <int kFrom, int kTo>
__device__ void all_butterflies(float* points) {
  if constexpr (kTo - kFrom >= 3) {
    butterflies<8, kFrom>(points);
    all_butterflies<kFrom + 3, kTo>(points);
  } else if constexpr (kTo - kFrom > 0) {
    butterflies<(1 << (kTo - kFrom)), kFrom>(points);
  }
}

/// Walsh-Hadamard transforms, in place, over the bits kFrom .. kTo - 1 of the points of a tile of
/// kPoints, which is 2^kLogWidth points wide and whose rows are 2^kLogPitch points apart. Tiles lie
/// side by side, then below each other.
template <int kFrom, int kTo, int kLogWidth, int kLogPitch>
__global__ void walsh(float4* data) {
  __shared__ float points[place(kPoints - 1) + 1];
  constexpr int kLogTiles = kLogPitch - kLogWidth;
  const std::size_t band = blockIdx.x >> kLogTiles, tile = blockIdx.x & ((1 << kLogTiles) - 1);
  float4* const mine =
      data + ((band * (kPoints >> kLogWidth) << kLogPitch) + (tile << kLogWidth)) / 4;
  const auto quad = [&](int i) {  // which of the tile's float4, from its first point's number
    return ((i >> kLogWidth << kLogPitch) + (i & ((1 << kLogWidth) - 1))) / 4;
  };
  for (int i = 4 * static_cast<int>(threadIdx.x); i < kPoints; i += 4 * kBlock) {
    const float4 value = mine[quad(i)];
    points[place(i)] = value.x;
    points[place(i + 1)] = value.y;
    points[place(i + 2)] = value.z;
    points[place(i + 3)] = value.w;
  }
  __syncthreads();
  all_butterflies<kFrom, kTo>(points);
  for (int i = 4 * static_cast<int>(threadIdx.x); i < kPoints; i += 4 * kBlock) {
    mine[quad(i)] = make_float4(points[place(i)], points[place(i + 1)], points[place(i + 2)],
                                points[place(i + 3)]);
  }
}

}  // namespace fathom::peer
