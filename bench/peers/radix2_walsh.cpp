// SPDX-License-Identifier: Apache-2.0
// The butterfly that everybody writes first, left to the compiler to vectorise. Its one refinement:
// every stage knows its stride, without which the compiler does the short strides one by one (three
// times slower). In floats and in integers: which is faster depends on N.
#include <cstdint>

#include "bench/peers/by_size.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

/// The stages of strides kStride, 2 kStride, .. kCount / 2.
template <int kCount, int kStride, class T>
void butterflies(T* v) {
  for (int start = 0; start < kCount; start += 2 * kStride) {
    for (int i = start; i < start + kStride; ++i) {
      const T a = v[i];
      const T b = v[i + kStride];
      v[i] = a + b;
      v[i + kStride] = a - b;
    }
  }
  if constexpr (2 * kStride < kCount) butterflies<kCount, 2 * kStride>(v);
}

template <int N, class T>
class Radix2Walsh final : public PreparedPeer {
 public:
  explicit Radix2Walsh(Planning) {}

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    T* const values = aligned(values_.get());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      widen<N>(frame, windows[i], values);
      butterflies<N * N, 1>(values);
      scores[i] = factor_ * moment(values);
    }
  }

 private:
  double moment(const T* values) const {
    const float* const weight = aligned(weights_.get());
    return blocked_sum<N * N>(
        [=](int i) { return weight[i] * static_cast<float>(std::abs(values[i])); });
  }

  Buffer<T> values_ = make_buffer<T>(N * N);
  Buffer<float> weights_ = aligned_copy(natural_order_weights(N));
  double factor_ = score_factor(N);
};

template <int N>
using InFloats = Radix2Walsh<N, float>;
template <int N>
using InIntegers = Radix2Walsh<N, std::int32_t>;

}  // namespace

std::unique_ptr<PreparedPeer> prepare_radix2_walsh(int n, Planning planning) {
  return prepare_by_size<InFloats>(n, planning);
}

std::unique_ptr<PreparedPeer> prepare_radix2_int_walsh(int n, Planning planning) {
  return prepare_by_size<InIntegers>(n, planning);
}

}  // namespace fathom::bench
