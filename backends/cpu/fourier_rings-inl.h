// SPDX-License-Identifier: Apache-2.0
// Sums over rings of a large Fourier transform. Masses of a strip of rows are stored, those at u
// and -u added up; then each ring in turn adds the registers that hold some of it, the lanes that
// are another ring's left out. A register of sixteen rows meets four rings or five, so that this
// costs less than putting the masses in order would. Where rings are narrow it meets so many that
// the widest registers do put them in order (RingLayers).
#if defined(FATHOM_CPU_FOURIER_RINGS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_RINGS_INL_H_
#undef FATHOM_CPU_FOURIER_RINGS_INL_H_
#else
#define FATHOM_CPU_FOURIER_RINGS_INL_H_
#endif

#include "backends/cpu/fourier_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class T>
class FourierRings : protected FourierRows<N, T> {
 protected:
  using Rows = FourierRows<N, T>;
  using D = typename Rows::D;
  using Rows::kHalf;
  using Rows::kStrips;
  using Run = typename StripRings<T>::Run;
  using Layers = RingLayers<T>;
  static constexpr bool kHasLayers = kLanes<D> == Layers::kLanes;

  struct Scratch : Rows::Scratch {
    alignas(64) T masses[N * kLanes<D>];  ///< Of a strip, by position of u.
    /// The same at u and -u together, by |u|; and one register that runs of two may read.
    alignas(64) T folded[(kHalf + 2) * kLanes<D>];
    /// Over strips: of ring k in lanes of their own, or in lane k of all.
    alignas(64) T ring_sums[kMostRings][kLanes<D>];
  };

  /// Of a block of windows: rings and columns that there are not are read, and must be numbers.
  static void clear_sums(Scratch& memory) {
    std::memset(memory.ring_sums, 0, sizeof memory.ring_sums);
    std::memset(memory.folded + (kHalf + 1) * kLanes<D>, 0, kLanes<D> * sizeof(T));
  }

  /// Takes a number near the window's mean off the columns' constants: the mean is subtracted
  /// anyway, and the rest is rounded by what the window's contrast is, not its brightness.
  static HWY_ATTR void subtract_base(const FourierTables<T>& constants, Scratch& memory) {
    const D d;
    auto sum = hn::Zero(d);
    for (int strip = 0; strip < kStrips; ++strip) {
      // A column and its mirror image, which are one complex column, have the same weight.
      const auto weight = hn::LoadU(d, constants.mean_weight.data() + strip * kLanes<D>);
      sum = hn::MulAdd(hn::Add(memory.means[strip].re, memory.means[strip].im), weight, sum);
    }
    const auto base = hn::SumOfLanes(d, sum);
    for (auto& mean : memory.means) mean = {hn::Sub(mean.re, base), hn::Sub(mean.im, base)};
  }

  /// The weighted mean of a row v = 0, which is what the window's mean leaves there.
  static HWY_ATTR T brightness(const FourierTables<T>& constants, const T* row) {
    const D d;
    auto sum = hn::Zero(d);
    for (int x = 0; x < N; x += kLanes<D>) {
      const auto weight = hn::LoadU(d, constants.mean_weight.data() + x);
      sum = hn::MulAdd(hn::Load(d, row + x), weight, sum);
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
  }

  /// Sums of the rings over v = 1 .. N/2, the last row one half, and SUM |2 N^2 F|^2 over both
  /// halves of the plane without the row v = 0. bright: what the row v = 0 has of the mean.
  static HWY_NOINLINE HWY_ATTR double sum_strips(const Tables& tables, T bright,
                                                 std::span<double> sums, Scratch& memory) {
    const D d;
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const StripRings<T>& rings = strip_rings<T>(tables);
    const Layers* const layers = kHasLayers ? rings.layers() : nullptr;
    const int count = static_cast<int>(sums.size());
    auto energy = hn::Zero(d);
    for (int strip = 0; strip < kStrips; ++strip) {
      const int v = 1 + strip * kLanes<D>;
      Rows::turn_strip(constants, strip, memory);
      const auto share = hn::LoadU(d, constants.share.data() + v);
      const Complex<D> mean{
          hn::Mul(hn::Set(d, bright), hn::LoadU(d, constants.bright_re.data() + v)),
          hn::Mul(hn::Set(d, bright), hn::LoadU(d, constants.bright_im.data() + v))};
      energy = hn::MulAdd(masses(constants, tables.spec.power, mean, memory), share, energy);
      fold(constants, memory);
      if (layers) {
        add_layers(*layers, strip, count, memory);
      } else {
        add_strip(rings, strip, count, share, memory);
      }
    }
    if (layers) {
      for (int k = 0; k < count; ++k) sums[k] = memory.ring_sums[k / kLanes<D>][k % kLanes<D>];
    } else {
      add_up_lanes(sums, memory);
    }
    return 2 * double{hn::GetLane(hn::SumOfLanes(d, energy))};
  }

  /// Adds the rows v = 0, half of which stand in half of the plane, and makes sums the means.
  static HWY_NOINLINE HWY_ATTR void finish(const Tables& tables, std::span<double> values,
                                           std::size_t windows, Scratch& memory) {
    const D d;
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const RingTables& rings = *tables.rings;
    for (std::size_t w = windows; w < kBlock; ++w) {
      std::memset(memory.zero_rows[w], 0, sizeof memory.zero_rows[w]);
      memory.bright[w] = 0;
    }
    for (std::size_t first = 0; first < windows; first += kLanes<D>) {
      Rows::turn_zero_rows(static_cast<int>(first), memory);
      const Complex<D> mean{hn::Load(d, memory.bright + first), hn::Zero(d)};
      const auto energy = masses(constants, tables.spec.power, mean, memory);
      if constexpr (std::is_same_v<T, float>) add_lanes(d, energy, memory.energies + first);
      fold(constants, memory);
      for (int k = 0; k < rings.count; k += kLanes<D>) {
        add_zero_rows(strip_rings<T>(tables), rings, k, first, values, memory);
      }
    }
  }

 private:
  /// Masses of the rows in memory.rows, and the lanes' energy. mean: what is taken off the rows'
  /// constants.
  static HWY_INLINE HWY_ATTR Vec<D> masses(const FourierTables<T>& constants, bool power,
                                           Complex<D> mean, Scratch& memory) {
    const D d;
    auto energy = hn::Zero(d);
    Rows::transform_rows(constants, memory, [&](int p, auto& x, Complex<D> m) FATHOM_LAMBDA {
      const Complex<D> rest{hn::Sub(m.re, mean.re), hn::Sub(m.im, mean.im)};
      store_masses(d, constants, power, p, x, rest, memory.masses, energy);
    });
    return energy;
  }

  static HWY_INLINE HWY_ATTR void fold(const FourierTables<T>& constants, Scratch& memory) {
    const D d;
    const int* HWY_RESTRICT position = constants.position.data();
    const auto mass = [&](int u) FATHOM_LAMBDA {
      return hn::Load(d, memory.masses + position[u] * kLanes<D>);
    };
    T* HWY_RESTRICT folded = memory.folded;
    hn::Store(mass(0), d, folded);
    for (int u = 1; u < kHalf; ++u) {
      hn::Store(hn::Add(mass(u), mass(N - u)), d, folded + u * kLanes<D>);
    }
    hn::Store(mass(kHalf), d, folded + kHalf * kLanes<D>);
  }

  /// sum + mass in some lanes, sum in the others.
  template <class Mask>
  static HWY_INLINE HWY_ATTR Vec<D> add_where(Mask mask, Vec<D> sum, Vec<D> mass) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    if constexpr (kLanes<D> == 16) {
      return Vec<D>{_mm512_mask_add_ps(sum.raw, mask.raw, sum.raw, mass.raw)};
    } else {
      return Vec<D>{_mm512_mask_add_pd(sum.raw, mask.raw, sum.raw, mass.raw)};
    }
#else
    return hn::Add(sum, hn::IfThenElseZero(mask, mass));
#endif
  }

  static HWY_INLINE HWY_ATTR void add_strip(const StripRings<T>& rings, int strip, int count,
                                            Vec<D> share, Scratch& memory) {
    const D d;
    const Run* const runs = rings.template runs<kLanes<D>>(strip);
    for (int k = 0; k < count; ++k) {
      const auto ring = hn::Set(d, static_cast<T>(k));
      const auto add = [&](Vec<D> sum, int u) FATHOM_LAMBDA {
        const auto is_here = hn::Eq(hn::Load(d, rings.row(u) + strip * kLanes<D>), ring);
        return add_where(is_here, sum, hn::Load(d, memory.folded + u * kLanes<D>));
      };
      auto even = hn::Zero(d), odd = hn::Zero(d);
      for (int u = runs[k].first; u < runs[k].end; u += 2) {
        even = add(even, u);
        odd = add(odd, u + 1);
      }
      const auto sum = hn::Add(even, odd);
      T* const total = memory.ring_sums[k];
      const auto before = strip == 0 ? hn::Zero(d) : hn::Load(d, total);
      hn::Store(hn::MulAdd(sum, share, before), d, total);
    }
  }

  static HWY_INLINE HWY_ATTR void add_layers(const Layers& layers, int strip, int count,
                                             Scratch& memory) {
    if constexpr (kHasLayers) {
      for (int k = 0; k < count; k += kLanes<D>) {
        const D d;
        T* const total = memory.ring_sums[k / kLanes<D>];
        auto sum = strip == 0 ? hn::Zero(d) : hn::Load(d, total);
        for (const auto& layer : layers.layers(strip, k)) {
          sum = hn::Add(sum, sum_of_layer(layer, layers.moves(layer), memory));
        }
        hn::Store(sum, d, total);
      }
    }
  }

  static HWY_INLINE HWY_ATTR Vec<D> sum_of_layer(const typename Layers::Layer& layer,
                                                 const typename Layers::Move* HWY_RESTRICT move,
                                                 const Scratch& memory) {
    const D d;
    const T* HWY_RESTRICT folded = memory.folded + layer.first * kLanes<D>;
    const auto add = [&](Vec<D> sum, int u) FATHOM_LAMBDA {
      const auto from = hn::SetTableIndices(d, move[u].from);
      const auto mass = hn::TableLookupLanes(hn::Load(d, folded + u * kLanes<D>), from);
      return hn::MulAdd(mass, hn::Load(d, move[u].share), sum);
    };
    auto even = hn::Zero(d), odd = hn::Zero(d);
    for (int u = 0; u < layer.end - layer.first; u += 2) {
      even = add(even, u);
      odd = add(odd, u + 1);
    }
    return hn::Add(even, odd);
  }

  /// Rings k, k+1, .. into the lanes, and their lanes' sums.
  static HWY_INLINE HWY_ATTR void add_up_lanes(std::span<double> sums, Scratch& memory) {
    const D d;
    for (std::size_t k = 0; k < sums.size(); k += kLanes<D>) {
      Vec<D> square[kLanes<D>];
      unroll<kLanes<D>>([&](auto i)
                            FATHOM_LAMBDA { square[i] = hn::Load(d, memory.ring_sums[k + i]); });
      turn(d, square);
      alignas(64) T lanes[kLanes<D>];
      hn::Store(sum_of(d, square), d, lanes);
      const std::size_t count = std::min<std::size_t>(kLanes<D>, sums.size() - k);
      for (std::size_t i = 0; i < count; ++i) sums[k + i] = lanes[i];
    }
  }

  /// Adds rings k, k+1, .. of the rows v = 0 in the lanes and ends their means.
  static HWY_INLINE HWY_ATTR void add_zero_rows(const StripRings<T>& strips,
                                                const RingTables& rings, int k, std::size_t first,
                                                std::span<double> values, Scratch& memory) {
    const D d;
    const int count = std::min(kLanes<D>, rings.count - k);
    Vec<D> square[kLanes<D>];
    for (int i = 0; i < kLanes<D>; ++i) {
      square[i] = i < count ? sum_of_run(strips.zero_row()[k + i], memory) : hn::Zero(d);
    }
    turn(d, square);
    alignas(64) T lanes[kLanes<D>][kLanes<D>];
    unroll<kLanes<D>>([&](auto r)
                          FATHOM_LAMBDA { hn::Store(square[r], d, lanes[turned_column<D>(r)]); });
    const std::size_t windows = values.size() / rings.count;
    const double* HWY_RESTRICT const factor = rings.factor.data() + k;
    for (std::size_t w = first; w < std::min(windows, first + kLanes<D>); ++w) {
      double* HWY_RESTRICT const out = &values[w * rings.count + k];
      for (int i = 0; i < count; ++i) out[i] = factor[i] * (out[i] + 0.5 * lanes[w - first][i]);
    }
  }

  static HWY_INLINE HWY_ATTR Vec<D> sum_of_run(Run run, const Scratch& memory) {
    const D d;
    auto sum = hn::Zero(d);
    for (int u = run.first; u < run.end; ++u) {
      sum = hn::Add(sum, hn::Load(d, memory.folded + u * kLanes<D>));
    }
    return sum;
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
