// SPDX-License-Identifier: Apache-2.0
// What the card gives at most, measured: the roofline's two sides, and the way to the card.
#pragma once

#include <algorithm>
#include <vector>

#include "check.cuh"

namespace fathom::peer {

class Event {
 public:
  Event() { PEER_CHECK(cudaEventCreate(&event_)); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { cudaEventDestroy(event_); }
  cudaEvent_t get() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

/// The fastest of some repetitions on the default stream, in seconds: a ceiling is what can be had.
template <class Start>
double fastest_s(const Start& start, int repetitions) {
  const Event before, after;
  double fastest = 1e9;
  for (int i = 0; i < repetitions + 2; ++i) {
    PEER_CHECK(cudaEventRecord(before.get()));
    start();
    PEER_CHECK(cudaEventRecord(after.get()));
    PEER_CHECK(cudaEventSynchronize(after.get()));
    float ms = 0;
    PEER_CHECK(cudaEventElapsedTime(&ms, before.get(), after.get()));
    if (i >= 2) fastest = std::min(fastest, 1e-3 * ms);
  }
  return fastest;
}

constexpr int kChains = 8, kFmas = 4096;

/// kChains independent chains of fused multiply-adds in every thread: enough to hide their latency.
__global__ void multiply_add(float* out, float factor, float term) {
  float value[kChains];
#pragma unroll
  for (int k = 0; k < kChains; ++k) value[k] = static_cast<float>(threadIdx.x + k);
#pragma unroll 16
  for (int i = 0; i < kFmas; ++i) {
#pragma unroll
    for (int k = 0; k < kChains; ++k) value[k] = fmaf(value[k], factor, term);
  }
  float sum = 0;
#pragma unroll
  for (int k = 0; k < kChains; ++k) sum += value[k];
  if (sum == -1.0F) *out = sum;  // never, but the compiler does not know
}

/// Reads everything and keeps next to nothing, as a fused kernel does.
__global__ void read_all(const float4* in, std::size_t count, float* out) {
  float sum = 0;
  const std::size_t step = std::size_t{gridDim.x} * blockDim.x;
  for (std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x; i < count; i += step) {
    const float4 value = in[i];
    sum += value.x + value.y + value.z + value.w;
  }
  if (sum == -1.0F) *out = sum;
}

struct Ceilings {
  double copy_bytes_per_s = 0;    ///< On the device, read and written bytes both counted.
  double read_bytes_per_s = 0;    ///< On the device.
  double upload_bytes_per_s = 0;  ///< From pinned memory.
  double flops = 0;               ///< A fused multiply-add counts as two.
};

inline Ceilings measure_ceilings(int multiprocessors) {
  constexpr std::size_t kBytes = std::size_t{1} << 30, kUpload = std::size_t{256} << 20;
  const auto from = device_array<float4>(kBytes / sizeof(float4));
  const auto to = device_array<float4>(kBytes / sizeof(float4));
  const auto host = pinned_array<unsigned char>(kUpload);
  const auto out = device_array<float>(1);
  PEER_CHECK(cudaMemset(from.get(), 0, kBytes));
  std::fill_n(host.get(), kUpload, static_cast<unsigned char>(1));
  Ceilings measured;
  measured.copy_bytes_per_s =
      2.0 * kBytes /
      fastest_s(
          [&] {
            PEER_CHECK(cudaMemcpyAsync(to.get(), from.get(), kBytes, cudaMemcpyDeviceToDevice));
          },
          20);
  measured.read_bytes_per_s =
      1.0 * kBytes /
      fastest_s(
          [&] {
            read_all<<<multiprocessors * 16, 256>>>(from.get(), kBytes / sizeof(float4), out.get());
            PEER_CHECK(cudaGetLastError());
          },
          20);
  measured.upload_bytes_per_s =
      1.0 * kUpload /
      fastest_s(
          [&] {
            PEER_CHECK(cudaMemcpyAsync(to.get(), host.get(), kUpload, cudaMemcpyHostToDevice));
          },
          10);
  const int blocks = multiprocessors * 32, threads = 256;
  measured.flops = 2.0 * kChains * kFmas * blocks * threads /
                   fastest_s(
                       [&] {
                         multiply_add<<<blocks, threads>>>(out.get(), 0.999F, 0.5F);
                         PEER_CHECK(cudaGetLastError());
                       },
                       20);
  return measured;
}

}  // namespace fathom::peer
