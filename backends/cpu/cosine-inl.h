// SPDX-License-Identifier: Apache-2.0
// Cosine measures, one window at a time: transform over y with lanes = columns, turn, transform
// over x with lanes = rows.
//
// A cosine transform of N real points is a Fourier transform of them in another order, the even
// ones upward and then the odd ones downward, turned by exp(-pi i k/(2 N)) (Makhoul 1980). Two
// strips of lanes go through one complex transform, as its real and its imaginary part.
#if defined(FATHOM_CPU_COSINE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_COSINE_INL_H_
#undef FATHOM_CPU_COSINE_INL_H_
#else
#define FATHOM_CPU_COSINE_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <complex>
#include <span>

#include "backends/cpu/fft-inl.h"
#include "backends/cpu/pixels-inl.h"
#include "engine/tables.hpp"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class Pixel>
class CosineStrips {
  using D = hn::CappedTag<double, (N / 2 < 8 ? N / 2 : 8)>;  // two strips at least
  using Points = Column<N, D>;
  static constexpr int kStrips = N / kLanes<D>;

  struct Scratch {
    alignas(64) double columns[kStrips][N * kLanes<D>];  ///< N C over y: [strip of x][i][x].
    alignas(64) double points[Points::kSize];
    alignas(64) double masses[N][2 * kLanes<D>];  ///< Of two strips of i: [j][i].
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(*tables.cosine, WindowPixels<Pixel>(frame, windows[w]), memory);
      scores[w] = tables::moment_scale(tables.spec) * moment(tables, memory);
    }
  }

  static HWY_ATTR void entropies(const Tables& tables, const Frame& frame,
                                 std::span<const Window> windows, std::span<double> scores,
                                 std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(*tables.cosine, WindowPixels<Pixel>(frame, windows[w]), memory);
      scores[w] = entropy(*tables.cosine, memory);
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const RingTables& rings = *tables.rings;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(*tables.cosine, WindowPixels<Pixel>(frame, windows[w]), memory);
      double sums[kMostRings + 1] = {};  // the last one: outside of all
      sum_rings(tables, sums, memory);
      for (int k = 0; k < rings.count; ++k) values[w * rings.count + k] = sums[k] * rings.factor[k];
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    columns(*tables.cosine, WindowPixels<Pixel>(frame, window), memory);
    for (int strip = 0; strip < kStrips; strip += 2) {
      rows(*tables.cosine, strip, memory, [&](int j, Complex<D> c) HWY_ATTR {
        hn::Store(c.re, D(), memory.masses[j]);
        hn::Store(c.im, D(), memory.masses[j] + kLanes<D>);
        for (int lane = 0; lane < 2 * kLanes<D>; ++lane) {
          coefficients[static_cast<std::size_t>(strip * kLanes<D> + lane) * N + j] =
              memory.masses[j][lane] / (double{N} * N);
        }
      });
    }
  }

 private:
  /// Where sample x goes.
  static constexpr int place_of(int x) { return x % 2 == 0 ? x / 2 : N - 1 - x / 2; }
  /// Which sample point k is.
  static constexpr int sample_at(int k) { return k < N / 2 ? 2 * k : 2 * (N - k) - 1; }

  /// Two real cosine transforms, as real and imaginary part. load(k) gives point k, and may read
  /// the points themselves; consume(k, C) takes the coefficients.
  template <class Load, class Consume>
  static HWY_INLINE HWY_ATTR void transform(const CosineTables& tables, Points points,
                                            const Load& load, const Consume& consume) {
    const D d;
    fft<N, Sums::on_adders>(d, tables.fourier.twiddle.data(), points, load,
                            [&](int p, auto& z) FATHOM_LAMBDA {
                              unroll<std::extent_v<std::remove_reference_t<decltype(z)>>>(
                                  [&](auto r) FATHOM_LAMBDA { points.set(p + r, z[r]); });
                            });
    const int* const position = tables.fourier.position.data();
    consume(0, points[position[0]]);
    consume(N / 2, points[position[N / 2]]);
    for (int k = 1; k < N / 2; ++k) {
      const auto [a, b] = take_apart(d, points[position[k]], points[position[N - k]]);
      const auto c = hn::Set(d, tables.cosine[k]), s = hn::Set(d, tables.sine[k]);
      consume(k, Complex<D>{hn::MulAdd(c, a.re, hn::Mul(s, a.im)),
                            hn::MulAdd(c, b.re, hn::Mul(s, b.im))});
      consume(N - k, Complex<D>{hn::NegMulAdd(c, a.im, hn::Mul(s, a.re)),
                                hn::NegMulAdd(c, b.im, hn::Mul(s, b.re))});
    }
  }

  static HWY_NOINLINE HWY_ATTR void columns(const CosineTables& tables,
                                            const WindowPixels<Pixel>& pixels, Scratch& memory) {
    const D d;
    for (int strip = 0; strip < kStrips; strip += 2) {
      const int x = strip * kLanes<D>;
      transform(
          tables, Points(memory.points),
          [&](int k) FATHOM_LAMBDA {
            const int y = sample_at(k);
            return Complex<D>{pixels.load(d, x, y), pixels.load(d, x + kLanes<D>, y)};
          },
          [&](int i, Complex<D> c) FATHOM_LAMBDA {
            hn::Store(c.re, d, memory.columns[strip] + i * kLanes<D>);
            hn::Store(c.im, d, memory.columns[strip + 1] + i * kLanes<D>);
          });
    }
  }

  /// N^2 C(i, j) of two strips of i: consume(j, C), the first strip real, the second imaginary.
  template <class Consume>
  static HWY_INLINE HWY_ATTR void rows(const CosineTables& tables, int strip, Scratch& memory,
                                       const Consume& consume) {
    const Points points(memory.points);
    turn_strip(strip, 0, memory);
    turn_strip(strip + 1, kLanes<D>, memory);
    transform(
        tables, points, [&](int k) FATHOM_LAMBDA { return points[k]; }, consume);
  }

  /// Rows i of a strip become lanes; of real parts, or of those `offset` numbers further on.
  static HWY_NOINLINE HWY_ATTR void turn_strip(int strip, int offset, Scratch& memory) {
    const D d;
    for (int source = 0; source < kStrips; ++source) {
      const double* const from = memory.columns[source] + strip * kLanes<D> * kLanes<D>;
      Vec<D> square[kLanes<D>];
      unroll<kLanes<D>>([&](auto i)
                            FATHOM_LAMBDA { square[i] = hn::Load(d, from + i * kLanes<D>); });
      turn(d, square);
      unroll<kLanes<D>>([&](auto r) FATHOM_LAMBDA {
        const int x = source * kLanes<D> + turned_column<D>(r);
        hn::Store(square[r], d, memory.points + 2 * place_of(x) * kLanes<D> + offset);
      });
    }
  }

  static HWY_NOINLINE HWY_ATTR double moment(const Tables& tables, Scratch& memory) {
    const D d;
    const bool power = tables.spec.power;
    auto first = hn::Zero(d), second = hn::Zero(d);
    for (int strip = 0; strip < kStrips; strip += 2) {
      rows(*tables.cosine, strip, memory, [&](int j, Complex<D> c) FATHOM_LAMBDA {
        const double* const weight = weights(*tables.cosine, strip, j);
        first = hn::MulAdd(mass(c.re, power), hn::LoadU(d, weight), first);
        second = hn::MulAdd(mass(c.im, power), hn::LoadU(d, weight + kLanes<D>), second);
      });
    }
    return sum_of_lanes(hn::Add(first, second));
  }

  /// What an entropy is made of: with p = m/L, L^2 = SUM m^2,
  /// SUM p log2(1/p) = (log2 L SUM m - SUM m log2 m)/L.
  struct Terms {
    Vec<D> energy, mass, with_log;

    HWY_INLINE HWY_ATTR void add(Vec<D> coefficient, Vec<D> weight) {
      const D d;
      const auto m = hn::Abs(coefficient), weighted = hn::Mul(weight, m);
      energy = hn::MulAdd(m, m, energy);
      mass = hn::Add(mass, weighted);
      // Nothing has no logarithm, and no term.
      const auto tiny = hn::Set(d, 1e-300);
      with_log = hn::MulAdd(weighted, hn::Log2(d, hn::Max(m, tiny)), with_log);
    }
  };

  static HWY_NOINLINE HWY_ATTR double entropy(const CosineTables& tables, Scratch& memory) {
    const D d;
    Terms terms{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (int strip = 0; strip < kStrips; strip += 2) {
      rows(tables, strip, memory, [&](int j, Complex<D> c) FATHOM_LAMBDA {
        const double* const weight = weights(tables, strip, j);
        terms.add(c.re, hn::LoadU(d, weight));
        terms.add(c.im, hn::LoadU(d, weight + kLanes<D>));
      });
    }
    const double masses = sum_of_lanes(terms.mass);
    if (masses == 0) return 0;
    const double norm = std::sqrt(sum_of_lanes(terms.energy));
    const double bits = (std::log2(norm) * masses - sum_of_lanes(terms.with_log)) / norm;
    return bits / tables.terms;
  }

  static HWY_NOINLINE HWY_ATTR void sum_rings(const Tables& tables, double* HWY_RESTRICT sums,
                                              Scratch& memory) {
    const D d;
    const bool power = tables.spec.power;
    for (int strip = 0; strip < kStrips; strip += 2) {
      rows(*tables.cosine, strip, memory, [&](int j, Complex<D> c) FATHOM_LAMBDA {
        hn::Store(mass(c.re, power), d, memory.masses[j]);
        hn::Store(mass(c.im, power), d, memory.masses[j] + kLanes<D>);
      });
      const std::uint8_t* HWY_RESTRICT const slot = tables.rings->slot.data() + strip * kLanes<D>;
      for (int j = 0; j < N; ++j) {
        for (int lane = 0; lane < 2 * kLanes<D>; ++lane)
          sums[slot[j * N + lane]] += memory.masses[j][lane];
      }
    }
  }

  static HWY_INLINE HWY_ATTR double sum_of_lanes(Vec<D> v) {
    return hn::GetLane(hn::SumOfLanes(D(), v));
  }

  static HWY_INLINE HWY_ATTR Vec<D> mass(Vec<D> coefficient, bool power) {
    return power ? hn::Mul(coefficient, coefficient) : hn::Abs(coefficient);
  }

  /// Those of coefficients (i, j) for the lanes i of two strips: weights are symmetric.
  static HWY_INLINE const double* weights(const CosineTables& tables, int strip, int j) {
    return tables.weights.data() + j * N + strip * kLanes<D>;
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
