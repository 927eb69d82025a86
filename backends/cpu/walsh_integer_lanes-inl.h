// SPDX-License-Identifier: Apache-2.0
// Walsh measures of 8-bit windows of 8 and 16, up to sixteen at a time, lanes = windows: rows,
// columns and magnitudes, all in 16 bits.
#if defined(FATHOM_CPU_WALSH_INTEGER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_INTEGER_LANES_INL_H_
#undef FATHOM_CPU_WALSH_INTEGER_LANES_INL_H_
#else
#define FATHOM_CPU_WALSH_INTEGER_LANES_INL_H_
#endif

#include "backends/cpu/walsh_integer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N>
class IntegerLanes {
  using D32 = hn::CappedTag<std::int32_t, 16>;
  using D16 = hn::Rebind<std::int16_t, D32>;

  struct Scratch {
    alignas(64) std::uint8_t pixels[N][N][kBlock];
    alignas(64) std::int16_t columns[N][N * kLanes<D32>];  ///< [j][y].
    alignas(64) std::int32_t sums[kBlock];
    alignas(64) std::int32_t ring_sums[kMostRings + 1][kBlock];  ///< The last: outside of all.
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D32>) {
      rows(static_cast<int>(first), memory);
      hn::Store(moment(*tables.walsh, memory), D32(), memory.sums + first);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      scores[w] = exact_score(static_cast<std::uint64_t>(memory.sums[w]), N);
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const std::size_t count = tables.rings->coefficients.size();
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    std::memset(memory.ring_sums, 0, sizeof memory.ring_sums);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D32>) {
      rows(static_cast<int>(first), memory);
      add_to_rings(*tables.rings, first, memory);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      for (std::size_t k = 0; k < count; ++k) {
        const auto sum = static_cast<std::uint64_t>(memory.ring_sums[k][w]);
        values[w * count + k] = exact_mean(sum, tables.rings->coefficients[k], N);
      }
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
            unroll<N>([&](auto r) FATHOM_LAMBDA {
              hn::Store(t[r], d, memory.columns[j + r] + y * kLanes<D32>);
            });
          });
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(int j, Scratch& memory, const Consume& consume) {
    const D16 d;
    wht<N>(
        d, nullptr,
        [&](int y) FATHOM_LAMBDA { return hn::Load(d, memory.columns[j] + y * kLanes<D32>); },
        consume);
  }

  /// SUM |T| (i^2 + j^2) per lane, below sqrt(28/45) 128 N^5 < 0.79 * 128 * 16^5 < 2^27
  /// (docs/metrics.md, "Why Walsh scores are exact": 2/5 + 2/9 = 28/45). |T| <= 127.5 N^2 fits 16
  /// bits but for T(0, 0) = -2^15, which has no lever arm.
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

  /// Adds every |T| to its ring's sum: by Cauchy-Schwarz and Parseval at most N 128 N^2 < 2^20.
  static HWY_NOINLINE HWY_ATTR void add_to_rings(const RingTables& rings, std::size_t first,
                                                 Scratch& memory) {
    const D32 d;
    for (int j = 0; j < N; ++j) {
      const std::uint8_t* HWY_RESTRICT const slot = rings.slot.data() + j * N;
      transform_column(j, memory, [&](int i, const auto& t) FATHOM_LAMBDA {
        unroll<N>([&](auto r) FATHOM_LAMBDA {
          std::int32_t* const sum = memory.ring_sums[slot[i + r]] + first;
          const auto mass = hn::PromoteTo(d, hn::Abs(t[r]));
          hn::Store(hn::Add(hn::Load(d, sum), mass), d, sum);
        });
      });
    }
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
