// SPDX-License-Identifier: Apache-2.0
// cuFFT with callbacks: pixels are widened and tapered as cuFFT loads them, coefficients are
// weighed and added up as it stores them. Neither floats of pixels nor a spectrum go to memory;
// only what cuFFT may keep between its own kernels does.
//
// A kernel around cuFFTDx would keep a whole window on chip between both axes; but that library
// comes with no CUDA toolkit, so that no machine can be expected to have it.
#pragma once

#include "callback_math.hpp"
#include "callback_plan.cuh"
#include "kernels.cuh"
#include "scorer.cuh"

namespace fathom::peer {

/// Tells the callbacks of the next windows, and clears their sums.
__global__ void begin_sums(CallbackInfo* info, CallbackInfo next, unsigned count) {
  const unsigned i = blockIdx.x * kBlock + threadIdx.x;
  if (i == 0) *info = next;
  if (i < count) next.sums[i] = 0;
}

/// Scores from sums; a window's are neighbours within a warp.
__global__ void finish_sums(const float* __restrict__ sums, float* __restrict__ scores,
                            unsigned count, int slots, float scale) {
  const unsigned i = blockIdx.x * kBlock + threadIdx.x;
  float sum = i < count ? sums[i] : 0;
  for (int far = slots / 2; far > 0; far /= 2) sum += __shfl_down_sync(0xFFFFFFFFU, sum, far);
  if (i < count && i % slots == 0) scores[i / slots] = scale * sum;
}

class CallbackPipeline final : public Scorer {
 public:
  static std::size_t bytes_between(const Metric& metric) {
    const std::size_t n = metric.n;
    return 8 * n * (n / 2 + 1) + sizeof(float) * sum_slots(metric.n);
  }

  CallbackPipeline(const CallbackCode& code, const Metric& metric, std::size_t windows,
                   std::size_t chunk)
      : metric_(metric),
        windows_(windows),
        chunk_(chunk),
        taper_(on_device(hann(metric.n))),
        sums_(device_array<float>(chunk * sum_slots(metric.n))),
        spectrum_(device_array<cufftComplex>(chunk * metric.n * (metric.n / 2 + 1))),
        info_(device_array<CallbackInfo>(1)),
        plan_(metric, chunk, code, info_.get(), stream_.get()) {
    if (chunk * metric.n * metric.n >> 32 != 0) throw std::runtime_error("too many windows");
  }

  cudaStream_t stream() const override { return stream_.get(); }

  /// The last chunk begins early enough to be a whole one, as the plan wants it; a few windows
  /// get their scores twice.
  void run(const unsigned char* frame, std::size_t stride, const std::uint32_t* origins,
           float* scores) const override {
    const int slots = sum_slots(metric_.n);
    const auto sums = static_cast<unsigned>(chunk_ * slots);
    for (std::size_t first = 0; first < windows_; first += chunk_) {
      const std::size_t from = std::min(first, windows_ - chunk_);
      const CallbackInfo next = {frame, stride, origins + from, taper_.get(), sums_.get()};
      begin_sums<<<blocks(sums), kBlock, 0, stream()>>>(info_.get(), next, sums);
      PEER_CHECK(cudaGetLastError());
      plan_.run(frame, spectrum_.get());
      finish_sums<<<blocks(sums), kBlock, 0, stream()>>>(sums_.get(), scores + from, sums, slots,
                                                         static_cast<float>(scale(metric_)));
      PEER_CHECK(cudaGetLastError());
    }
  }

 private:
  static unsigned blocks(unsigned threads) { return (threads + kBlock - 1) / kBlock; }

  Metric metric_;
  std::size_t windows_;
  std::size_t chunk_;
  Stream stream_;
  DeviceArray<float> taper_;
  DeviceArray<float> sums_;
  DeviceArray<cufftComplex> spectrum_;
  DeviceArray<CallbackInfo> info_;
  CallbackPlan plan_;  // last, so that it goes before what it points to
};

}  // namespace fathom::peer
