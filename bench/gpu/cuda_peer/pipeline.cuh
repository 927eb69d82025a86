// SPDX-License-Identifier: Apache-2.0
// {convert + taper kernel, transform of the whole batch, reduction kernel}: one stream, its buffers
// and its plan.
#pragma once

#include <type_traits>

#include "kernels.cuh"
#include "scorer.cuh"

namespace fathom::peer {

/// Calls with log2 n as a type, for n = 8 .. 512.
template <class Call>
void with_log(int n, const Call& call) {
  switch (n) {
    case 8:
      return call(std::integral_constant<int, 3>());
    case 16:
      return call(std::integral_constant<int, 4>());
    case 32:
      return call(std::integral_constant<int, 5>());
    case 64:
      return call(std::integral_constant<int, 6>());
    case 128:
      return call(std::integral_constant<int, 7>());
    case 256:
      return call(std::integral_constant<int, 8>());
    case 512:
      return call(std::integral_constant<int, 9>());
    default:
      throw std::runtime_error("no kernels for N = " + std::to_string(n));
  }
}

class FourierPlan {
 public:
  FourierPlan(int n, std::size_t windows, cudaStream_t stream) {
    int sides[2] = {n, n};
    PEER_CHECK(cufftPlanMany(&plan_, 2, sides, nullptr, 1, 0, nullptr, 1, 0, CUFFT_R2C,
                             static_cast<int>(windows)));
    const cufftResult result = cufftSetStream(plan_, stream);
    if (result != CUFFT_SUCCESS) cufftDestroy(plan_);  // no destructor runs if this one throws
    PEER_CHECK(result);
  }
  FourierPlan(const FourierPlan&) = delete;
  FourierPlan& operator=(const FourierPlan&) = delete;
  ~FourierPlan() { cufftDestroy(plan_); }

  void run(float* pixels, cufftComplex* spectrum) const {
    PEER_CHECK(cufftExecR2C(plan_, pixels, spectrum));
  }

 private:
  cufftHandle plan_ = 0;
};

class Pipeline final : public Scorer {
 public:
  static std::size_t bytes_between(const Metric& metric) {
    const std::size_t n = metric.n;
    return 4 * n * n + (metric.is_walsh ? 0 : 8 * n * (n / 2 + 1));
  }

  Pipeline(const Metric& metric, std::size_t windows, std::size_t chunk)
      : metric_(metric),
        windows_(windows),
        chunk_(chunk),
        table_(on_device(metric.is_walsh ? sequency_arms(metric.n) : hann(metric.n))),
        pixels_(
            device_array<float>((chunk * metric.n * metric.n + kPoints - 1) / kPoints * kPoints)) {
    if (metric.is_walsh) return;
    spectrum_ = device_array<cufftComplex>(chunk * metric.n * (metric.n / 2 + 1));
    plan_ = std::make_unique<FourierPlan>(metric.n, chunk, stream_.get());
  }

  cudaStream_t stream() const override { return stream_.get(); }

  void run(const unsigned char* frame, std::size_t stride, const std::uint32_t* origins,
           float* scores) const override {
    with_log(metric_.n, [&](auto log_n) {
      for (std::size_t first = 0; first < windows_; first += chunk_) {
        const auto count = static_cast<unsigned>(std::min(chunk_, windows_ - first));
        widen<log_n>(frame, stride, origins + first, count);
        if (metric_.is_walsh) {
          transform_and_reduce_walsh<log_n>(scores + first, count);
        } else {
          plan_->run(pixels_.get(), spectrum_.get());
          reduce<log_n>(scores + first, count);
        }
      }
    });
  }

 private:
  template <int kLogN>
  void widen(const unsigned char* frame, std::size_t stride, const std::uint32_t* origins,
             unsigned count) const {
    const unsigned quads = count << (2 * kLogN - 2);
    const unsigned blocks = (quads + kBlock - 1) / kBlock;
    const float* const taper = metric_.is_walsh ? nullptr : table_.get();
    auto* const out = reinterpret_cast<float4*>(pixels_.get());
    const auto kernel = metric_.depth == 8 ? convert<kLogN, uchar4> : convert<kLogN, ushort4>;
    kernel<<<blocks, kBlock, 0, stream()>>>(frame, stride, origins, taper, out, quads);
    PEER_CHECK(cudaGetLastError());
  }

  template <int kLogN>
  static unsigned reduction_blocks(unsigned count) {
    return (count + Team<kLogN>::kWindows - 1) / Team<kLogN>::kWindows;
  }

  template <int kLogN>
  void reduce(float* scores, unsigned count) const {
    const auto kernel = metric_.is_power ? reduce_fft<kLogN, true> : reduce_fft<kLogN, false>;
    kernel<<<reduction_blocks<kLogN>(count), Team<kLogN>::kBlockThreads, 0, stream()>>>(
        spectrum_.get(), scores, count, static_cast<float>(scale(metric_)));
    PEER_CHECK(cudaGetLastError());
  }

  /// cuFFT has no Walsh-Hadamard transform: windows up to N = 64 are transformed on chip at one go,
  /// larger ones by rows, then by columns.
  template <int kLogN>
  void transform_and_reduce_walsh(float* scores, unsigned count) const {
    const auto blocks =
        static_cast<unsigned>(((std::size_t{count} << (2 * kLogN)) + kPoints - 1) / kPoints);
    auto* const data = reinterpret_cast<float4*>(pixels_.get());
    if constexpr (kLogN <= 6) {
      walsh<0, 2 * kLogN, 12, 12><<<blocks, kBlock, 0, stream()>>>(data);
    } else {
      walsh<0, kLogN, 12, 12><<<blocks, kBlock, 0, stream()>>>(data);
      PEER_CHECK(cudaGetLastError());
      walsh<12 - kLogN, 12, 12 - kLogN, kLogN><<<blocks, kBlock, 0, stream()>>>(data);
    }
    PEER_CHECK(cudaGetLastError());
    reduce_walsh<kLogN>
        <<<reduction_blocks<kLogN>(count), Team<kLogN>::kBlockThreads, 0, stream()>>>(
            data, table_.get(), scores, count, static_cast<float>(scale(metric_)));
    PEER_CHECK(cudaGetLastError());
  }

  Metric metric_;
  std::size_t windows_;
  std::size_t chunk_;
  Stream stream_;
  DeviceArray<float> table_;
  DeviceArray<float> pixels_;
  DeviceArray<cufftComplex> spectrum_;
  std::unique_ptr<FourierPlan> plan_;
};

}  // namespace fathom::peer
