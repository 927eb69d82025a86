// SPDX-License-Identifier: Apache-2.0
// The Walsh-Hadamard kernels for 8-bit windows without taper and `power` (thesis eq. 5-2): integers
// as narrow as they can be. Compiled once per instruction set.
//
// A transform of N x N pixels is 2 log2 N stages of sums and differences, in any order. Pixels
// taken about the middle of their range (which changes T(0, 0) only, and that has no lever arm)
// need 16 bits for eight stages, so that the first eight run on 16-bit lanes and the rest on 32-bit
// ones:
//
//   columns   lanes = x: over y, in 16 bits; 8 rows by 8 columns turn in registers, and what is
//   left
//             of the eight stages goes over the low bits of x.
//   rows      lanes = i: over the other bits of x, in 32 bits. Magnitudes, sums by row and by
//   column,
//             each with its lever arm at the end.
//
// Windows of 8 and 16, sixteen at a time, lanes = windows: the same without a turn, all in 16 bits.
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/walsh_integer.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/pixels-inl.h"
#include "backends/cpu/wht-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

constexpr int kMiddleGrey = 128;

/// phi = S / N^6.
double exact_score(std::uint64_t sum, int n) {
  const double squared = static_cast<double>(n) * n;
  return static_cast<double>(sum) / (squared * squared * squared);
}

/// Pixels less kMiddleGrey, one per 16-bit lane: flipping the highest bit makes them signed.
template <class D>
HWY_INLINE HWY_ATTR Vec<D> about_middle(D d, const std::uint8_t* pixels) {
  const hn::Rebind<std::uint8_t, D> d8;
  const auto flipped = hn::Xor(hn::LoadU(d8, pixels), hn::Set(d8, std::uint8_t{0x80}));
  return hn::PromoteTo(d, hn::BitCast(hn::Rebind<std::int8_t, D>(), flipped));
}

/// SUM over pairs of lanes of a * weight, in 64 bits. The sum of two neighbours must fit 32 bits
/// where all weights are equal.
template <class D>
HWY_INLINE HWY_ATTR auto weighted_sum(D d, Vec<D> a, std::int32_t weight) {
  const hn::Repartition<std::uint64_t, D> d64;
  const hn::Repartition<std::uint32_t, D> du;
  const auto pairs = hn::BitCast(d64, a);
  const auto sums = hn::Add(hn::BitCast(du, pairs), hn::BitCast(du, hn::ShiftRight<32>(pairs)));
  (void)d;
  return hn::MulEven(sums, hn::Set(du, static_cast<std::uint32_t>(weight)));
}

/// The same with a weight for each lane.
template <class D>
HWY_INLINE HWY_ATTR auto weighted_sum(D d, Vec<D> a, Vec<D> weights) {
  const hn::Repartition<std::uint64_t, D> d64;
  const hn::Repartition<std::uint32_t, D> du;
  const auto odd = [&](Vec<D> v) FATHOM_LAMBDA {
    return hn::BitCast(du, hn::ShiftRight<32>(hn::BitCast(d64, v)));
  };
  (void)d;
  return hn::Add(hn::MulEven(hn::BitCast(du, a), hn::BitCast(du, weights)),
                 hn::MulEven(odd(a), odd(weights)));
}

/// [row][col] of Plan::spectrum for coefficient (i, j) by position; T(0, 0) gets back what the
/// pixels lost.
void place_coefficient(const WalshTables& constants, int i, int j, std::int64_t t,
                       std::span<std::complex<double>> coefficients) {
  const int n = static_cast<int>(constants.index.size());
  const std::int64_t pixels = std::int64_t{n} * n;
  if (i == 0 && j == 0) t += kMiddleGrey * pixels;
  coefficients[static_cast<std::size_t>(constants.index[i]) * n + constants.index[j]] =
      static_cast<double>(t) / static_cast<double>(pixels);
}

// ------------------------------------------------------------------------- N = 32 .. 512

template <int N>
class IntegerStrips {
  using D16 = hn::CappedTag<std::int16_t, 32>;
  using D32 = hn::CappedTag<std::int32_t, 16>;
  static constexpr int L16 = kLanes<D16>;
  static constexpr int L32 = kLanes<D32>;
  static constexpr int kBits = std::countr_zero(static_cast<unsigned>(N));

  /// A column of 512 pixels would need nine stages: its halves are transformed by themselves, and
  /// `rows` does the ninth.
  static constexpr int kParts = N > 256 ? 2 : 1;
  static constexpr int kTall = N / kParts;
  /// Stages over the low bits of x that 16 bits still hold.
  static constexpr int kNarrowStages = N < 256 ? 8 - kBits : 0;
  /// What is left for 32 bits: this many transforms, each over every kClasses-th column.
  static constexpr int kClasses = 1 << kNarrowStages;
  static constexpr int kLong = N / kClasses;
  static constexpr int kStrips = N / L32;

  struct Scratch {
    alignas(64) std::int16_t column[kTall * L16];
    alignas(64) std::int16_t turned[kParts][N][kTall];  ///< [half of y][x or j][i].
    alignas(64) std::int32_t row[kLong * L32];
    alignas(64) std::int32_t column_sums[kLong * L32];  ///< [j of a class][lane], over strips.
    alignas(64) std::int32_t row_sums[N];               ///< [i].
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void score(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> scores,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(WindowPixels<std::uint8_t>(frame, windows[w]), memory);
      const std::uint64_t sum = tables.walsh->mask.empty() ? moment<false>(*tables.walsh, memory)
                                                           : moment<true>(*tables.walsh, memory);
      scores[w] = exact_score(sum, N);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    columns(WindowPixels<std::uint8_t>(frame, window), memory);
    for (int c = 0; c < kClasses; ++c) {
      for (int strip = 0; strip < kStrips; ++strip) {
        transform_rows(c, strip, memory, [&](int p, const auto& t) HWY_ATTR {
          for (int r = 0; r < static_cast<int>(std::size(t)); ++r) {
            alignas(64) std::int32_t lanes[L32];
            hn::Store(t[r], D32(), lanes);
            for (int lane = 0; lane < L32; ++lane) {
              place_coefficient(*tables.walsh, strip * L32 + lane, c + (p + r) * kClasses,
                                lanes[lane], coefficients);
            }
          }
        });
      }
    }
  }

 private:
  static HWY_NOINLINE HWY_ATTR void columns(const WindowPixels<std::uint8_t>& pixels,
                                            Scratch& memory) {
    const D16 d;
    for (int part = 0; part < kParts; ++part) {
      for (int x = 0; x < N; x += L16) {
        wht<kTall>(
            d, memory.column,
            [&](int y) FATHOM_LAMBDA {
              return about_middle(
                  d, reinterpret_cast<const std::uint8_t*>(pixels.at(x, part * kTall + y)));
            },
            [&](int i, auto& t) FATHOM_LAMBDA { turn_group(t, x, i, memory.turned[part]); });
      }
    }
  }

  /// Eight rows i of as many columns x as there are lanes: swap them, and go on over the low bits
  /// of x while 16 bits suffice.
  static HWY_INLINE HWY_ATTR void turn_group(Vec<D16> (&t)[8], int x, int i,
                                             std::int16_t (*HWY_RESTRICT turned)[kTall]) {
    const D16 d;
    turn_step<std::uint16_t, 8, 1>(d, t);
    turn_step<std::uint32_t, 8, 2>(d, t);
    turn_step<std::uint64_t, 8, 4>(d, t);
    // Register r now holds, in block b of 8 lanes, rows i .. i+7 of column x + 8 b + r reversed:
    // its highest bit is the lowest bit of x.
    if constexpr (kNarrowStages >= 1) stage<4>(t);
    if constexpr (kNarrowStages >= 2) stage<2>(t);
    if constexpr (kNarrowStages >= 3) stage<1>(t);
    unroll<8>([&](auto r) FATHOM_LAMBDA {
      constexpr int column = (r & 1) << 2 | (r & 2) | (r & 4) >> 2;
      store_blocks(d, t[r], &turned[x + column][i]);
    });
  }

  template <int kDistance>
  static HWY_INLINE HWY_ATTR void stage(Vec<D16> (&t)[8]) {
    unroll<4>([&](auto pair) FATHOM_LAMBDA {
      constexpr int r = pair / kDistance * 2 * kDistance + pair % kDistance;
      const auto a = t[r], b = t[r + kDistance];
      t[r] = hn::Add(a, b);
      t[r + kDistance] = hn::Sub(a, b);
    });
  }

  /// Blocks of eight lanes, each eight columns further.
  template <class D>
  static HWY_INLINE HWY_ATTR void store_blocks(D d, Vec<D> v, std::int16_t* HWY_RESTRICT out) {
    if constexpr (kLanes<D> == 8) {
      hn::Store(v, d, out);
    } else {
      const hn::Half<D> half;
      store_blocks(half, hn::LowerHalf(half, v), out);
      store_blocks(half, hn::UpperHalf(half, v), out + kLanes<D> / 2 * kTall);
    }
  }

  /// Coefficients (i, j) of the lanes i of a strip and the class' j = c + kClasses p.
  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_rows(int c, int strip, Scratch& memory,
                                                 const Consume& consume) {
    const D32 d;
    const hn::Rebind<std::int16_t, D32> d16;
    const int i = strip * L32;
    const auto half = [&](int part, int q) FATHOM_LAMBDA {
      const int column = c + q * kClasses;
      return hn::PromoteTo(d, hn::Load(d16, &memory.turned[part][column][i % kTall]));
    };
    wht<kLong>(
        d, memory.row,
        [&](int q) FATHOM_LAMBDA {
          if constexpr (kParts == 1) {
            return half(0, q);
          } else {
            return i < kTall ? hn::Add(half(0, q), half(1, q)) : hn::Sub(half(0, q), half(1, q));
          }
        },
        consume);
  }

  /// SUM |T| (i^2 + j^2). Sums of magnitudes along a row or a column stay below 2^30 (by
  /// Cauchy-Schwarz and Parseval at most sqrt(N) 128 N^2), products with lever arms need 64 bits.
  template <bool kHasBand>
  static HWY_NOINLINE HWY_ATTR std::uint64_t moment(const WalshTables& constants, Scratch& memory) {
    const D32 d;
    const hn::Repartition<std::uint64_t, D32> d64;
    auto total = hn::Zero(d64);
    for (int c = 0; c < kClasses; ++c) {
      for (int strip = 0; strip < kStrips; ++strip) {
        const int i = strip * L32;
        auto row_sum = c == 0 ? hn::Zero(d) : hn::Load(d, memory.row_sums + i);
        transform_rows(c, strip, memory, [&](int p, const auto& t) FATHOM_LAMBDA {
          constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
          std::int32_t* HWY_RESTRICT const column_sums = memory.column_sums + p * L32;
          unroll<count>([&](auto r) FATHOM_LAMBDA {
            auto mass = hn::Abs(t[r]);
            if constexpr (kHasBand) {
              const int j = c + (p + r) * kClasses;
              mass = hn::And(mass, hn::LoadU(d, constants.mask.data() + j * N + i));
            }
            row_sum = hn::Add(row_sum, mass);
            std::int32_t* const column_sum = column_sums + r * L32;
            hn::Store(strip == 0 ? mass : hn::Add(mass, hn::Load(d, column_sum)), d, column_sum);
          });
        });
        hn::Store(row_sum, d, memory.row_sums + i);
      }
      for (int p = 0; p < kLong; ++p) {
        const auto column_sum = hn::Load(d, memory.column_sums + p * L32);
        total = hn::Add(total, weighted_sum(d, column_sum, constants.arm[c + p * kClasses]));
      }
    }
    for (int i = 0; i < N; i += L32) {
      total = hn::Add(total, weighted_sum(d, hn::Load(d, memory.row_sums + i),
                                          hn::LoadU(d, constants.arm.data() + i)));
    }
    return hn::GetLane(hn::SumOfLanes(d64, total));
  }
};

// ---------------------------------------------------------------------------- N = 8 and 16

template <int N>
class IntegerBlock {
  using D32 = hn::CappedTag<std::int32_t, 16>;
  using D16 = hn::Rebind<std::int16_t, D32>;
  static constexpr int L = kLanes<D32>;

  struct Scratch {
    alignas(64) std::uint8_t pixels[N][N][kBlock];
    alignas(64) std::int16_t columns[N][N * L];  ///< [j][y].
    alignas(64) std::int32_t sums[kBlock];
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void score(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> scores,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    for (std::size_t first = 0; first < windows.size(); first += L) {
      rows(static_cast<int>(first), memory);
      hn::Store(moment(*tables.walsh, memory), D32(), memory.sums + first);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      scores[w] = exact_score(static_cast<std::uint64_t>(memory.sums[w]), N);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, {&window, 1}, &memory.pixels[0][0][0]);
    rows(0, memory);
    for (int j = 0; j < N; ++j) {
      transform_column(j, memory, [&](int i, const auto& t) HWY_ATTR {
        for (int r = 0; r < static_cast<int>(std::size(t)); ++r) {
          place_coefficient(*tables.walsh, i + r, j, hn::GetLane(t[r]), coefficients);
        }
      });
    }
  }

 private:
  static HWY_NOINLINE HWY_ATTR void rows(int first, Scratch& memory) {
    const D16 d;
    for (int y = 0; y < N; ++y) {
      wht<N>(
          d, nullptr,
          [&](int x) FATHOM_LAMBDA { return about_middle(d, memory.pixels[y][x] + first); },
          [&](int j, const auto& t) FATHOM_LAMBDA {
            unroll<N>([&](auto r)
                          FATHOM_LAMBDA { hn::Store(t[r], d, memory.columns[j + r] + y * L); });
          });
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(int j, Scratch& memory, const Consume& consume) {
    const D16 d;
    wht<N>(
        d, nullptr, [&](int y) FATHOM_LAMBDA { return hn::Load(d, memory.columns[j] + y * L); },
        consume);
  }

  /// SUM |T| (i^2 + j^2) per lane, below 0.79 * 128 * 16^5 < 2^27. |T| <= 127.5 N^2 fits 16 bits
  /// but for T(0, 0) = -2^15, which has no lever arm.
  static HWY_NOINLINE HWY_ATTR Vec<D32> moment(const WalshTables& constants, Scratch& memory) {
    const D32 d;
    auto sum = hn::Zero(d);
    const bool has_band = !constants.mask.empty();
    for (int j = 0; j < N; ++j) {
      transform_column(j, memory, [&](int i, const auto& t) FATHOM_LAMBDA {
        unroll<N>([&](auto r) FATHOM_LAMBDA {
          std::int32_t weight = constants.arm[i + r] + constants.arm[j];
          if (has_band) weight &= constants.mask[j * N + i + r];
          const auto mass = hn::PromoteTo(d, hn::Abs(t[r]));
          sum = hn::Add(sum, hn::Mul(mass, hn::Set(d, weight)));
        });
      });
    }
    return sum;
  }
};

template <int N>
Kernel kernel_of() {
  using Implementation = std::conditional_t<(N < 32), IntegerBlock<N>, IntegerStrips<N>>;
  return {&Implementation::score, &Implementation::spectrum, Implementation::kScratchBytes};
}

}  // namespace

Kernel exact_walsh_kernel(const MetricSpec& spec) {
  switch (spec.n) {
    case 8:
      return kernel_of<8>();
    case 16:
      return kernel_of<16>();
    case 32:
      return kernel_of<32>();
    case 64:
      return kernel_of<64>();
    case 128:
      return kernel_of<128>();
    case 256:
      return kernel_of<256>();
    default:
      return kernel_of<512>();
  }
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
