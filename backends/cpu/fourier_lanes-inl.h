// SPDX-License-Identifier: Apache-2.0
// Fourier measures of windows of 8 and 16, up to sixteen at a time, lanes = windows: rows of pixels
// y and N-1-y are one complex row (why these: fourier_strips-inl.h); then columns and magnitudes.
#if defined(FATHOM_CPU_FOURIER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_LANES_INL_H_
#undef FATHOM_CPU_FOURIER_LANES_INL_H_
#else
#define FATHOM_CPU_FOURIER_LANES_INL_H_
#endif

#include "backends/cpu/fourier-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// What follows the rows: it knows no pixels.
template <int N, class T>
class FourierColumns {
 protected:
  using D = hn::CappedTag<T, 16>;
  static constexpr int kHalf = N / 2;

  struct Scratch {
    alignas(64) T packed[Column<N, D>::kSize];              ///< Spectrum of two rows, over x.
    Complex<D> means[kHalf];                                ///< Of rows: what `packed` was about.
    alignas(64) T columns[kHalf + 1][Column<N, D>::kSize];  ///< [u][y].
    alignas(64) double sums[kBlock];
    alignas(64) double energies[kBlock];
    alignas(64) T bright[kBlock];         ///< The constant of the column u = 0: Doubt.
    alignas(64) T masses[N * kLanes<D>];  ///< Of a column, by position.
    alignas(64) T ring_sums[kMostRings + 1][kLanes<D>];  ///< The last one: outside of all.
  };

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(const FourierTables<T>& constants, int u,
                                                   Scratch& memory, const Consume& consume) {
    const Column<N, D> column(memory.columns[u]);
    tapered_fft<N, Sums::on_adders>(
        D(), constants, column, [&](int y) FATHOM_LAMBDA { return column[y]; }, consume);
  }

  static HWY_ATTR void place_spectrum(const FourierTables<T>& constants,
                                      std::span<std::complex<double>> coefficients,
                                      Scratch& memory) {
    for (int u = 0; u <= kHalf; ++u) {
      transform_column(constants, u, memory, [&](int p, auto& x, Complex<D> mean) HWY_ATTR {
        constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
        if (is_touched<count>(constants, p)) add_constant(D(), constants, p, mean, x);
        for (int r = 0; r < count; ++r) {
          place_coefficient({hn::GetLane(x[r].re), hn::GetLane(x[r].im)}, u,
                            constants.frequency[p + r], N, coefficients);
        }
      });
    }
  }

  /// Adds SUM over v of m(u, v) (u^2 + v^2), as often as column u stands in half of the plane, and
  /// what Doubt wants to know.
  static HWY_NOINLINE HWY_ATTR void add_column(const FourierTables<T>& constants, int u, bool power,
                                               int first, Scratch& memory) {
    const D d;
    RowSums<D> sums = empty_sums(D());
    // The table is [position of u][v]; here p is a position of v. A band is the same both ways.
    const auto get_mask = [&](int p) FATHOM_LAMBDA {
      return hn::Set(d, constants.mask[p * (kHalf + 1) + u]);
    };
    transform_column(constants, u, memory, [&](int p, auto& x, Complex<D> mean) FATHOM_LAMBDA {
      add_coefficients(d, constants, power, p, x, mean, get_mask, sums);
    });
    if (u == 0) hn::Store(sums.mean.re, d, memory.bright + first);
    const auto bright = hn::Load(d, memory.bright + first);
    const auto get = [&](const std::vector<T>& table)
                         FATHOM_LAMBDA { return hn::Set(d, table[u]); };
    const PlanePart<D> part = part_of_plane(d, constants, sums, bright, get);
    add_lanes(d, part.moment, memory.sums + first);
    if constexpr (std::is_same_v<T, float>) {
      add_lanes(d, hn::Add(part.energy, part.energy), memory.energies + first);
    }
  }

  /// Adds the constants of the rows to their spectra over x, less one near the window's mean: it is
  /// subtracted anyway (RingTables), and then never rounded.
  static HWY_NOINLINE HWY_ATTR void add_row_constants(const FourierTables<T>& constants,
                                                      Scratch& memory) {
    const D d;
    auto base = hn::Zero(d);
    for (int y = 0; y < kHalf; ++y) {
      const auto pair = hn::Add(memory.means[y].re, memory.means[y].im);
      base = hn::MulAdd(pair, hn::Set(d, constants.mean_weight[y]), base);
    }
    for (int u = 0; u <= constants.touched_until; ++u) {
      const int p = constants.position[u];
      const auto re = hn::Set(d, 2 * constants.flat_re[p]);
      const auto im = hn::Set(d, 2 * constants.flat_im[p]);
      const Column<N, D> column(memory.columns[u]);
      const auto add = [&](int y, Vec<D> mean) FATHOM_LAMBDA {
        const Complex<D> z = column[y];
        const auto m = hn::Sub(mean, base);
        column.set(y, {hn::MulAdd(m, re, z.re), hn::MulAdd(m, im, z.im)});
      };
      for (int y = 0; y < kHalf; ++y) {
        add(y, memory.means[y].re);
        add(N - 1 - y, memory.means[y].im);
      }
    }
  }

  /// The weighted mean of the column u = 0, which is the window's brightness.
  static HWY_ATTR Vec<D> brightness(const FourierTables<T>& constants, Scratch& memory) {
    const D d;
    const Column<N, D> column(memory.columns[0]);
    auto sum = hn::Zero(d);
    for (int y = 0; y < N; ++y) {
      sum = hn::MulAdd(column[y].re, hn::Set(d, constants.mean_weight[y]), sum);
    }
    return sum;
  }

  /// Adds the masses of a column to ring_sums, as often as it stands in half of the plane.
  static HWY_NOINLINE HWY_ATTR void add_column_to_rings(const FourierTables<T>& constants,
                                                        const std::uint8_t* HWY_RESTRICT slot,
                                                        int u, bool power, Vec<D> bright,
                                                        Vec<D>& energy, Scratch& memory) {
    const D d;
    const auto bright_re = hn::Set(d, constants.bright_re[u]);
    const auto bright_im = hn::Set(d, constants.bright_im[u]);
    auto column_energy = hn::Zero(d);
    transform_column(constants, u, memory, [&](int p, auto& x, Complex<D> mean) FATHOM_LAMBDA {
      const Complex<D> rest{hn::NegMulAdd(bright, bright_re, mean.re),
                            hn::NegMulAdd(bright, bright_im, mean.im)};
      store_masses(d, constants, power, p, x, rest, memory.masses, column_energy);
    });
    const auto share = hn::Set(d, constants.share[u]);
    energy = hn::MulAdd(column_energy, share, energy);
    for (int p = 0; p < N; ++p) {
      T* HWY_RESTRICT const sum = memory.ring_sums[slot[p]];
      const auto mass = hn::Load(d, memory.masses + p * kLanes<D>);
      hn::Store(hn::MulAdd(mass, share, hn::Load(d, sum)), d, sum);
    }
  }

  /// The rings of the windows from `first` on, whose rows are done, and what RingDoubt asks for.
  static HWY_ATTR void measure_rings(const Tables& tables, std::size_t first,
                                     std::span<double> values, Scratch& memory) {
    const D d;
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const RingTables& rings = *tables.rings;
    add_row_constants(constants, memory);
    std::memset(memory.ring_sums, 0, sizeof memory.ring_sums);
    const auto bright = brightness(constants, memory);
    auto energy = hn::Zero(d);
    for (int u = 0; u <= kHalf; ++u) {
      // The table is [position of u][position of v], and the same both ways.
      const std::uint8_t* const slot = rings.slot.data() + constants.position[u] * N;
      add_column_to_rings(constants, slot, u, tables.spec.power, bright, energy, memory);
    }
    if constexpr (std::is_same_v<T, float>) {
      add_lanes(d, hn::Add(energy, energy), memory.energies + first);
    }
    const std::size_t count = rings.factor.size(), windows = values.size() / count;
    for (std::size_t w = first; w < std::min(windows, first + kLanes<D>); ++w) {
      for (std::size_t k = 0; k < count; ++k) {
        values[w * count + k] = rings.factor[k] * double{memory.ring_sums[k][w - first]};
      }
    }
  }
};

template <int N, class T, class Pixel>
class FourierLanes : FourierColumns<N, T> {
  using Columns = FourierColumns<N, T>;
  using D = typename Columns::D;
  using Columns::kHalf;

  struct Scratch : Columns::Scratch {
    alignas(64) Pixel pixels[N][N][kBlock];
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const double scale = tables::moment_scale(tables.spec);
    begin(frame, windows, memory);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(constants, Constants::added, static_cast<int>(first), memory);
      for (int u = 0; u <= kHalf; ++u) {
        Columns::add_column(constants, u, tables.spec.power, static_cast<int>(first), memory);
      }
    }
    for (std::size_t w = 0; w < windows.size(); ++w) scores[w] = scale * memory.sums[w];
    if constexpr (std::is_same_v<T, float>) {
      measure_doubtful_moments(tables, frame, windows, scores, memory.energies, memory.bright,
                               scratch);
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    begin(frame, windows, memory);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(fourier_tables<T>(tables), Constants::kept, static_cast<int>(first), memory);
      Columns::measure_rings(tables, first, values, memory);
    }
    if constexpr (std::is_same_v<T, float>) {
      measure_doubtful_rings(tables, frame, windows, values, memory.energies, scratch);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    if constexpr (std::is_same_v<T, float>) {
      fourier_kernel_in_double(N, Depth::bits8, Measure::moment)
          .spectrum(tables, frame, window, coefficients, scratch);
    } else {
      auto& memory = *reinterpret_cast<Scratch*>(scratch);
      begin(frame, {&window, 1}, memory);
      rows(fourier_tables<T>(tables), Constants::added, 0, memory);
      Columns::place_spectrum(fourier_tables<T>(tables), coefficients, memory);
    }
  }

 private:
  /// Of the rows' constants: whether they are added to the spectra, or left in memory.means.
  enum class Constants { added, kept };

  static HWY_ATTR void begin(const Frame& frame, std::span<const Window> windows, Scratch& memory) {
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    for (auto* const sums : {memory.sums, memory.energies}) {
      std::memset(sums, 0, sizeof memory.sums);
    }
  }

  /// Spectra over x of all rows, two at a time, of the windows from `first` on.
  static HWY_NOINLINE HWY_ATTR void rows(const FourierTables<T>& constants, Constants kind,
                                         int first, Scratch& memory) {
    const D d;
    const hn::Rebind<Pixel, D> d_pixel;
    const Column<N, D> packed(memory.packed);
    for (int y = 0; y < kHalf; ++y) {
      Complex<D> mean;
      tapered_fft<N, Sums::shared_with_multipliers>(
          d, constants, packed,
          [&](int x) FATHOM_LAMBDA {
            return Complex<D>{
                WindowPixels<Pixel>::widen(d, hn::Load(d_pixel, memory.pixels[y][x] + first)),
                WindowPixels<Pixel>::widen(d,
                                           hn::Load(d_pixel, memory.pixels[N - 1 - y][x] + first))};
          },
          [&](int p, auto& z, Complex<D> m) FATHOM_LAMBDA {
            unroll<std::extent_v<std::remove_reference_t<decltype(z)>>>(
                [&](auto r) FATHOM_LAMBDA { packed.set(p + r, z[r]); });
            mean = m;
          });
      memory.means[y] = mean;
      if (kind == Constants::kept) mean = {hn::Zero(d), hn::Zero(d)};
      for (int u = 0; u <= kHalf; ++u) {
        const int p = constants.position[u];
        const auto [a, b] =
            take_apart(d, packed[p], packed[constants.position[(N - u) % N]], mean, constants, p);
        const Column<N, D> column(memory.columns[u]);
        column.set(y, a);
        column.set(N - 1 - y, b);
      }
    }
  }
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
