// SPDX-License-Identifier: Apache-2.0
// Walsh measures of 8-bit windows of 128 and more, one at a time:
//
//   columns  lanes = x: over y, in 16 bits; 8 rows by 8 columns turn in registers, and what is left
//            of the eight stages that 16 bits hold goes over the low bits of x.
//   rows     lanes = i: over the other bits of x, in 32 bits. Magnitudes, sums by row and by
//            column, each with its lever arm at the end.
#if defined(FATHOM_CPU_WALSH_INTEGER_STRIPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_INTEGER_STRIPS_INL_H_
#undef FATHOM_CPU_WALSH_INTEGER_STRIPS_INL_H_
#else
#define FATHOM_CPU_WALSH_INTEGER_STRIPS_INL_H_
#endif

#include <bit>

#include "backends/cpu/walsh_integer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N>
class IntegerStrips {
  using D16 = hn::CappedTag<std::int16_t, 32>;
  using D32 = hn::CappedTag<std::int32_t, 16>;
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
  static constexpr int kStrips = N / kLanes<D32>;

  struct Scratch {
    alignas(64) std::uint8_t pixels[kTall][N + 64];  ///< Of one half of y.
    alignas(64) std::int16_t column[kTall * kLanes<D16>];
    /// [half of y][i / 8][place of x][i % 8]: what eight rows give is stored as it is.
    alignas(64) std::int16_t turned[kParts][kTall / 8][N][8];
    alignas(64) std::int32_t row[kLong * kLanes<D32>];
    alignas(64) std::int32_t
        column_sums[kLong * kLanes<D32>];  ///< [j of a class][lane], over strips.
    alignas(64) std::int32_t row_sums[N];  ///< [i].
    /// Of rings: |T| of a strip of rows i, by sequency of the column; then their running sums.
    alignas(64) std::int32_t lines[N + 1][kLanes<D32>];
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
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

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const int count = tables.rings->count;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(WindowPixels<std::uint8_t>(frame, windows[w]), memory);
      std::uint64_t within[kMostRings + 1] = {};
      sum_rings(tables, within, memory);
      ring_means(*tables.rings, within, N, &values[w * count]);
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
            alignas(64) std::int32_t lanes[kLanes<D32>];
            hn::Store(t[r], D32(), lanes);
            for (int lane = 0; lane < kLanes<D32>; ++lane) {
              place_coefficient(*tables.walsh, strip * kLanes<D32> + lane, c + (p + r) * kClasses,
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
    // Rows of a picture often lie a power of two apart, where the cache keeps few of them at a
    // time: a copy with a better distance costs less than fetching each line for every strip.
    for (int part = 0; part < kParts; ++part) {
      for (int y = 0; y < kTall; ++y) {
        std::memcpy(memory.pixels[y], pixels.at(0, part * kTall + y), N);
      }
      for (int x = 0; x < N; x += kLanes<D16>) {
        wht<kTall>(
            d, memory.column,
            [&](int y) FATHOM_LAMBDA { return about_middle(d, &memory.pixels[y][x]); },
            [&](int i, auto& t) FATHOM_LAMBDA { turn_group(t, x, memory.turned[part][i / 8]); });
      }
    }
  }

  /// Eight rows i of as many columns x as there are lanes: swap them, and go on over the low bits
  /// of x while 16 bits suffice.
  static HWY_INLINE HWY_ATTR void turn_group(Vec<D16> (&t)[8], int x,
                                             std::int16_t (*HWY_RESTRICT turned)[8]) {
    const D16 d;
    turn_step<std::uint16_t, 8, 1>(d, t);
    turn_step<std::uint32_t, 8, 2>(d, t);
    turn_step<std::uint64_t, 8, 4>(d, t);
    // Register r now holds, in block b of 8 lanes, rows i .. i+7 of column x + 8 b + r reversed:
    // its highest bit is the lowest bit of x.
    if constexpr (kNarrowStages >= 1) wht_stage<4>(d, t);
    if constexpr (kNarrowStages >= 2) wht_stage<2>(d, t);
    if constexpr (kNarrowStages >= 3) wht_stage<1>(d, t);
    unroll<8>([&](auto r)
                  FATHOM_LAMBDA { hn::Store(t[r], d, turned[place(x + reversed_bits(r, 3))]); });
  }

  /// Where column x lies: columns eight apart, which share a register above, are neighbours.
  static constexpr int place(int x) { return x % 8 * (N / 8) + x / 8; }

  /// Coefficients (i, j) of the lanes i of a strip and the class' j = c + kClasses p.
  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_rows(int c, int strip, Scratch& memory,
                                                 const Consume& consume) {
    const D32 d;
    const int i = strip * kLanes<D32>;
    const auto half = [&](int part, int q) FATHOM_LAMBDA {
      const int x = place(c + q * kClasses);
      const hn::Rebind<std::int16_t, D32> d16;
      if constexpr (kLanes<D32> <= 8) {
        return hn::PromoteTo(d, hn::Load(d16, memory.turned[part][i % kTall / 8][x] + i % 8));
      } else {
        const hn::Half<decltype(d16)> d_half;
        return hn::PromoteTo(
            d, hn::Combine(d16, hn::Load(d_half, memory.turned[part][i % kTall / 8 + 1][x]),
                           hn::Load(d_half, memory.turned[part][i % kTall / 8][x])));
      }
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
    const std::int32_t* HWY_RESTRICT arm = constants.arm.data();
    for (int c = 0; c < kClasses; ++c) {
      for (int strip = 0; strip < kStrips; ++strip) {
        const int i = strip * kLanes<D32>;
        auto row_sum = c == 0 ? hn::Zero(d) : hn::Load(d, memory.row_sums + i);
        transform_rows(c, strip, memory, [&](int p, const auto& t) FATHOM_LAMBDA {
          constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
          std::int32_t* HWY_RESTRICT const column_sums = memory.column_sums + p * kLanes<D32>;
          unroll<count>([&](auto r) FATHOM_LAMBDA {
            auto mass = hn::Abs(t[r]);
            if constexpr (kHasBand) {
              const int j = c + (p + r) * kClasses;
              mass = hn::And(mass, hn::LoadU(d, constants.mask.data() + j * N + i));
            }
            row_sum = hn::Add(row_sum, mass);
            std::int32_t* const column_sum = column_sums + r * kLanes<D32>;
            hn::Store(strip == 0 ? mass : hn::Add(mass, hn::Load(d, column_sum)), d, column_sum);
          });
        });
        hn::Store(row_sum, d, memory.row_sums + i);
      }
      for (int p = 0; p < kLong; ++p) {
        const auto column_sum = hn::Load(d, memory.column_sums + p * kLanes<D32>);
        total = hn::Add(total, weighted_sum(d, column_sum, arm[c + p * kClasses]));
      }
    }
    for (int i = 0; i < N; i += kLanes<D32>) {
      total =
          hn::Add(total, weighted_sum(d, hn::Load(d, memory.row_sums + i), hn::LoadU(d, arm + i)));
    }
    return hn::GetLane(hn::SumOfLanes(d64, total));
  }

  /// Sums of |T| within each edge of a ring. Those of a row are below 2^30, as above.
  static HWY_NOINLINE HWY_ATTR void sum_rings(const Tables& tables, std::uint64_t* within,
                                              Scratch& memory) {
    const D32 d;
    const int* HWY_RESTRICT const index = tables.walsh->index.data();
    for (int strip = 0; strip < kStrips; ++strip) {
      for (int c = 0; c < kClasses; ++c) {
        transform_rows(c, strip, memory, [&](int p, const auto& t) FATHOM_LAMBDA {
          unroll<std::extent_v<std::remove_reference_t<decltype(t)>>>([&](auto r) FATHOM_LAMBDA {
            hn::Store(hn::Abs(t[r]), d, memory.lines[index[c + (p + r) * kClasses]]);
          });
        });
      }
      add_up_lines(memory);
      add_lines_within(*tables.sequency_rings, strip * kLanes<D32>, within, memory);
    }
  }

  /// Makes line j the sum of lines 0 .. j-1.
  static HWY_INLINE HWY_ATTR void add_up_lines(Scratch& memory) {
    const D32 d;
    auto sum = hn::Zero(d);
    for (int j = 0; j < N; ++j) {
      const auto next = hn::Add(sum, hn::Load(d, memory.lines[j]));
      hn::Store(sum, d, memory.lines[j]);
      sum = next;
    }
    hn::Store(sum, d, memory.lines[N]);
  }

  /// Adds to each edge what the rows i, i+1, .. in the lanes have within it.
  static HWY_INLINE void add_lines_within(const SequencyRings& rings, int i,
                                          std::uint64_t* HWY_RESTRICT within,
                                          const Scratch& memory) {
    for (int edge = 0; edge < rings.edges; ++edge) {
      const std::int32_t* HWY_RESTRICT const start = rings.start.data() + edge * N + i;
      std::uint64_t sum = 0;
      for (int lane = 0; lane < kLanes<D32>; ++lane) {
        sum += static_cast<std::uint32_t>(memory.lines[start[lane]][lane]);
      }
      within[edge] += sum;
    }
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
