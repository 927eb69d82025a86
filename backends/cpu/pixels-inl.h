// SPDX-License-Identifier: Apache-2.0
// From pixels to lanes.
#if defined(FATHOM_CPU_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_PIXELS_INL_H_
#undef FATHOM_CPU_PIXELS_INL_H_
#else
#define FATHOM_CPU_PIXELS_INL_H_
#endif

#include "backends/cpu/kernel.hpp"
#include "backends/cpu/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// Where a window's pixels lie. Rows may start anywhere: nothing is aligned.
template <class Pixel>
class WindowPixels {
 public:
  WindowPixels(const Frame& frame, const Window& window)
      : origin_(frame.row(window.y) + static_cast<std::size_t>(window.x) * sizeof(Pixel)),
        stride_(frame.stride_bytes()) {}

  HWY_INLINE const std::byte* at(int x, int y) const {
    return origin_ + static_cast<std::size_t>(y) * stride_ +
           static_cast<std::size_t>(x) * sizeof(Pixel);
  }

  /// Pixels x, x+1, .. of row y, one per lane, as numbers of the tag's type.
  template <class D>
  HWY_INLINE HWY_ATTR Vec<D> load(D d, int x, int y) const {
    return widen(d, hn::LoadU(hn::Rebind<Pixel, D>(), reinterpret_cast<const Pixel*>(at(x, y))));
  }

  template <class D, class V>
  static HWY_INLINE HWY_ATTR Vec<D> widen(D d, V pixels) {
    using T = hn::TFromD<D>;
    const hn::Rebind<std::int32_t, D> d32;
    if constexpr (std::is_same_v<T, float> && std::is_same_v<Pixel, std::uint8_t>) {
      // 2^23 + pixel, by its bits, less 2^23: on many processors cheaper than a conversion.
      const auto shifted = hn::Or(hn::PromoteTo(d32, pixels), hn::Set(d32, 0x4b000000));
      return hn::Sub(hn::BitCast(d, shifted), hn::Set(d, 8388608.0F));
    } else if constexpr (std::is_same_v<T, float>) {
      return hn::ConvertTo(d, hn::PromoteTo(d32, pixels));
    } else if constexpr (std::is_same_v<T, double>) {
      return hn::PromoteTo(d, hn::PromoteTo(d32, pixels));
    } else {
      return hn::PromoteTo(d, pixels);
    }
  }

 private:
  const std::byte* origin_;
  std::size_t stride_;
};

/// Eight pixels of a row of each of 16 windows, turned: turned[x][window].
HWY_INLINE HWY_ATTR void turn_rows(const std::byte* const (&rows)[kBlock],
                                   std::uint8_t* HWY_RESTRICT turned) {
  const hn::FixedTag<std::uint8_t, 16> d;
  const hn::FixedTag<std::uint8_t, 8> d_row;
  Vec<decltype(d)> v[8], next[8];
  // Each step brings together the same pixel of windows twice as many.
  unroll<8>([&](auto i) FATHOM_LAMBDA {
    const auto a = hn::LoadU(d_row, reinterpret_cast<const std::uint8_t*>(rows[i]));
    const auto b = hn::LoadU(d_row, reinterpret_cast<const std::uint8_t*>(rows[i + 8]));
    v[i] = hn::InterleaveLower(d, hn::ZeroExtendVector(d, a), hn::ZeroExtendVector(d, b));
  });
  unroll<4>([&](auto i) FATHOM_LAMBDA {  // next[i]: pixels 0-3 of windows i, i+4, ..; then 4-7
    next[i] = hn::InterleaveLower(d, v[i], v[i + 4]);
    next[i + 4] = hn::InterleaveUpper(d, v[i], v[i + 4]);
  });
  unroll<4>([&](auto k) FATHOM_LAMBDA {  // v[..]: two pixels of windows i, i+2, ..
    constexpr int half = k / 2 * 4, i = k % 2;
    v[half + i] = hn::InterleaveLower(d, next[half + i], next[half + i + 2]);
    v[half + i + 2] = hn::InterleaveUpper(d, next[half + i], next[half + i + 2]);
  });
  unroll<4>([&](auto k) FATHOM_LAMBDA {
    hn::Store(hn::InterleaveLower(d, v[2 * k], v[2 * k + 1]), d, turned + (2 * k) * kBlock);
    hn::Store(hn::InterleaveUpper(d, v[2 * k], v[2 * k + 1]), d, turned + (2 * k + 1) * kBlock);
  });
}

HWY_INLINE HWY_ATTR void turn_rows(const std::byte* const (&rows)[kBlock],
                                   std::uint16_t* HWY_RESTRICT turned) {
  for (int window = 0; window < kBlock; ++window) {
    std::uint16_t row[8];
    std::memcpy(row, rows[window], sizeof row);
    for (int x = 0; x < 8; ++x) turned[x * kBlock + window] = row[x];
  }
}

/// The pixels of up to 16 windows side by side: block[y][x][window]. Where there are fewer windows,
/// the first one fills the rest.
template <int N, class Pixel>
HWY_INLINE HWY_ATTR void gather_block(const Frame& frame, std::span<const Window> windows,
                                      Pixel* HWY_RESTRICT block) {
  const std::byte* rows[kBlock];
  for (std::size_t w = 0; w < kBlock; ++w) {
    rows[w] = WindowPixels<Pixel>(frame, windows[w < windows.size() ? w : 0]).at(0, 0);
  }
  for (int y = 0; y < N; ++y) {
    for (int x = 0; x < N; x += 8) {
      turn_rows(rows, block + (y * N + x) * kBlock);
      for (auto& row : rows) row += 8 * sizeof(Pixel);
    }
    for (auto& row : rows) row += frame.stride_bytes() - N * sizeof(Pixel);
  }
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
