// SPDX-License-Identifier: Apache-2.0
// Fourier scores of windows of 8 and 16, up to sixteen at a time, lanes = windows: rows of pixels y
// and N-1-y are one complex row (why these: fourier_strips-inl.h); then columns and magnitudes.
#if defined(FATHOM_CPU_FOURIER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_LANES_INL_H_
#undef FATHOM_CPU_FOURIER_LANES_INL_H_
#else
#define FATHOM_CPU_FOURIER_LANES_INL_H_
#endif

#include "backends/cpu/fourier-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class T, class Pixel>
class FourierLanes {
  using D = hn::CappedTag<T, 16>;
  static constexpr int kHalf = N / 2;

  struct Scratch {
    alignas(64) Pixel pixels[N][N][kBlock];
    alignas(64) T packed[Column<N, D>::kSize];              ///< Spectrum of two rows, over x.
    alignas(64) T columns[kHalf + 1][Column<N, D>::kSize];  ///< [u][y].
    alignas(64) double sums[kBlock];
    alignas(64) double energies[kBlock];
    alignas(64) T bright[kBlock];  ///< The constant of the column u = 0: Doubt.
  };

 public:
  static constexpr std::size_t kScratchBytes =
      scratch_bytes<T, Scratch, FourierLanes<N, double, Pixel>>();

  static HWY_ATTR void score(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> scores,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const double scale = tables::moment_scale(tables.spec);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    for (auto* const sums : {memory.sums, memory.energies}) {
      std::memset(sums, 0, sizeof memory.sums);
    }
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(constants, static_cast<int>(first), memory);
      for (int u = 0; u <= kHalf; ++u) {
        add_column(constants, u, tables.spec.power, static_cast<int>(first), memory);
      }
    }
    for (std::size_t w = 0; w < windows.size(); ++w) scores[w] = scale * memory.sums[w];
    if constexpr (std::is_same_v<T, float>) {
      score_doubtful<FourierLanes<N, double, Pixel>>(tables, frame, windows, scores,
                                                     memory.energies, memory.bright, scratch);
    }
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    gather_block<N>(frame, {&window, 1}, &memory.pixels[0][0][0]);
    rows(constants, 0, memory);
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

 private:
  /// Spectra over x of all rows, two at a time, of the windows from `first` on.
  static HWY_NOINLINE HWY_ATTR void rows(const FourierTables<T>& constants, int first,
                                         Scratch& memory) {
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

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(const FourierTables<T>& constants, int u,
                                                   Scratch& memory, const Consume& consume) {
    const Column<N, D> column(memory.columns[u]);
    tapered_fft<N, Sums::on_adders>(
        D(), constants, column, [&](int y) FATHOM_LAMBDA { return column[y]; }, consume);
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
};

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
