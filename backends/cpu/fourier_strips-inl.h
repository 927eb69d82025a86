// SPDX-License-Identifier: Apache-2.0
// Fourier scores of windows of 32 and more, one at a time:
//
//   columns  lanes = x. Columns of pixels x and N-1-x are one complex column z = a + i b. Taper,
//            transform over y.
//   turn     Take the two real columns' spectra apart, A(v) = (z(v) + z(-v)*)/2 and B likewise,
//            for v > 0 only, and swap lanes with registers.
//   rows     lanes = v. Taper, transform over x, magnitudes, lever arms.
//
// Taking apart leaves each column with some rounding noise of the other. Mirror images have the
// same weight in the taper over x that follows; of any other pair the noise of a column near the
// edge would arrive up to 1/w(0) = 10^5 times as strong beside the column itself.
//
// The row v = 0 would be one lane too many. It is put aside, and those of a block of windows are
// transformed side by side.
#if defined(FATHOM_CPU_FOURIER_STRIPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_STRIPS_INL_H_
#undef FATHOM_CPU_FOURIER_STRIPS_INL_H_
#else
#define FATHOM_CPU_FOURIER_STRIPS_INL_H_
#endif

#include "backends/cpu/fourier_lanes-inl.h"
#include "backends/cpu/fourier_rings-inl.h"
#include "backends/cpu/fourier_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <int N, class T, class Pixel>
class FourierStrips : FourierRings<N, T> {
  using Rows = FourierRows<N, T>;
  using Rings = FourierRings<N, T>;
  using D = typename Rows::D;
  using Rows::kStrips;
  using Scratch = typename Rings::Scratch;

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void moments(const Tables& tables, const Frame& frame,
                               std::span<const Window> windows, std::span<double> scores,
                               std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const bool power = tables.spec.power;
    const double scale = tables::moment_scale(tables.spec);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(constants, WindowPixels<Pixel>(frame, windows[w]), memory);
      Rows::keep_zero_row(constants, memory, memory.zero_rows[w]);
      memory.bright[w] = Rows::constant_of(constants, memory.zero_rows[w]);
      const auto sums = Rows::sum_half_plane(constants, power, memory.bright[w], memory);
      scores[w] = scale * sums.moment;
      memory.energies[w] = sums.energy;
    }
    Rows::add_zero_rows(constants, power, scale, scores, memory);
    if constexpr (std::is_same_v<T, float>) {
      measure_doubtful_moments(tables, frame, windows, scores, memory.energies, memory.bright,
                               scratch);
    }
  }

  static HWY_ATTR void rings(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> values,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const std::size_t count = values.size() / windows.size();
    Rings::clear_sums(memory);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(constants, WindowPixels<Pixel>(frame, windows[w]), memory);
      Rings::subtract_base(constants, memory);
      Rows::keep_zero_row(constants, memory, memory.zero_rows[w]);
      memory.bright[w] = Rings::brightness(constants, memory.zero_rows[w]);
      memory.energies[w] =
          Rings::sum_strips(tables, memory.bright[w], values.subspan(w * count, count), memory);
    }
    Rings::finish(tables, values, windows.size(), memory);
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
      columns(fourier_tables<T>(tables), WindowPixels<Pixel>(frame, window), memory);
      Rows::place_spectrum(fourier_tables<T>(tables), coefficients, memory);
    }
  }

 private:
  /// Spectra over y of the packed columns.
  static HWY_NOINLINE HWY_ATTR void columns(const FourierTables<T>& constants,
                                            const WindowPixels<Pixel>& pixels, Scratch& memory) {
    const D d;
    for (int strip = 0; strip < kStrips; ++strip) {
      const Column<N, D> column(memory.columns[strip]);
      const int x = strip * kLanes<D>;
      tapered_fft<N, Sums::shared_with_multipliers>(
          d, constants, column,
          [&](int y) FATHOM_LAMBDA {
            return Complex<D>{pixels.load(d, x, y),
                              hn::Reverse(d, pixels.load(d, Rows::mirrored_strip(strip), y))};
          },
          [&](int p, auto& z, Complex<D> mean) FATHOM_LAMBDA {
            set_all(column, p, z);
            memory.means[strip] = mean;
          });
    }
  }

  template <class Z>
  static HWY_INLINE HWY_ATTR void set_all(const Column<N, D>& column, int p, const Z& z) {
    unroll<std::extent_v<Z>>([&](auto r) FATHOM_LAMBDA { column.set(p + r, z[r]); });
  }
};

/// The kernel for windows of N pixels a side in the arithmetic T.
template <class T, class Pixel>
Kernel fourier_kernel_of(int n, Measure measure) {
  return with_size(n, [&](auto size) {
    using Implementation = std::conditional_t<(size < 32), FourierLanes<size, T, Pixel>,
                                              FourierStrips<size, T, Pixel>>;
    return kernel_of<Implementation>(measure);
  });
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
