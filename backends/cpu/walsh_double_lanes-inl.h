// SPDX-License-Identifier: Apache-2.0
// Walsh measures in double of windows of 8 and 16, up to sixteen at a time, lanes = windows.
#if defined(FATHOM_CPU_WALSH_DOUBLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_DOUBLE_LANES_INL_H_
#undef FATHOM_CPU_WALSH_DOUBLE_LANES_INL_H_
#else
#define FATHOM_CPU_WALSH_DOUBLE_LANES_INL_H_
#endif

#include "backends/cpu/walsh_double-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class Pixel>
class DoubleLanes {
  using D = hn::CappedTag<double, 8>;

  struct Scratch {
    alignas(64) Pixel pixels[N][N][kBlock];
    alignas(64) double row[N * kLanes<D>];
    alignas(64) double columns[N][N * kLanes<D>];  ///< [j][y].
    alignas(64) double sums[kBlock];
    alignas(64) double ring_sums[kMostRings + 1][kBlock];  ///< The last one: outside of all.
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(*tables.walsh, static_cast<int>(first), middle_of_range<Pixel>(tables, false), memory);
      moment(tables, memory.sums + first, memory);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      scores[w] = tables::moment_scale(tables.spec) * memory.sums[w];
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    std::memset(memory.ring_sums, 0, sizeof memory.ring_sums);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(*tables.walsh, static_cast<int>(first), middle_of_range<Pixel>(tables, false), memory);
      add_to_rings(tables, first, memory);
    }
    for (std::size_t w = 0; w < windows.size(); ++w) {
      ring_means(tables, &memory.ring_sums[0][w], kBlock, &values[w * tables.rings->count]);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    gather_block<N>(frame, {&window, 1}, &memory.pixels[0][0][0]);
    rows(*tables.walsh, 0, 0, memory);
    for (int j = 0; j < N; ++j) {
      transform_column(j, memory, [&](int i, const auto& t) HWY_ATTR {
        for (int r = 0; r < static_cast<int>(std::size(t)); ++r) {
          coefficient_at(*tables.walsh, i + r, j, coefficients) =
              hn::GetLane(t[r]) / (double{N} * N);
        }
      });
    }
  }

 private:
  static HWY_NOINLINE HWY_ATTR void rows(const WalshTables& constants, int first, double constant,
                                         Scratch& memory) {
    const D d;
    const double* HWY_RESTRICT taper = constants.taper.data();
    for (int y = 0; y < N; ++y) {
      wht<N>(
          d, memory.row,
          [&](int x) FATHOM_LAMBDA {
            const hn::Rebind<Pixel, D> d_pixel;
            const auto f =
                WindowPixels<Pixel>::widen(d, hn::Load(d_pixel, memory.pixels[y][x] + first));
            return hn::Mul(hn::Sub(f, hn::Set(d, constant)), hn::Set(d, taper[x] * taper[y]));
          },
          [&](int j, const auto& t) FATHOM_LAMBDA {
            unroll<std::extent_v<std::remove_reference_t<decltype(t)>>>([&](auto r) FATHOM_LAMBDA {
              hn::Store(t[r], d, memory.columns[j + r] + y * kLanes<D>);
            });
          });
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(int j, Scratch& memory, const Consume& consume) {
    double* const column = memory.columns[j];
    wht<N>(
        D(), column, [&](int y) FATHOM_LAMBDA { return hn::Load(D(), column + y * kLanes<D>); },
        consume);
  }

  /// Per lane. All sums are far below 2^53 at these sizes, so exact ones need no integers.
  static HWY_NOINLINE HWY_ATTR void moment(const Tables& tables, double* sums, Scratch& memory) {
    const D d;
    const WalshTables& constants = *tables.walsh;
    const bool power = tables.spec.power;
    const bool has_band = !constants.mask.empty();
    auto sum = hn::Zero(d);
    for (int j = 0; j < N; ++j) {
      transform_column(j, memory, [&](int i, const auto& t) FATHOM_LAMBDA {
        constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
        Vec<D> mass[count];
        walsh_masses<count, D>(t, power, mass);
        unroll<count>([&](auto r) FATHOM_LAMBDA {
          double weight = constants.arm[i + r] + constants.arm[j];
          if (has_band && constants.mask[j * N + i + r] == 0) weight = 0;
          sum = hn::MulAdd(mass[r], hn::Set(d, weight), sum);
        });
      });
    }
    hn::Store(sum, d, sums);
  }

  static HWY_NOINLINE HWY_ATTR void add_to_rings(const Tables& tables, std::size_t first,
                                                 Scratch& memory) {
    const D d;
    const bool power = tables.spec.power;
    for (int j = 0; j < N; ++j) {
      const std::uint8_t* HWY_RESTRICT const slot = tables.rings->slot.data() + j * N;
      transform_column(j, memory, [&](int i, const auto& t) FATHOM_LAMBDA {
        constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
        Vec<D> mass[count];
        walsh_masses<count, D>(t, power, mass);
        unroll<count>([&](auto r) FATHOM_LAMBDA {
          double* const sum = memory.ring_sums[slot[i + r]] + first;
          hn::Store(hn::Add(hn::Load(d, sum), mass[r]), d, sum);
        });
      });
    }
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
