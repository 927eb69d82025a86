// SPDX-License-Identifier: Apache-2.0
// The Walsh-Hadamard kernels in double (thesis eq. 5-2): 16-bit pixels, tapers, `power`. Sums of
// integers below 2^53 are exact in double, so that the scores of untapered windows are exact too.
// 8-bit windows without taper have faster kernels in walsh_integer.cpp. Compiled once per
// instruction set.
//
// Windows of 32 and more, one at a time: transform over y with lanes = columns, turn, transform
// over x with lanes = rows, lever arms. Windows of 8 and 16, sixteen at a time: lanes = windows.
//
// Every order has the same coefficients in other places, so they differ in their lever arms only.
//
// Rings are summed coefficient by coefficient: sums of integers below 2^53 (by Cauchy-Schwarz and
// Parseval at most N 2^16 N^2 = 2^43), so that these are exact too.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/walsh_double.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/pixels-inl.h"
#include "backends/cpu/wht-inl.h"
#include "engine/tables.hpp"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

/// What the moment is summed in: exact sums as integers, rounded ones as they are.
///
/// With pixels about the middle of their range, |f| <= M = 2^15, Parseval gives SUM T^2 <= (M
/// N^2)^2 along a row, and by Cauchy-Schwarz eight coefficients of it have
///     SUM |T| j^2 <= M N^2 sqrt(8) N^2 <= 2^15 2^18 2^1.5 2^18 < 2^53,
/// exact in double; so are the sums of magnitudes. A whole row's SUM |T| j^2 need not be.
template <class D>
class Moment {
 public:
  HWY_INLINE HWY_ATTR explicit Moment(bool exact) : exact_(exact) {}

  /// Adds the group's SUM |T| j^2.
  HWY_INLINE HWY_ATTR void add(D, Vec<D> group) {
    if (exact_) {
      integer_ = hn::Add(integer_, hn::ConvertTo(d64_, group));
    } else {
      rounded_ = hn::Add(rounded_, group);
    }
  }
  /// Ends the lanes of a strip: adds i^2 times SUM |T|, for each lane its own i^2.
  HWY_INLINE HWY_ATTR void finish(D d, Vec<D> mass_sum, const std::int32_t* squared_i) {
    alignas(64) std::int64_t integer[kLanes<D>];
    alignas(64) double rounded[kLanes<D>], mass[kLanes<D>];
    hn::Store(integer_, d64_, integer);
    hn::Store(rounded_, d, rounded);
    hn::Store(mass_sum, d, mass);
    for (int lane = 0; lane < kLanes<D>; ++lane) {
      exact_sum_ += static_cast<std::uint64_t>(integer[lane]);
      rounded_sum_ += rounded[lane];
      if (exact_) {
        exact_sum_ += static_cast<std::uint64_t>(mass[lane]) * squared_i[lane];
      } else {
        rounded_sum_ += mass[lane] * squared_i[lane];
      }
    }
    integer_ = hn::Zero(d64_);
    rounded_ = hn::Zero(d);
  }
  double sum() const { return exact_ ? static_cast<double>(exact_sum_) : rounded_sum_; }

 private:
  static constexpr hn::Rebind<std::int64_t, D> d64_{};
  bool exact_;
  hn::Vec<hn::Rebind<std::int64_t, D>> integer_ = hn::Zero(hn::Rebind<std::int64_t, D>());
  Vec<D> rounded_ = hn::Zero(D());
  std::uint64_t exact_sum_ = 0;
  double rounded_sum_ = 0;
};

/// The constant that may be taken from every pixel of an untapered window: it changes T(0, 0) only,
/// which has no lever arm. Half of the range keeps all others small.
template <class Pixel>
double middle_of_range(const Tables& tables, bool all_coefficients) {
  if (all_coefficients || tables.spec.taper != Taper::none()) return 0;
  return std::is_same_v<Pixel, std::uint8_t> ? 128 : 32768;
}

/// Magnitudes, or squares, of R coefficients.
template <int R, class D>
HWY_INLINE HWY_ATTR void walsh_masses(const Vec<D> (&t)[R], bool power, Vec<D> (&mass)[R]) {
  if (power) {
    unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = hn::Mul(t[r], t[r]); });
  } else {
    unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = hn::Abs(t[r]); });
  }
}

/// The means of rings: rounded once where the sums are whole numbers.
void ring_means(const Tables& tables, const double* sums, std::size_t stride, double* values) {
  const RingTables& rings = *tables.rings;
  const double pixels = static_cast<double>(tables.spec.n) * tables.spec.n;
  for (int k = 0; k < rings.count; ++k) {
    const double sum = sums[k * stride];
    values[k] =
        tables.spec.is_exact() ? sum / (rings.coefficients[k] * pixels) : sum * rings.factor[k];
  }
}

/// [row][col] of Plan::spectrum for coefficient (i, j) by position.
std::complex<double>& coefficient_at(const WalshTables& constants, int i, int j,
                                     std::span<std::complex<double>> coefficients) {
  const auto n = constants.index.size();
  return coefficients[constants.index[i] * n + constants.index[j]];
}

// ------------------------------------------------------------------------- N = 32 .. 512

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

// ---------------------------------------------------------------------------- N = 8 and 16

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

template <class Pixel>
Kernel walsh_kernel_of(const MetricSpec& spec) {
  return with_size(spec.n, [&](auto size) {
    using Implementation =
        std::conditional_t<(size < 32), DoubleLanes<size, Pixel>, DoubleStrips<size, Pixel>>;
    return kernel_of<Implementation>(spec.measure);
  });
}

}  // namespace

Kernel walsh_kernel(const MetricSpec& spec, Depth depth) {
  return depth == Depth::bits8 ? walsh_kernel_of<std::uint8_t>(spec)
                               : walsh_kernel_of<std::uint16_t>(spec);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
