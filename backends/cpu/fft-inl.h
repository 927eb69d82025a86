// SPDX-License-Identifier: Apache-2.0
// One-dimensional Fourier transforms, one per lane: N points are N registers, or what is left of
// them in the first-level cache between two stages.
#if defined(FATHOM_CPU_FFT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FFT_INL_H_
#undef FATHOM_CPU_FFT_INL_H_
#else
#define FATHOM_CPU_FFT_INL_H_
#endif

#include "backends/cpu/simd-inl.h"
#include "backends/cpu/tables.hpp"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// A complex number per lane.
template <class D>
struct Complex {
  Vec<D> re, im;
};

template <class D>
HWY_INLINE HWY_ATTR Pair<Complex<D>> butterfly(Complex<D> a, Complex<D> b) {
  return {{hn::Add(a.re, b.re), hn::Add(a.im, b.im)}, {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)}};
}

/// Which units do the sums. Transforms have more sums than products; some processors have units for
/// either, and half of them would idle. What follows a transform may keep the multipliers busy.
enum class Sums { on_adders, shared_with_multipliers };

/// a + b and a - b, if wished by fused multiply-add: a * 1 + b is a + b to the last bit.
///
/// Only some sums go to the multipliers, 12 of the 44 of eight points. In the first stage over
/// pixels either kind of unit then has 64 operations: adders the other 32, 16 to make pixels float
/// and 16 for the mean; multipliers also 16 for the taper, 8 fused ones and 28 for twiddles.
template <Sums kSums, class D>
HWY_INLINE HWY_ATTR Pair<Complex<D>> shared_butterfly(D d, Complex<D> a, Complex<D> b) {
  if constexpr (kSums == Sums::on_adders) return butterfly<D>(a, b);
#if HWY_NATIVE_FMA
  const auto one = hn::Set(d, hn::TFromD<D>{1});
  return {{hn::MulAdd(a.re, one, b.re), hn::MulAdd(a.im, one, b.im)},
          {hn::NegMulAdd(b.re, one, a.re), hn::NegMulAdd(b.im, one, a.im)}};
#else
  (void)d;
  return butterfly<D>(a, b);
#endif
}

/// a + b and a - b, with b turned by -i.
template <class D>
HWY_INLINE HWY_ATTR Pair<Complex<D>> butterfly_minus_i(Complex<D> a, Complex<D> b) {
  return {{hn::Add(a.re, b.im), hn::Sub(a.im, b.re)}, {hn::Sub(a.re, b.im), hn::Add(a.im, b.re)}};
}

/// The transform of R points, X(q) = SUM x(r) exp(-2 pi i q r/R), in place.
template <int R, Sums kSums, class D>
HWY_INLINE HWY_ATTR void small_fft(D d, Complex<D> (&x)[R]) {
  if constexpr (R == 4) {
    const auto [a, c] = shared_butterfly<kSums>(d, x[0], x[2]);
    const auto [b, e] = butterfly<D>(x[1], x[3]);
    const auto [x0, x2] = butterfly<D>(a, b);
    const auto [x1, x3] = butterfly_minus_i<D>(c, e);
    x[0] = x0, x[1] = x1, x[2] = x2, x[3] = x3;
  } else {
    static_assert(R == 8);
    Complex<D> even[4] = {x[0], x[2], x[4], x[6]};
    Complex<D> odd[4] = {x[1], x[3], x[5], x[7]};
    small_fft<4, kSums>(d, even);
    small_fft<4, kSums>(d, odd);
    const auto [x0, x4] = shared_butterfly<kSums>(d, even[0], odd[0]);
    const auto [x2, x6] = butterfly_minus_i<D>(even[2], odd[2]);
    // odd[1] is turned by exp(-i pi/4) = s (1 - i), odd[3] by exp(-3 i pi/4) = -s (1 + i); the
    // factor s joins the addition that follows.
    const auto s = hn::Set(d, static_cast<hn::TFromD<D>>(0.70710678118654752440));
    const auto p = hn::Add(odd[1].re, odd[1].im), m = hn::Sub(odd[1].im, odd[1].re);
    x[1] = {hn::MulAdd(s, p, even[1].re), hn::MulAdd(s, m, even[1].im)};
    x[5] = {hn::NegMulAdd(s, p, even[1].re), hn::NegMulAdd(s, m, even[1].im)};
    const auto p3 = hn::Sub(odd[3].im, odd[3].re), m3 = hn::Add(odd[3].re, odd[3].im);
    x[3] = {hn::MulAdd(s, p3, even[3].re), hn::NegMulAdd(s, m3, even[3].im)};
    x[7] = {hn::NegMulAdd(s, p3, even[3].re), hn::MulAdd(s, m3, even[3].im)};
    x[0] = x0, x[2] = x2, x[4] = x4, x[6] = x6;
  }
}

/// z times the root of unity that a table holds as re, im.
template <class D>
HWY_INLINE HWY_ATTR Complex<D> rotate(D d, Complex<D> z, const hn::TFromD<D>* HWY_RESTRICT root) {
  const auto c = hn::Set(d, root[0]), s = hn::Set(d, root[1]);
  return {hn::NegMulAdd(z.im, s, hn::Mul(z.re, c)), hn::MulAdd(z.re, s, hn::Mul(z.im, c))};
}

/// N complex registers in memory: real part, imaginary part, real part, ..
template <int N, class D>
class Column {
 public:
  using T = hn::TFromD<D>;
  static constexpr int kSize = 2 * N * kLanes<D>;  ///< Numbers that it takes.

  explicit Column(T* HWY_RESTRICT memory) : memory_(memory) {}

  HWY_INLINE HWY_ATTR Complex<D> operator[](int k) const {
    const D d;
    return {hn::Load(d, re(k)), hn::Load(d, im(k))};
  }
  HWY_INLINE HWY_ATTR void set(int k, Complex<D> z) const {
    const D d;
    hn::Store(z.re, d, re(k));
    hn::Store(z.im, d, im(k));
  }
  HWY_INLINE T* re(int k) const { return memory_ + 2 * k * kLanes<D>; }
  HWY_INLINE T* im(int k) const { return memory_ + (2 * k + 1) * kLanes<D>; }

 private:
  T* HWY_RESTRICT memory_;
};

/// One stage by decimation in frequency over M consecutive points: R points M/R apart make R points
/// of R smaller transforms. load(k) gives point k.
template <int M, int R, Sums kSums, class D, class Load, class Store>
HWY_INLINE HWY_ATTR void fft_stage(D d, const hn::TFromD<D>* HWY_RESTRICT twiddle, const Load& load,
                                   const Store& store) {
  constexpr int groups = M / R;
  for (int s = 0; s < groups; ++s, twiddle += 2 * (R - 1)) {
    Complex<D> x[R];
    unroll<R>([&](auto r) FATHOM_LAMBDA { x[r] = load(s + r * groups); });
    small_fft<R, kSums>(d, x);
    store(s, x[0]);
    unroll<R - 1>([&](auto q) FATHOM_LAMBDA {
      store(s + (q + 1) * groups, rotate(d, x[q + 1], twiddle + 2 * q));
    });
  }
}

/// The transform of N points per lane: F(k) = SUM f(x) exp(-2 pi i k x/N). load(x) gives f(x), and
/// may read the column itself. consume(p, F) takes an array of the coefficients of positions p,
/// p+1, .. The column is scratch memory.
template <int N, Sums kSums, class D, class Load, class Consume>
HWY_INLINE HWY_ATTR void fft(D d, const hn::TFromD<D>* HWY_RESTRICT twiddle, Column<N, D> column,
                             const Load& load, const Consume& consume) {
  constexpr Radices stages = radices(N);
  constexpr int first = stages.radix[0], last = stages.radix[stages.count - 1];
  const auto store = [&](int k, Complex<D> z) FATHOM_LAMBDA { column.set(k, z); };
  if constexpr (stages.count > 1) {
    fft_stage<N, first, kSums>(d, twiddle, load, store);
    twiddle += 2 * (first - 1) * (N / first);
  }
  const auto finish = [&](int p) FATHOM_LAMBDA {
    Complex<D> x[last];
    unroll<last>([&](auto r) FATHOM_LAMBDA {
      if constexpr (stages.count > 1) {
        x[r] = column[p + r];
      } else {
        x[r] = load(static_cast<int>(r));
      }
    });
    small_fft<last, kSums>(d, x);
    consume(p, x);
  };
  // One part after the other, so that it stays in the first-level cache to the end.
  constexpr int size = stages.count > 2 ? N / first : N;
  for (int part = 0; part < N; part += size) {
    if constexpr (stages.count > 2) {
      fft_stage<size, stages.radix[1], kSums>(
          d, twiddle, [&](int k) FATHOM_LAMBDA { return column[part + k]; },
          [&](int k, Complex<D> z) FATHOM_LAMBDA { column.set(part + k, z); });
    }
    for (int p = part; p < part + size; p += last) finish(p);
  }
}

/// The mean of eight samples, one of each eighth, weighted as the taper will weight them: of a
/// smooth picture's mean near enough, and of no picture far off beside its own contrast. Without a
/// taper the weights are 1/8 and, summed in pairs, the mean of equal numbers is that number to the
/// last bit.
template <int N, class D, class Load>
HWY_INLINE HWY_ATTR Complex<D> sampled_mean(D d, const hn::TFromD<D>* HWY_RESTRICT weight,
                                            const Load& load) {
  constexpr int step = N / 8;
  Complex<D> sample[8];
  unroll<8>([&](auto k) FATHOM_LAMBDA {
    const Complex<D> z = load(step / 2 + k * step);
    const auto w = hn::Set(d, weight[k]);
    sample[k] = {hn::Mul(z.re, w), hn::Mul(z.im, w)};
  });
  unroll<3>([&](auto level) FATHOM_LAMBDA {
    constexpr int pairs = 4 >> level;
    unroll<pairs>([&](auto k) FATHOM_LAMBDA {
      sample[k] = {hn::Add(sample[2 * k].re, sample[2 * k + 1].re),
                   hn::Add(sample[2 * k].im, sample[2 * k + 1].im)};
    });
  });
  return sample[0];
}

/// The transform of w(x) (f(x) - m), m a constant near the mean of each lane by itself
/// (docs/metrics.md, "The mean apart"): rows and columns that are flat, or differ only by a
/// constant, then have nothing for rounding to spread over the spectrum. consume(p, F, m): m N
/// W(k), the transform of the constant, is the caller's to add.
template <int N, Sums kSums, class D, class Load, class Consume>
HWY_INLINE HWY_ATTR void tapered_fft(D d, const FourierTables<hn::TFromD<D>>& tables,
                                     Column<N, D> column, const Load& load,
                                     const Consume& consume) {
  const Complex<D> mean = sampled_mean<N>(d, tables.sample_weight.data(), load);
  const hn::TFromD<D>* HWY_RESTRICT taper = tables.taper.data();
  fft<N, kSums>(
      d, tables.twiddle.data(), column,
      [&](int k) FATHOM_LAMBDA {
        const Complex<D> z = load(k);
        const auto w = hn::Set(d, taper[k]);
        return Complex<D>{hn::Mul(hn::Sub(z.re, mean.re), w), hn::Mul(hn::Sub(z.im, mean.im), w)};
      },
      [&](int p, auto& x) FATHOM_LAMBDA { consume(p, x, mean); });
}

/// Whether any of positions p .. p+R-1 belongs to the transform of a constant: for most tapers few.
template <int R, class T>
HWY_INLINE bool is_touched(const FourierTables<T>& tables, int p) {
  std::uint64_t any = 0;
  static_assert(R <= sizeof any);
  std::memcpy(&any, tables.is_touched.data() + p, R);
  return any != 0;
}

/// Adds a constant's transform, m N W(k), to coefficients p .. p+R-1.
template <int R, class D>
HWY_INLINE HWY_ATTR void add_constant(D d, const FourierTables<hn::TFromD<D>>& tables, int p,
                                      Complex<D> m, Complex<D> (&x)[R]) {
  unroll<R>([&](auto r) FATHOM_LAMBDA {
    const auto re = hn::Set(d, tables.flat_re[p + r]), im = hn::Set(d, tables.flat_im[p + r]);
    x[r].re = hn::NegMulAdd(m.im, im, hn::MulAdd(m.re, re, x[r].re));
    x[r].im = hn::MulAdd(m.im, re, hn::MulAdd(m.re, im, x[r].im));
  });
}

/// Twice the spectra of two real sequences.
template <class D>
struct RealPair {
  Complex<D> a, b;
};

/// Takes the spectra of a and b out of that of z = a + i b: A(k) = (z(k) + z(-k)*)/2, i B(k) =
/// (z(k) - z(-k)*)/2.
template <class D>
HWY_INLINE HWY_ATTR RealPair<D> take_apart(D, Complex<D> z, Complex<D> mirrored) {
  return {{hn::Add(z.re, mirrored.re), hn::Sub(z.im, mirrored.im)},
          {hn::Add(z.im, mirrored.im), hn::Sub(mirrored.re, z.re)}};
}

/// The same, and adds the transforms of the two constants in m at position p of k. Not before the
/// spectra are apart: rounded together, two equal sequences would get unequal constants.
template <class D>
HWY_INLINE HWY_ATTR RealPair<D> take_apart(D d, Complex<D> z, Complex<D> mirrored, Complex<D> m,
                                           const FourierTables<hn::TFromD<D>>& tables, int p) {
  RealPair<D> pair = take_apart(d, z, mirrored);
  const auto re = hn::Set(d, 2 * tables.flat_re[p]), im = hn::Set(d, 2 * tables.flat_im[p]);
  pair.a = {hn::MulAdd(m.re, re, pair.a.re), hn::MulAdd(m.re, im, pair.a.im)};
  pair.b = {hn::MulAdd(m.im, re, pair.b.re), hn::MulAdd(m.im, im, pair.b.im)};
  return pair;
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
