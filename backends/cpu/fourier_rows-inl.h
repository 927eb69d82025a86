// SPDX-License-Identifier: Apache-2.0
// What follows the columns of a large Fourier transform (fourier_strips-inl.h): it knows no pixels.
#if defined(FATHOM_CPU_FOURIER_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_ROWS_INL_H_
#undef FATHOM_CPU_FOURIER_ROWS_INL_H_
#else
#define FATHOM_CPU_FOURIER_ROWS_INL_H_
#endif

#include "backends/cpu/fourier-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class T>
class FourierRows {
 protected:
  using D = hn::CappedTag<T, 16>;
  static constexpr int kHalf = N / 2;
  static constexpr int kStrips = kHalf / kLanes<D>;  ///< Registers to a row of packed columns.

  struct Scratch {
    alignas(64) T columns[kStrips][Column<N, D>::kSize];  ///< Spectra of columns, by position of v.
    Complex<D> means[kStrips];                            ///< What they were taken about.
    alignas(64) T rows[Column<N, D>::kSize];              ///< Turned: [x][v], a strip of v.
    alignas(64) T zero_rows[kBlock][N];                   ///< [window][x], the row v = 0.
    alignas(64) double energies[kBlock];                  ///< [window]
    alignas(64) T bright[kBlock];                         ///< [window] constant of the row v = 0.
  };

  /// The first of the columns whose mirror images are those of a strip.
  static constexpr int mirrored_strip(int strip) { return N - (strip + 1) * kLanes<D>; }

  static HWY_ATTR void place_spectrum(const FourierTables<T>& constants,
                                      std::span<std::complex<double>> coefficients,
                                      Scratch& memory) {
    keep_zero_row(constants, memory, memory.zero_rows[0]);
    for (int strip = 0; strip < kStrips; ++strip) {
      turn_strip(constants, strip, memory);
      place_rows(constants, kLanes<D>, 1 + strip * kLanes<D>, coefficients, memory);
    }
    turn_zero_rows(0, memory);
    place_rows(constants, 1, 0, coefficients, memory);
  }

  static HWY_NOINLINE HWY_ATTR void place_rows(const FourierTables<T>& constants, int lanes,
                                               int first_v,
                                               std::span<std::complex<double>> coefficients,
                                               Scratch& memory) {
    transform_rows(constants, memory, [&](int p, auto& x, Complex<D> mean) HWY_ATTR {
      constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
      if (is_touched<count>(constants, p)) add_constant(D(), constants, p, mean, x);
      for (int r = 0; r < count; ++r) {
        alignas(64) T re[kLanes<D>], im[kLanes<D>];
        hn::Store(x[r].re, D(), re);
        hn::Store(x[r].im, D(), im);
        for (int lane = 0; lane < lanes; ++lane) {
          place_coefficient({re[lane], im[lane]}, constants.frequency[p + r], first_v + lane, N,
                            coefficients);
        }
      }
    });
  }

  /// Twice the real row v = 0.
  static HWY_ATTR void keep_zero_row(const FourierTables<T>& constants, Scratch& memory, T* row) {
    const D d;
    const int p = constants.position[0];
    for (int strip = 0; strip < kStrips; ++strip) {
      const Complex<D> z = Column<N, D>(memory.columns[strip])[p];
      const auto [a, b] = take_apart(d, z, z, memory.means[strip], constants, p);
      hn::Store(a.re, d, row + strip * kLanes<D>);
      hn::Store(hn::Reverse(d, b.re), d, row + mirrored_strip(strip));
    }
  }

  /// What sampled_mean will find in a row v = 0.
  static T constant_of(const FourierTables<T>& constants, const T* row) {
    T sum = 0;
    for (int k = 0; k < 8; ++k) sum += constants.sample_weight[k] * row[N / 16 + k * (N / 8)];
    return sum;
  }

  /// Turns a square of registers and stores it, kStride registers apart, which may be negative.
  template <int kStride>
  static HWY_INLINE HWY_ATTR void turn_and_store(Vec<D> (&square)[kLanes<D>], T* HWY_RESTRICT out) {
    const D d;
    turn(d, square);
    unroll<kLanes<D>>([&](auto r) FATHOM_LAMBDA {
      hn::Store(square[r], d, out + turned_column<D>(r) * kStride * kLanes<D>);
    });
  }

  /// Rows v = 1 + strip * lanes and following, for all x.
  static HWY_ATTR void turn_strip(const FourierTables<T>& constants, int strip, Scratch& memory) {
    if (1 + strip * kLanes<D> <= constants.touched_until) {
      turn_strip<true>(constants, strip, memory);
    } else {
      turn_strip<false>(constants, strip, memory);
    }
  }

  template <bool kTouched>
  static HWY_NOINLINE HWY_ATTR void turn_strip(const FourierTables<T>& constants, int strip,
                                               Scratch& memory) {
    const D d;
    const int first = 1 + strip * kLanes<D>;
    const int* const position = constants.position.data() + first;
    const int* const mirrored = constants.position.data() + N - first;
    const Column<N, D> rows(memory.rows);
    for (int source = 0; source < kStrips; ++source) {
      const Column<N, D> z(memory.columns[source]);
      const Complex<D> mean = memory.means[source];
      // One real square after the other, so that each stays in registers.
      const auto turn_part = [&](auto stride, const auto& part, T* out) FATHOM_LAMBDA {
        Vec<D> square[kLanes<D>];
        unroll<kLanes<D>>([&](auto i) FATHOM_LAMBDA {
          if constexpr (kTouched) {
            square[i] =
                part(take_apart(d, z[position[i]], z[mirrored[-i]], mean, constants, position[i]));
          } else {
            square[i] = part(take_apart(d, z[position[i]], z[mirrored[-i]]));
          }
        });
        turn_and_store<stride>(square, out);
      };
      constexpr std::integral_constant<int, 2> forwards;
      constexpr std::integral_constant<int, -2> backwards;
      using Parts = const RealPair<D>&;
      const int x = source * kLanes<D>;
      turn_part(
          forwards, [](Parts pair) FATHOM_LAMBDA { return pair.a.re; }, rows.re(x));
      turn_part(
          forwards, [](Parts pair) FATHOM_LAMBDA { return pair.a.im; }, rows.im(x));
      turn_part(
          backwards, [](Parts pair) FATHOM_LAMBDA { return pair.b.re; }, rows.re(N - 1 - x));
      turn_part(
          backwards, [](Parts pair) FATHOM_LAMBDA { return pair.b.im; }, rows.im(N - 1 - x));
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_rows(const FourierTables<T>& constants, Scratch& memory,
                                                 const Consume& consume) {
    const Column<N, D> rows(memory.rows);
    tapered_fft<N, Sums::on_adders>(
        D(), constants, rows, [&](int x) FATHOM_LAMBDA { return rows[x]; }, consume);
  }

  /// Sums over the rows in memory.rows. get_mask(position of u) gives those lanes' part of the
  /// band.
  template <class GetMask>
  static HWY_INLINE HWY_ATTR RowSums<D> row_sums(const FourierTables<T>& constants, bool power,
                                                 const GetMask& get_mask, Scratch& memory) {
    RowSums<D> sums = empty_sums(D());
    transform_rows(constants, memory, [&](int p, auto& x, Complex<D> mean) FATHOM_LAMBDA {
      add_coefficients(D(), constants, power, p, x, mean, get_mask, sums);
    });
    return sums;
  }

  struct HalfPlane {
    double moment = 0;  ///< SUM m (u^2 + v^2) over v = 1 .. N/2, the last one half.
    double energy = 0;  ///< Of both halves, without the row v = 0: see Doubt.
  };

  static HWY_NOINLINE HWY_ATTR HalfPlane sum_half_plane(const FourierTables<T>& constants,
                                                        bool power, T bright, Scratch& memory) {
    const D d;
    alignas(64) double moments[kLanes<D>] = {}, energies[kLanes<D>] = {};
    for (int strip = 0; strip < kStrips; ++strip) {
      const int v = 1 + strip * kLanes<D>;
      turn_strip(constants, strip, memory);
      const auto get_mask = [&](int p) FATHOM_LAMBDA {
        return hn::LoadU(d, constants.mask.data() + p * (kHalf + 1) + v);
      };
      const RowSums<D> sums = row_sums(constants, power, get_mask, memory);
      const auto get = [&](const std::vector<T>& table)
                           FATHOM_LAMBDA { return hn::LoadU(d, table.data() + v); };
      const PlanePart<D> part = part_of_plane(d, constants, sums, hn::Set(d, bright), get);
      add_lanes(d, part.moment, moments);
      if constexpr (std::is_same_v<T, float>) add_lanes(d, part.energy, energies);
    }
    HalfPlane total;
    for (const double moment : moments) total.moment += moment;
    for (const double energy : energies) total.energy += 2 * energy;
    return total;
  }

  /// Rows v = 0 of `lanes` windows: lanes x become lanes w.
  static HWY_ATTR void turn_zero_rows(int first_window, Scratch& memory) {
    const D d;
    const Column<N, D> rows(memory.rows);
    for (int x = 0; x < N; x += kLanes<D>) {
      Vec<D> square[kLanes<D>];
      unroll<kLanes<D>>([&](auto i) FATHOM_LAMBDA {
        square[i] = hn::Load(d, memory.zero_rows[first_window + i] + x);
      });
      turn_and_store<2>(square, rows.re(x));
    }
    for (int x = 0; x < N; ++x) hn::Store(hn::Zero(d), d, rows.im(x));
  }

  /// The moments of the rows v = 0, half of which stand in half of the plane.
  static HWY_NOINLINE HWY_ATTR void add_zero_rows(const FourierTables<T>& constants, bool power,
                                                  double scale, std::span<double> scores,
                                                  Scratch& memory) {
    const D d;
    const int count = static_cast<int>(scores.size());
    for (int w = count; w < kBlock; ++w) {
      std::memset(memory.zero_rows[w], 0, sizeof memory.zero_rows[w]);
    }
    for (int first = 0; first < count; first += kLanes<D>) {
      turn_zero_rows(first, memory);
      const auto get_mask = [&](int p) FATHOM_LAMBDA {
        return hn::Set(d, constants.mask[p * (kHalf + 1)]);
      };
      const RowSums<D> sums = row_sums(constants, power, get_mask, memory);
      alignas(64) double moments[kLanes<D>] = {};
      add_lanes(d, sums.moment, moments);
      add_lanes(d, sums.energy, memory.energies + first);
      for (int lane = 0; lane < kLanes<D> && first + lane < count; ++lane) {
        scores[first + lane] += scale * 0.5 * moments[lane];
      }
    }
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
