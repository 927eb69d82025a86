// SPDX-License-Identifier: Apache-2.0
// The Fourier kernels: from pixels to the moment of inertia of the spectrum (thesis eqs. 3-10 and
// 5-1), nothing in between leaving the cache. Compiled once per instruction set.
//
// Windows of 32 and more, one at a time, lanes = columns:
//
//   columns   every two columns of pixels, N/2 apart, are one complex column: z = a + i b. Taper,
//             transform over y.
//   turn      take the two real columns' spectra apart, A(v) = (z(v) + z(-v)*)/2 and B likewise,
//   for
//             v >= 0 only, and swap lanes with registers: lanes = v.
//   rows      taper, transform over x, magnitudes, lever arms.
//
// The row v = 0 would be one lane too many. It is put aside, and those of a block of windows are
// transformed side by side.
//
// Windows of 8 and 16, sixteen at a time, lanes = windows: the same without a turn.
//
// 8-bit pixels are computed in float: an error of 1e-7 of a window's contrast stands against the
// half grey level by which its pixels are rounded. 16-bit pixels need double.
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/fourier.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/fft-inl.h"
#include "backends/cpu/pixels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

template <class T>
const FourierTables<T>& fourier_tables(const Tables& tables) {
  if constexpr (std::is_same_v<T, float>) {
    return *tables.fourier_float;
  } else {
    return *tables.fourier_double;
  }
}

/// To a relative error of 1e-7 in float.
template <class V>
HWY_INLINE HWY_ATTR V square_root(V p) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  // The estimate 1/sqrt(p) to 14 bits and one Newton step, on units that are free meanwhile; the
  // square root itself takes ten cycles a register. sqrt(0) is 0 * a large number.
  if constexpr (std::is_same_v<hn::TFromV<V>, float>) {
    const hn::DFromV<V> d;
    const auto y = hn::ApproximateReciprocalSqrt(hn::Max(p, hn::Set(d, 1e-30F)));
    const auto root = hn::Mul(p, y), half = hn::Mul(y, hn::Set(d, 0.5F));
    const auto error = hn::NegMulAdd(root, half, hn::Set(d, 0.5F));
    return hn::MulAdd(root, error, root);
  }
#endif
  return hn::Sqrt(p);
}

/// |F| or |F|^2 of R coefficients, zero outside the band.
template <int R, class D>
HWY_INLINE HWY_ATTR void masses(D, const Complex<D> (&coefficients)[R], bool power,
                                Vec<D> (&mass)[R]) {
  unroll<R>([&](auto r) FATHOM_LAMBDA {
    const auto& z = coefficients[r];
    mass[r] = hn::MulAdd(z.re, z.re, hn::Mul(z.im, z.im));
  });
  if (power) return;
  unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = square_root(mass[r]); });
}

/// Adds the lanes to as many doubles.
template <class D>
HWY_INLINE HWY_ATTR void add_lanes(D d, Vec<D> v, double* HWY_RESTRICT sums) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {
    const hn::Half<D> half;
    const hn::Rebind<double, decltype(half)> wide;
    double* const upper = sums + kLanes<D> / 2;
    hn::Store(hn::Add(hn::Load(wide, sums), hn::PromoteTo(wide, hn::LowerHalf(half, v))), wide,
              sums);
    hn::Store(hn::Add(hn::Load(wide, upper), hn::PromoteTo(wide, hn::UpperHalf(half, v))), wide,
              upper);
  } else {
    hn::Store(hn::Add(hn::Load(d, sums), v), d, sums);
  }
}

/// phi = 1/N^4 1/2 SUM |F| r^2, where F is what a kernel has, times 1/(2 N^2). With `power` the
/// factor of F counts twice. All are powers of two and exact.
double fourier_scale(const MetricSpec& spec) {
  const double n = spec.n;
  const double coefficient = 1 / (2 * n * n);
  return (spec.power ? coefficient * coefficient : coefficient) / (n * n * n * n);
}

/// Puts F(u, v) and, since pixels are real, its mirror image where Plan::spectrum wants them.
void place_coefficient(std::complex<double> f, int u, int v, int n,
                       std::span<std::complex<double>> coefficients) {
  const int half = n / 2, mask = n - 1;
  const double scale = 1.0 / (2.0 * n * n);
  const auto at = [&](int row, int col) -> auto& {
    return coefficients[static_cast<std::size_t>((row + half) & mask) * n + ((col + half) & mask)];
  };
  at(-v, -u) = std::conj(f) * scale;
  at(v, u) = f * scale;
}

// ------------------------------------------------------------------------- N = 32 .. 512

template <int N, class T, class Pixel>
class FourierStrips {
  using D = hn::CappedTag<T, 16>;
  static constexpr int kHalf = N / 2;
  static constexpr int kStrips = kHalf / kLanes<D>;  ///< Registers to a row of packed columns.

  struct Scratch {
    alignas(64) T columns[kStrips][Column<N, D>::kSize];  ///< Spectra of columns, by position of v.
    Complex<D> means[kStrips];                            ///< What they were taken about.
    alignas(64) T rows[Column<N, D>::kSize];              ///< Turned: [x][v], a strip of v.
    alignas(64) T axis[kBlock][N];                        ///< [window][x], the row v = 0.
    alignas(64) double sums[kBlock];
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void score(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> scores,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const double scale = fourier_scale(tables.spec);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      columns(constants, WindowPixels<Pixel>(frame, windows[w]), memory);
      keep_axis(constants, memory, memory.axis[w]);
      scores[w] = scale * half_plane_moment(constants, tables.spec.power, memory);
    }
    add_axes(constants, tables.spec.power, scale, scores, memory);
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    columns(constants, WindowPixels<Pixel>(frame, window), memory);
    const auto place = [&](int p, const auto& x, int lanes, int first_v) {
      constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
      for (int r = 0; r < count; ++r) {
        alignas(64) T re[kLanes<D>], im[kLanes<D>];
        hn::Store(x[r].re, D(), re);
        hn::Store(x[r].im, D(), im);
        for (int lane = 0; lane < lanes; ++lane) {
          place_coefficient({re[lane], im[lane]}, constants.frequency[p + r], first_v + lane, N,
                            coefficients);
        }
      }
    };
    keep_axis(constants, memory, memory.axis[0]);
    for (int strip = 0; strip < kStrips; ++strip) {
      turn_strip(constants, strip, memory);
      transform_rows(constants, memory, [&](int p, const auto& x) HWY_ATTR {
        place(p, x, kLanes<D>, 1 + strip * kLanes<D>);
      });
    }
    turn_axes(0, memory);
    transform_rows(constants, memory, [&](int p, const auto& x) HWY_ATTR { place(p, x, 1, 0); });
  }

 private:
  /// Spectra over y of the packed columns.
  static HWY_NOINLINE HWY_ATTR void columns(const FourierTables<T>& constants,
                                            const WindowPixels<Pixel>& pixels, Scratch& memory) {
    const D d;
    for (int strip = 0; strip < kStrips; ++strip) {
      const Column<N, D> column(memory.columns[strip]);
      const int x = strip * kLanes<D>;
      tapered_fft<N>(
          d, constants, column,
          [&](int y) FATHOM_LAMBDA {
            return Complex<D>{pixels.load(d, x, y), pixels.load(d, x + kHalf, y)};
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

  /// Twice the real row v = 0.
  static HWY_ATTR void keep_axis(const FourierTables<T>& constants, Scratch& memory, T* axis) {
    const D d;
    const int p = constants.position[0];
    for (int strip = 0; strip < kStrips; ++strip) {
      const Complex<D> z = Column<N, D>(memory.columns[strip])[p];
      const auto [a, b] = take_apart(d, z, z, memory.means[strip], constants, p);
      hn::Store(a.re, d, axis + strip * kLanes<D>);
      hn::Store(b.re, d, axis + kHalf + strip * kLanes<D>);
    }
  }

  /// Turns a square of registers and stores it, kStride registers apart.
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
      const auto turn_part = [&](const auto& part, T* out) FATHOM_LAMBDA {
        Vec<D> square[kLanes<D>];
        unroll<kLanes<D>>([&](auto i) FATHOM_LAMBDA {
          if constexpr (kTouched) {
            square[i] =
                part(take_apart(d, z[position[i]], z[mirrored[-i]], mean, constants, position[i]));
          } else {
            square[i] = part(take_apart(d, z[position[i]], z[mirrored[-i]]));
          }
        });
        turn_and_store<2>(square, out);
      };
      using Parts = const RealPair<D>&;
      const int x = source * kLanes<D>;
      turn_part([](Parts pair) FATHOM_LAMBDA { return pair.a.re; }, rows.re(x));
      turn_part([](Parts pair) FATHOM_LAMBDA { return pair.a.im; }, rows.im(x));
      turn_part([](Parts pair) FATHOM_LAMBDA { return pair.b.re; }, rows.re(kHalf + x));
      turn_part([](Parts pair) FATHOM_LAMBDA { return pair.b.im; }, rows.im(kHalf + x));
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_rows(const FourierTables<T>& constants, Scratch& memory,
                                                 const Consume& consume) {
    const Column<N, D> rows(memory.rows);
    tapered_fft<N>(
        D(), constants, rows, [&](int x) FATHOM_LAMBDA { return rows[x]; },
        [&](int p, auto& x, Complex<D> mean) FATHOM_LAMBDA {
          add_constant(D(), constants, p, mean, x);
          consume(p, x);
        });
  }

  /// The moment about both axes of what memory.rows holds, per lane: SUM m (u^2 + v^2), where
  /// squared_v is each lane's v^2. mask: [position of u] of the lanes, a row every N/2 + 1, or
  /// null.
  static HWY_INLINE HWY_ATTR Vec<D> moment(const FourierTables<T>& constants, bool power,
                                           Vec<D> squared_v, const T* HWY_RESTRICT mask,
                                           bool same_mask, Scratch& memory) {
    const D d;
    const T* HWY_RESTRICT arm = constants.arm.data();
    auto mass_sum = hn::Zero(d), u_moment = hn::Zero(d);
    transform_rows(constants, memory, [&](int p, const auto& x) FATHOM_LAMBDA {
      constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
      Vec<D> mass[count];
      masses(d, x, power, mass);
      if (mask != nullptr) {
        for (int r = 0; r < count; ++r) {
          const T* const row = mask + (p + r) * (kHalf + 1);
          mass[r] = hn::Mul(mass[r], same_mask ? hn::Set(d, *row) : hn::LoadU(d, row));
        }
      }
      unroll<count>([&](auto r) FATHOM_LAMBDA {
        mass_sum = hn::Add(mass_sum, mass[r]);
        u_moment = hn::MulAdd(mass[r], hn::Set(d, arm[p + r]), u_moment);
      });
    });
    return hn::MulAdd(mass_sum, squared_v, u_moment);
  }

  /// SUM over v = 1 .. N/2 of the moments of the rows.
  static HWY_NOINLINE HWY_ATTR double half_plane_moment(const FourierTables<T>& constants,
                                                        bool power, Scratch& memory) {
    const D d;
    alignas(64) double sums[kLanes<D>] = {};
    const T* const mask = constants.mask.empty() ? nullptr : constants.mask.data();
    for (int strip = 0; strip < kStrips; ++strip) {
      const int v = 1 + strip * kLanes<D>;
      turn_strip(constants, strip, memory);
      const auto rows_moment = moment(constants, power, hn::LoadU(d, constants.axis_arm.data() + v),
                                      mask == nullptr ? nullptr : mask + v, false, memory);
      add_lanes(d, hn::Mul(rows_moment, hn::LoadU(d, constants.half_plane.data() + v)), sums);
    }
    double total = 0;
    for (const double sum : sums) total += sum;
    return total;
  }

  /// Rows v = 0 of `lanes` windows: lanes x become lanes w.
  static HWY_ATTR void turn_axes(int first_window, Scratch& memory) {
    const D d;
    const Column<N, D> rows(memory.rows);
    for (int x = 0; x < N; x += kLanes<D>) {
      Vec<D> square[kLanes<D>];
      unroll<kLanes<D>>([&](auto i) FATHOM_LAMBDA {
        square[i] = hn::Load(d, memory.axis[first_window + i] + x);
      });
      turn_and_store<2>(square, rows.re(x));
    }
    for (int x = 0; x < N; ++x) hn::Store(hn::Zero(d), d, rows.im(x));
  }

  /// The moments of the rows v = 0, half of which stand in half of the plane.
  static HWY_NOINLINE HWY_ATTR void add_axes(const FourierTables<T>& constants, bool power,
                                             double scale, std::span<double> scores,
                                             Scratch& memory) {
    const D d;
    const int count = static_cast<int>(scores.size());
    const T* const mask = constants.mask.empty() ? nullptr : constants.mask.data();
    for (int w = count; w < kBlock; ++w) std::memset(memory.axis[w], 0, sizeof memory.axis[w]);
    for (int first = 0; first < count; first += kLanes<D>) {
      turn_axes(first, memory);
      std::memset(memory.sums, 0, sizeof memory.sums);
      add_lanes(d, moment(constants, power, hn::Zero(d), mask, true, memory), memory.sums);
      for (int lane = 0; lane < kLanes<D> && first + lane < count; ++lane) {
        scores[first + lane] += scale * 0.5 * memory.sums[lane];
      }
    }
  }
};

// ---------------------------------------------------------------------------- N = 8 and 16

template <int N, class T, class Pixel>
class FourierBlock {
  using D = hn::CappedTag<T, 16>;
  static constexpr int kHalf = N / 2;

  struct Scratch {
    alignas(64) Pixel pixels[N][N][kBlock];
    alignas(64) T packed[Column<N, D>::kSize];              ///< Spectrum of two rows, over x.
    alignas(64) T columns[kHalf + 1][Column<N, D>::kSize];  ///< [u][y].
    alignas(64) double sums[kBlock];
  };

 public:
  static constexpr std::size_t kScratchBytes = sizeof(Scratch);

  static HWY_ATTR void score(const Tables& tables, const Frame& frame,
                             std::span<const Window> windows, std::span<double> scores,
                             std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    const double scale = fourier_scale(tables.spec);
    gather_block<N>(frame, windows, &memory.pixels[0][0][0]);
    std::memset(memory.sums, 0, sizeof memory.sums);
    for (std::size_t first = 0; first < windows.size(); first += kLanes<D>) {
      rows(constants, static_cast<int>(first), memory);
      for (int u = 0; u <= kHalf; ++u) {
        add_moment(constants, u, tables.spec.power, memory.sums + first, memory);
      }
    }
    for (std::size_t w = 0; w < windows.size(); ++w) scores[w] = scale * memory.sums[w];
  }

  static HWY_ATTR void spectrum(const Tables& tables, const Frame& frame, const Window& window,
                                std::span<std::complex<double>> coefficients, std::byte* scratch) {
    auto& memory = *reinterpret_cast<Scratch*>(scratch);
    const FourierTables<T>& constants = fourier_tables<T>(tables);
    gather_block<N>(frame, {&window, 1}, &memory.pixels[0][0][0]);
    rows(constants, 0, memory);
    for (int u = 0; u <= kHalf; ++u) {
      transform_column(constants, u, memory, [&](int p, const auto& x) HWY_ATTR {
        constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
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
      tapered_fft<N>(
          d, constants, packed,
          [&](int x) FATHOM_LAMBDA {
            return Complex<D>{
                WindowPixels<Pixel>::widen(d, hn::Load(d_pixel, memory.pixels[y][x] + first)),
                WindowPixels<Pixel>::widen(d,
                                           hn::Load(d_pixel, memory.pixels[y + kHalf][x] + first))};
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
        column.set(y + kHalf, b);
      }
    }
  }

  template <class Consume>
  static HWY_INLINE HWY_ATTR void transform_column(const FourierTables<T>& constants, int u,
                                                   Scratch& memory, const Consume& consume) {
    const Column<N, D> column(memory.columns[u]);
    tapered_fft<N>(
        D(), constants, column, [&](int y) FATHOM_LAMBDA { return column[y]; },
        [&](int p, auto& x, Complex<D> mean) FATHOM_LAMBDA {
          add_constant(D(), constants, p, mean, x);
          consume(p, x);
        });
  }

  /// SUM over v of m(u, v) (u^2 + v^2), as often as column u stands in half of the plane.
  static HWY_NOINLINE HWY_ATTR void add_moment(const FourierTables<T>& constants, int u, bool power,
                                               double* sums, Scratch& memory) {
    const D d;
    auto sum = hn::Zero(d);
    const T squared_u = constants.axis_arm[u];
    const bool has_band = !constants.mask.empty();
    transform_column(constants, u, memory, [&](int p, const auto& x) FATHOM_LAMBDA {
      constexpr int count = std::extent_v<std::remove_reference_t<decltype(x)>>;
      Vec<D> mass[count];
      masses(d, x, power, mass);
      unroll<count>([&](auto r) FATHOM_LAMBDA {
        T weight = constants.arm[p + r] + squared_u;
        if (has_band) weight *= constants.mask[(p + r) * (kHalf + 1) + u];
        sum = hn::MulAdd(mass[r], hn::Set(d, weight), sum);
      });
    });
    add_lanes(d, hn::Mul(sum, hn::Set(d, constants.half_plane[u])), sums);
  }
};

template <int N, class T, class Pixel>
Kernel kernel_of() {
  using Implementation =
      std::conditional_t<(N < 32), FourierBlock<N, T, Pixel>, FourierStrips<N, T, Pixel>>;
  return {&Implementation::score, &Implementation::spectrum, Implementation::kScratchBytes};
}

template <class T, class Pixel>
Kernel kernel_of(int n) {
  switch (n) {
    case 8:
      return kernel_of<8, T, Pixel>();
    case 16:
      return kernel_of<16, T, Pixel>();
    case 32:
      return kernel_of<32, T, Pixel>();
    case 64:
      return kernel_of<64, T, Pixel>();
    case 128:
      return kernel_of<128, T, Pixel>();
    case 256:
      return kernel_of<256, T, Pixel>();
    default:
      return kernel_of<512, T, Pixel>();
  }
}

}  // namespace

Kernel fourier_kernel(const MetricSpec& spec, Depth depth) {
  return depth == Depth::bits8 ? kernel_of<float, std::uint8_t>(spec.n)
                               : kernel_of<double, std::uint16_t>(spec.n);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
