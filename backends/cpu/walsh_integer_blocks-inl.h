// SPDX-License-Identifier: Apache-2.0
// Walsh measures of 8-bit windows of 32 and 64: every 128-bit block of a register is a window of
// its own, so that a stage over lanes never crosses blocks.
//
// Of the 2 log2 N stages, eight fit 16 bits. What the bits of a column's number x mean, and the
// stage that goes over each (stages 2 .. go over y: 5 for N = 32, 6 for N = 64):
//
//   bit    where it is                           N = 32              N = 64
//   x0     neighbouring pixels of a chunk        1, 8 to 16 bits     1, 8 to 16 bits
//   x1     neighbouring lanes                    9, 16 to 32 bits    9, 16 to 32 bits
//   x2     lanes; registers after the turn       7                   8
//   x3     lanes; registers after the turn       8                   10, in 32 bits
//   x4 ..  chunks of 16 pixels                   10, in 32 bits      11, 12, in 32 bits
//
// A class is a set of columns that agree in the bits done before the widening to 32 bits, x0 x2 x3
// or x0 x2; the points of its transform are the other bits but x1: the chunk, and x3 if N = 64.
//
// Pixels come without a sign, 0 .. 255. Their sums after the stages over x0 and y are at most
// 255 * 2 * 64 = 32640 < 2^15, so that they fit; those of one more stage would not, 65280. Then the
// middle, 128 * 2 * N, comes off the only row that has no differences in it, i = 0 and x0 = 0, and
// all is within 128 * 2^7 in magnitude, after eight stages within -2^15 .. 127.5 * 2^8.
#if defined(FATHOM_CPU_WALSH_INTEGER_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_INTEGER_BLOCKS_INL_H_
#undef FATHOM_CPU_WALSH_INTEGER_BLOCKS_INL_H_
#else
#define FATHOM_CPU_WALSH_INTEGER_BLOCKS_INL_H_
#endif

#include <algorithm>

#include "backends/cpu/walsh_integer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// Magnitudes' sums along a row or a column stay below 2^23 (by Cauchy-Schwarz and Parseval at most
/// sqrt(N) 128 N^2), products with lever arms need 64 bits.
template <int N>
class IntegerBlocks {
  static constexpr int kChunks = N / 16;    ///< Of 16 pixels, in a row.
  static constexpr int kClasses = 256 / N;  ///< Sets of columns whose narrow stages are done: the
                                            ///< bits of x that they share.
  static constexpr int kPoints = N / 2 / kClasses;  ///< Pairs of columns in a class.
  static constexpr int kMostWindows =
      static_cast<int>(hn::MaxLanes(hn::CappedTag<std::int16_t, 32>())) / 8;

  template <int kWindows>
  struct Group {
    using D16 = hn::FixedTag<std::int16_t, 8 * kWindows>;
    using D32 = hn::FixedTag<std::int32_t, 4 * kWindows>;

    struct Scratch {
      /// Of a chunk and the lowest bit of x, row by row; the odd size spreads them in the cache.
      alignas(64) std::int16_t columns[kChunks][2][N + 1][kLanes<D16>];
      /// Of those, eight rows i, turned: [i / 4][x2][x3], each block four rows i of two columns.
      alignas(64) std::int16_t turned[kChunks][2][8][kLanes<D16>];
      alignas(64) std::int32_t column_sums[kClasses][2 * kPoints][kLanes<D32>];
      alignas(64) std::uint64_t totals[kLanes<D32> / 2];
      /// Of rings: |T| of two quads of rows i, by sequency of the column; then their running sums.
      alignas(64) std::int32_t lines[N + 1][2][kLanes<D32>];
      alignas(64) std::int32_t within[kMostRings + 1][kLanes<D32>];  ///< Each edge.
    };
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(typename Group<kMostWindows>::Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    by_groups(windows, scores, [&](auto size, auto group, double* out) HWY_ATTR {
      moments_of_group<size>(tables, frame, group, out, scratch);
    });
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    by_groups(windows, values, [&](auto size, auto group, double* out) HWY_ATTR {
      rings_of_group<size>(tables, frame, group, out, scratch);
    });
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<typename Group<1>::Scratch*>(scratch);
    begin_columns<1>(frame, {&window, 1}, memory);
    for (int quad = 0; quad < N / 4; ++quad) {
      if (quad % 2 == 0) finish_rows<1>(4 * quad, memory);
      for (int c = 0; c < kClasses; ++c) {
        hn::Vec<typename Group<1>::D32> even[kPoints], odd[kPoints];
        transform_rows<1, 0>(quad, c, memory, even);
        transform_rows<1, 1>(quad, c, memory, odd);
        for (int r = 0; r < 2 * kPoints; ++r) {
          alignas(16) std::int32_t lanes[4];
          hn::Store(r < kPoints ? even[r] : odd[r - kPoints], typename Group<1>::D32(), lanes);
          for (int lane = 0; lane < 4; ++lane) {
            place_coefficient(*tables.walsh, 4 * quad + lane, coefficient(c, r), lanes[lane],
                              coefficients);
          }
        }
      }
    }
  }

 private:
  /// body(windows of a register, windows, where their values go), group by group.
  template <class Body>
  static HWY_INLINE HWY_ATTR void by_groups(std::span<const Window> windows,
                                            std::span<double> values, const Body& body) {
    const std::size_t outputs = values.size() / windows.size();
    for (std::size_t first = 0; first < windows.size(); first += kMostWindows) {
      const std::size_t count = std::min<std::size_t>(kMostWindows, windows.size() - first);
      double* const out = &values[first * outputs];
      if (count == 1) {  // alone in a wide register it would cost as much as a full one
        body(std::integral_constant<int, 1>(), windows.subspan(first, 1), out);
      } else {
        body(std::integral_constant<int, kMostWindows>(), windows.subspan(first, count), out);
      }
    }
  }

  template <int kWindows>
  static HWY_INLINE HWY_ATTR void moments_of_group(const Tables& tables, const Frame& frame,
                                                   std::span<const Window> windows, double* scores,
                                                   std::byte* scratch) {
    auto& memory = *reinterpret_cast<typename Group<kWindows>::Scratch*>(scratch);
    begin_columns<kWindows>(frame, windows, memory);
    if (tables.walsh->mask.empty()) {
      sum_moments<kWindows, false>(*tables.walsh, memory);
    } else {
      sum_moments<kWindows, true>(*tables.walsh, memory);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      scores[w] = exact_score(memory.totals[2 * w] + memory.totals[2 * w + 1], N);
    }
  }

  template <int kWindows>
  static HWY_INLINE HWY_ATTR void rings_of_group(const Tables& tables, const Frame& frame,
                                                 std::span<const Window> windows, double* values,
                                                 std::byte* scratch) {
    auto& memory = *reinterpret_cast<typename Group<kWindows>::Scratch*>(scratch);
    const int count = tables.rings->count;
    begin_columns<kWindows>(frame, windows, memory);
    sum_rings<kWindows>(tables, memory);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      std::uint32_t within[kMostRings + 1] = {};  // below 2^32: see sum_rings
      for (int edge = 0; edge <= count; ++edge) {
        for (int lane = 0; lane < 4; ++lane) {
          within[edge] += static_cast<std::uint32_t>(memory.within[edge][4 * w + lane]);
        }
      }
      ring_means(*tables.rings, within, N, values + w * count);
    }
  }

  /// 16 pixels of each window, one window a block.
  template <int kWindows>
  static HWY_INLINE HWY_ATTR auto load_blocks(const std::byte* const* rows, std::ptrdiff_t offset) {
    const hn::FixedTag<std::uint8_t, 16 * kWindows> d;
    if constexpr (kWindows == 1) {
      return hn::LoadU(d, reinterpret_cast<const std::uint8_t*>(rows[0] + offset));
    } else {
      return hn::Combine(d, load_blocks<kWindows / 2>(rows + kWindows / 2, offset),
                         load_blocks<kWindows / 2>(rows, offset));
    }
  }

  /// Over the lowest bit of x and, by eights, over y; each row of pixels is read once from end to
  /// end, for rows of a picture often lie a power of two apart, where the cache keeps few of them.
  template <int kWindows>
  static HWY_NOINLINE HWY_ATTR void begin_columns(const Frame& frame,
                                                  std::span<const Window> windows,
                                                  typename Group<kWindows>::Scratch& memory) {
    const typename Group<kWindows>::D16 d;
    constexpr int step = N / 8;
    const std::byte* origins[kWindows];
    for (std::size_t w = 0; w < kWindows; ++w) {
      const Window& window = windows[w < windows.size() ? w : 0];
      origins[w] = WindowPixels<std::uint8_t>(frame, window).at(0, 0);
    }
    const auto stride = static_cast<std::ptrdiff_t>(frame.stride_bytes());
    for (int s = 0; s < step; ++s) {
      for (int chunk = 0; chunk < kChunks; ++chunk) {
        Vec<decltype(d)> even[8], odd[8];
        unroll<8>([&](auto r) FATHOM_LAMBDA {
          const auto pixels = load_blocks<kWindows>(origins, (s + r * step) * stride + 16 * chunk);
          const auto pair = pair_up_pixels(d, pixels);
          even[r] = pair.sum, odd[r] = pair.difference;
        });
        small_wht<8>(d, even);
        small_wht<8>(d, odd);
        unroll<8>([&](auto r) FATHOM_LAMBDA {
          hn::Store(even[r], d, memory.columns[chunk][0][s + r * step]);
          hn::Store(odd[r], d, memory.columns[chunk][1][s + r * step]);
        });
      }
    }
  }

  /// Rows i .. i+7: the other stages over y; turned; over those bits of x that 16 bits still hold.
  template <int kWindows>
  static HWY_INLINE HWY_ATTR void finish_rows(int i, typename Group<kWindows>::Scratch& memory) {
    const typename Group<kWindows>::D16 d;
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      for (int x0 = 0; x0 < 2; ++x0) {
        Vec<decltype(d)> t[8];
        unroll<8>([&](auto r)
                      FATHOM_LAMBDA { t[r] = hn::Load(d, memory.columns[chunk][x0][i + r]); });
        finish_rows_of_eight(d, t);
        if (i == 0 &&
            x0 == 0) {  // the sums without a sign: the middle, before they outgrow 16 bits
          t[0] = hn::Sub(t[0], hn::Set(d, static_cast<std::int16_t>(kMiddleGrey * 2 * N)));
        }
        // Lanes are x3 x2 x1, registers i2 i1 i0; then lanes are i1 i0 x1, registers i2 x2 x3.
        turn_step<std::uint32_t, 8, 1>(d, t);
        turn_step<std::uint64_t, 8, 2>(d, t);
        wht_stage<2>(d, t);
        if constexpr (N == 32) wht_stage<1>(d, t);
        unroll<8>([&](auto r) FATHOM_LAMBDA { hn::Store(t[r], d, memory.turned[chunk][x0][r]); });
      }
    }
  }

  /// What an eight-row stage over rows N/8 apart leaves to do over eight neighbouring rows.
  template <class D>
  static HWY_INLINE HWY_ATTR void finish_rows_of_eight(D d, Vec<D> (&t)[8]) {
    if constexpr (N == 64) {
      small_wht<8>(d, t);
    } else {  // N = 32: over neighbouring four
      wht_stage<2>(d, t);
      wht_stage<1>(d, t);
    }
  }

  /// The Hadamard index j of register r of a class: the bits of x, each from its place.
  static constexpr int coefficient(int c, int r) {
    const int x1 = r / kPoints, point = r % kPoints;
    return N == 32 ? c % 2 + 2 * x1 + 4 * (c / 2) + 16 * point
                   : c % 2 + 2 * x1 + 4 * (c / 2) + 8 * point;
  }

  /// Coefficients (i, j) of four rows i, one a lane, and those columns j of a class that x1 names.
  template <int kWindows, int x1, class D32 = typename Group<kWindows>::D32>
  static HWY_INLINE HWY_ATTR void transform_rows(int quad, int c,
                                                 const typename Group<kWindows>::Scratch& memory,
                                                 Vec<D32> (&t)[kPoints]) {
    const D32 d;
    const typename Group<kWindows>::D16 d16;
    unroll<kPoints>([&](auto p) FATHOM_LAMBDA {
      // Class and point are the bits x0 x2 x3 of the columns, and their chunk.
      const int x0 = c % 2, x2 = c / 2 % 2;
      const int x3 = N == 32 ? c / 4 : p % 2, chunk = N == 32 ? p : p / 2;
      const auto* const columns = memory.turned[chunk][x0][4 * (quad % 2) + 2 * x2 + x3];
      const auto pair = pair_up(d, hn::Load(d16, columns));
      t[p] = x1 == 0 ? pair.sum : pair.difference;
    });
    small_wht<kPoints>(d, t);
  }

  /// Adds the magnitudes of eight rows and half a class of columns to the sums of both. Two rows of
  /// lanes at once, because stores are what a processor does least of.
  template <int kWindows, int x1, bool kHasBand, class D32 = typename Group<kWindows>::D32>
  static HWY_INLINE HWY_ATTR void add_magnitudes(const WalshTables& constants, int quad, int c,
                                                 typename Group<kWindows>::Scratch& memory,
                                                 Vec<D32> (&row_sums)[2]) {
    const D32 d;
    Vec<D32> upper[kPoints], lower[kPoints];
    transform_rows<kWindows, x1>(quad, c, memory, upper);
    transform_rows<kWindows, x1>(quad + 1, c, memory, lower);
    unroll<kPoints>([&](auto p) FATHOM_LAMBDA {
      auto above = hn::Abs(upper[p]), below = hn::Abs(lower[p]);
      if constexpr (kHasBand) {
        const std::int32_t* const mask =
            constants.mask.data() + coefficient(c, x1 * kPoints + p) * N + 4 * quad;
        above = hn::And(above, load_quad(d, mask));
        below = hn::And(below, load_quad(d, mask + 4));
      }
      row_sums[0] = hn::Add(row_sums[0], above);
      row_sums[1] = hn::Add(row_sums[1], below);
      std::int32_t* const column_sum = memory.column_sums[c][x1 * kPoints + p];
      hn::Store(hn::Add(hn::Load(d, column_sum), hn::Add(above, below)), d, column_sum);
    });
  }

  /// SUM |T| (i^2 + j^2) of every window, in two parts each.
  template <int kWindows, bool kHasBand>
  static HWY_NOINLINE HWY_ATTR void sum_moments(const WalshTables& constants,
                                                typename Group<kWindows>::Scratch& memory) {
    using D32 = typename Group<kWindows>::D32;
    const D32 d;
    const hn::Repartition<std::uint64_t, D32> d64;
    auto total = hn::Zero(d64);
    std::memset(memory.column_sums, 0, sizeof memory.column_sums);
    for (int quad = 0; quad < N / 4; quad += 2) {
      finish_rows<kWindows>(4 * quad, memory);
      hn::Vec<D32> row_sums[2] = {hn::Zero(d), hn::Zero(d)};
      for (int c = 0; c < kClasses; ++c) {
        add_magnitudes<kWindows, 0, kHasBand>(constants, quad, c, memory, row_sums);
        add_magnitudes<kWindows, 1, kHasBand>(constants, quad, c, memory, row_sums);
      }
      const std::int32_t* const arms = constants.arm.data() + 4 * quad;
      total = hn::Add(total, weighted_sum(d, row_sums[0], load_quad(d, arms)));
      total = hn::Add(total, weighted_sum(d, row_sums[1], load_quad(d, arms + 4)));
    }
    for (int c = 0; c < kClasses; ++c) {
      for (int r = 0; r < 2 * kPoints; ++r) {
        total = hn::Add(total, weighted_sum(d, hn::Load(d, memory.column_sums[c][r]),
                                            constants.arm[coefficient(c, r)]));
      }
    }
    hn::Store(total, d64, memory.totals);
  }

  /// Sums of |T| within each edge of a ring, per window in four lanes. All of a window's are below
  /// N 128 N^2 = 2^25, by Cauchy-Schwarz and Parseval.
  template <int kWindows>
  static HWY_NOINLINE HWY_ATTR void sum_rings(const Tables& tables,
                                              typename Group<kWindows>::Scratch& memory) {
    std::memset(memory.within, 0, sizeof memory.within);
    for (int quad = 0; quad < N / 4; quad += 2) {
      finish_rows<kWindows>(4 * quad, memory);
      for (int c = 0; c < kClasses; ++c) {
        store_magnitudes<kWindows, 0>(*tables.walsh, quad, c, memory);
        store_magnitudes<kWindows, 1>(*tables.walsh, quad, c, memory);
      }
      add_up_lines<kWindows>(memory);
      add_lines_within<kWindows>(*tables.sequency_rings, 4 * quad, memory);
    }
  }

  /// The magnitudes of eight rows and half a class of columns, where their sequency says.
  template <int kWindows, int x1, class D32 = typename Group<kWindows>::D32>
  static HWY_INLINE HWY_ATTR void store_magnitudes(const WalshTables& constants, int quad, int c,
                                                   typename Group<kWindows>::Scratch& memory) {
    const D32 d;
    const int* HWY_RESTRICT const index = constants.index.data();
    unroll<2>([&](auto half) FATHOM_LAMBDA {
      Vec<D32> t[kPoints];
      transform_rows<kWindows, x1>(quad + half, c, memory, t);
      unroll<kPoints>([&](auto p) FATHOM_LAMBDA {
        const int j = index[coefficient(c, x1 * kPoints + p)];
        hn::Store(hn::Abs(t[p]), d, memory.lines[j][half]);
      });
    });
  }

  /// Makes line j the sum of lines 0 .. j-1.
  template <int kWindows, class D32 = typename Group<kWindows>::D32>
  static HWY_INLINE HWY_ATTR void add_up_lines(typename Group<kWindows>::Scratch& memory) {
    const D32 d;
    Vec<D32> sum[2] = {hn::Zero(d), hn::Zero(d)};
    for (int j = 0; j < N; ++j) {
      unroll<2>([&](auto half) FATHOM_LAMBDA {
        std::int32_t* const line = memory.lines[j][half];
        const auto next = hn::Add(sum[half], hn::Load(d, line));
        hn::Store(sum[half], d, line);
        sum[half] = next;
      });
    }
    unroll<2>([&](auto half) FATHOM_LAMBDA { hn::Store(sum[half], d, memory.lines[N][half]); });
  }

  /// Adds to each edge what rows i .. i+7 have within it: each lane of a block from its own line.
  template <int kWindows, class D32 = typename Group<kWindows>::D32>
  static HWY_INLINE HWY_ATTR void add_lines_within(const SequencyRings& rings, int i,
                                                   typename Group<kWindows>::Scratch& memory) {
    const D32 d;
    const hn::Repartition<std::int64_t, D32> d64;
    for (int edge = 0; edge < rings.edges; ++edge) {
      const std::int32_t* HWY_RESTRICT const start = rings.start.data() + edge * N + i;
      auto sum = hn::Load(d, memory.within[edge]);
      unroll<2>([&](auto half) FATHOM_LAMBDA {
        const auto line = [&](int lane) FATHOM_LAMBDA {
          return hn::Load(d, memory.lines[start[4 * half + lane]][half]);
        };
        const auto first = hn::BitCast(d64, hn::OddEven(line(1), line(0)));
        const auto second = hn::BitCast(d64, hn::OddEven(line(3), line(2)));
        sum = hn::Add(sum, hn::BitCast(d, hn::OddEven(second, first)));
      });
      hn::Store(sum, d, memory.within[edge]);
    }
  }

  /// Four numbers, the same in every block.
  template <class D>
  static HWY_INLINE HWY_ATTR Vec<D> load_quad(D d, const std::int32_t* four) {
    alignas(16) std::int32_t copy[4];  // the table need not be aligned
    std::memcpy(copy, four, sizeof copy);
    return hn::LoadDup128(d, copy);
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
