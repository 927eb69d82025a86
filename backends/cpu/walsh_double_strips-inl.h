// SPDX-License-Identifier: Apache-2.0
// Walsh measures in double of windows of 32 and more, one at a time: transform over y with lanes =
// columns, turn, transform over x with lanes = rows, lever arms or rings.
#if defined(FATHOM_CPU_WALSH_DOUBLE_STRIPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_DOUBLE_STRIPS_INL_H_
#undef FATHOM_CPU_WALSH_DOUBLE_STRIPS_INL_H_
#else
#define FATHOM_CPU_WALSH_DOUBLE_STRIPS_INL_H_
#endif

#include "backends/cpu/walsh_double-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class Pixel>
class DoubleStrips {
  using D = hn::CappedTag<double, 8>;
  static constexpr int kStrips = N / kLanes<D>;

  struct Scratch {
    alignas(
        64) double columns[kStrips][N * kLanes<D>];  ///< Spectra of columns: [strip of x][i][x].
    alignas(64) double rows[N * kLanes<D>];          ///< Turned: [x][i], a strip of i.
    alignas(64) double masses[N][kLanes<D>];         ///< Of a strip of i: [j][i].
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const double constant = middle_of_range<Pixel>(tables, false);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(*tables.walsh, WindowPixels<Pixel>(frame, windows[w]), constant, memory);
      scores[w] = tables::moment_scale(tables.spec) * moment(tables, memory);
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const double constant = middle_of_range<Pixel>(tables, false);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(*tables.walsh, WindowPixels<Pixel>(frame, windows[w]), constant, memory);
      double sums[kMostRings + 1] = {};  // the last one: outside of all
      sum_rings(tables, sums, memory);
      ring_means(tables, sums, 1, &values[w * tables.rings->count]);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    columns(*tables.walsh, WindowPixels<Pixel>(frame, window), 0, memory);
    for (int strip = 0; strip < kStrips; ++strip) {
      turn_strip(strip, memory);
      wht<N>(
          D(), memory.rows,
          [&](int x) HWY_ATTR { return hn::Load(D(), memory.rows + x * kLanes<D>); },
          [&](int j, const auto& t) HWY_ATTR {
            for (int r = 0; r < static_cast<int>(std::size(t)); ++r) {
              alignas(64) double lanes[kLanes<D>];
              hn::Store(t[r], D(), lanes);
              for (int lane = 0; lane < kLanes<D>; ++lane) {
                coefficient_at(*tables.walsh, strip * kLanes<D> + lane, j + r, coefficients) =
                    lanes[lane] / (double{N} * N);
              }
            }
          });
    }
  }

 private:
  static HWY_NOINLINE HWY_ATTR void columns(const WalshTables& constants,
                                            const WindowPixels<Pixel>& pixels, double constant,
                                            Scratch& memory) {
    const D d;
    const double* HWY_RESTRICT taper = constants.taper.data();
    for (int strip = 0; strip < kStrips; ++strip) {
      const auto taper_x = hn::LoadU(d, taper + strip * kLanes<D>);
      double* const column = memory.columns[strip];
      wht<N>(
          d, column,
          [&](int y) FATHOM_LAMBDA {
            const auto f = hn::Sub(pixels.load(d, strip * kLanes<D>, y), hn::Set(d, constant));
            return hn::Mul(f, hn::Mul(taper_x, hn::Set(d, taper[y])));
          },
          [&](int i, const auto& t) FATHOM_LAMBDA {
            unroll<std::extent_v<std::remove_reference_t<decltype(t)>>>(
                [&](auto r) FATHOM_LAMBDA { hn::Store(t[r], d, column + (i + r) * kLanes<D>); });
          });
    }
  }

  /// Rows i = strip * kLanes<D> and following, for all x.
  static HWY_NOINLINE HWY_ATTR void turn_strip(int strip, Scratch& memory) {
    const D d;
    for (int source = 0; source < kStrips; ++source) {
      Vec<D> square[kLanes<D>];
      const double* const from = memory.columns[source] + strip * kLanes<D> * kLanes<D>;
      unroll<kLanes<D>>([&](auto i)
                            FATHOM_LAMBDA { square[i] = hn::Load(d, from + i * kLanes<D>); });
      turn(d, square);
      unroll<kLanes<D>>([&](auto r) FATHOM_LAMBDA {
        hn::Store(square[r], d,
                  memory.rows + (source * kLanes<D> + turned_column<D>(r)) * kLanes<D>);
      });
    }
  }

  static HWY_NOINLINE HWY_ATTR double moment(const Tables& tables, Scratch& memory) {
    const D d;
    const WalshTables& constants = *tables.walsh;
    const std::int32_t* HWY_RESTRICT arm = constants.arm.data();
    const bool power = tables.spec.power;
    const bool has_band = !constants.mask.empty();
    Moment<D> moment(tables.spec.is_exact());
    for (int strip = 0; strip < kStrips; ++strip) {
      turn_strip(strip, memory);
      auto mass_sum = hn::Zero(d);
      wht<N>(
          d, memory.rows,
          [&](int x) FATHOM_LAMBDA { return hn::Load(d, memory.rows + x * kLanes<D>); },
          [&](int j, const auto& t) FATHOM_LAMBDA {
            constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
            Vec<D> mass[count];
            walsh_masses<count, D>(t, power, mass);
            if (has_band) {
              for (int r = 0; r < count; ++r) {
                mass[r] = hn::Mul(mass[r], band_factor(constants, strip * kLanes<D>, j + r));
              }
            }
            auto group = hn::Zero(d);
            unroll<count>([&](auto r) FATHOM_LAMBDA {
              mass_sum = hn::Add(mass_sum, mass[r]);
              group = hn::MulAdd(mass[r], hn::Set(d, static_cast<double>(arm[j + r])), group);
            });
            moment.add(d, group);
          });
      moment.finish(d, mass_sum, arm + strip * kLanes<D>);
    }
    return moment.sum();
  }

  static HWY_NOINLINE HWY_ATTR void sum_rings(const Tables& tables, double* HWY_RESTRICT sums,
                                              Scratch& memory) {
    const D d;
    const bool power = tables.spec.power;
    for (int strip = 0; strip < kStrips; ++strip) {
      turn_strip(strip, memory);
      wht<N>(
          d, memory.rows,
          [&](int x) FATHOM_LAMBDA { return hn::Load(d, memory.rows + x * kLanes<D>); },
          [&](int j, const auto& t) FATHOM_LAMBDA {
            constexpr int count = std::extent_v<std::remove_reference_t<decltype(t)>>;
            Vec<D> mass[count];
            walsh_masses<count, D>(t, power, mass);
            unroll<count>([&](auto r)
                              FATHOM_LAMBDA { hn::Store(mass[r], d, memory.masses[j + r]); });
          });
      const std::uint8_t* HWY_RESTRICT const slot = tables.rings->slot.data() + strip * kLanes<D>;
      for (int j = 0; j < N; ++j) {
        for (int lane = 0; lane < kLanes<D>; ++lane) {
          sums[slot[j * N + lane]] += memory.masses[j][lane];
        }
      }
    }
  }

  /// 1 for the lanes i, i+1, .. that the band lets through at j, else 0: the mask has -1 and 0.
  static HWY_INLINE HWY_ATTR Vec<D> band_factor(const WalshTables& constants, int i, int j) {
    const D d;
    const hn::Rebind<std::int32_t, D> d32;
    return hn::Abs(hn::PromoteTo(d, hn::LoadU(d32, constants.mask.data() + j * N + i)));
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
