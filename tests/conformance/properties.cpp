// SPDX-License-Identifier: Apache-2.0
// What the transforms must do whatever the numbers: Parseval, linearity, impulse, constant, shift,
// the relation between the Walsh orders, and that a score is the moment of the spectrum.
#include <gtest/gtest.h>

#include "engine/measure.hpp"
#include "tests/conformance/spectra.hpp"
#include "tests/conformance/suite.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

using test::score_matches;
using test::spectrum_matches;
using test::within;

bool is_real(const MetricSpec& spec) {
  return family_of(spec.transform) != TransformFamily::fourier;
}

/// Value of function i of a real transform at sample x.
double basis_at(const MetricSpec& spec, int i, int x) {
  return spec.transform == Transform::dct ? cosine_at(spec, i, x) : walsh_at(spec, i, x);
}

class Properties : public Conformance {
 protected:
  ::testing::AssertionResult agrees(const MetricSpec& spec, const Spectrum& got,
                                    const Spectrum& expected, double least_norm = 0) const {
    return spectrum_matches(got.values(), expected.values(), tolerance(spec), least_norm);
  }
};
FATHOM_EVERY_DEVICE(Properties);

const std::vector<std::string> kEverySpectrum = {"fft:8:none",
                                                 "fft:16:hann",
                                                 "fft:64:tukey=0.25",
                                                 "fft:64:none",
                                                 "fft:128:hann",
                                                 "walsh-paley:8",
                                                 "walsh-sequency:8",
                                                 "walsh-hadamard:8",
                                                 "walsh-paley:64",
                                                 "walsh-sequency:64",
                                                 "walsh-hadamard:64",
                                                 "walsh-sequency:16:hann",
                                                 "walsh-paley:128",
                                                 "walsh-hadamard:32:tukey=0.25",
                                                 "dct:8",
                                                 "dct:64",
                                                 "dct:128"};
const std::vector<std::string> kUntaperedWalsh = {
    "walsh-paley:8",     "walsh-sequency:8",  "walsh-hadamard:8",  "walsh-paley:64",
    "walsh-sequency:64", "walsh-hadamard:64", "walsh-sequency:128"};
const std::vector<std::string> kUntaperedFourier = {"fft:8:none", "fft:16:none", "fft:64:none"};

// SUM |F|^2 = 1/N^2 SUM (w w f)^2, and the same for W.
TEST_P(Properties, Parseval) {
  auto specs = kEverySpectrum;
  specs.insert(specs.end(), {"fft:256:none", "walsh-sequency:512", "dct:256"});
  each(cases(specs, {"random8", "natural16", "binary16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const Frame frame = tested.frame();
    double in_picture = 0, in_spectrum = 0;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        in_picture +=
            std::pow(taper_at(tested.spec, x) * taper_at(tested.spec, y) * frame.at(x, y), 2);
      }
    }
    const Spectrum spectrum = spectrum_of(plan, frame);
    for (const Coefficient& c : spectrum.values()) in_spectrum += std::norm(c);
    ASSERT_GT(in_picture, 0);
    // Doubles are added here, so not even exact spectra give the last bit.
    const double part = std::max(2 * tolerance(tested.spec), 1e-12);
    EXPECT_TRUE(within(in_spectrum * n * n, in_picture, part * in_picture));
  });
}

TEST_P(Properties, Linearity) {
  each(cases(kEverySpectrum, {"random8", "natural16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    test::Pixels a = tested.pixels(n, n), sum = a;
    test::Pixels b = test::make_pixels("ramp", tested.bits, n, n, 0);
    for (auto& value : a.values) value /= 4;
    for (auto& value : b.values) value /= 4;
    for (std::size_t k = 0; k < sum.values.size(); ++k) {
      sum.values[k] = static_cast<std::uint16_t>(3 * a.values[k] + b.values[k]);
    }
    Spectrum expected = spectrum_of(plan, test::to_frame(a));
    const Spectrum of_b = spectrum_of(plan, test::to_frame(b));
    for (std::size_t k = 0; k < expected.values().size(); ++k) {
      expected.values()[k] = 3.0 * expected.values()[k] + of_b.values()[k];
    }
    EXPECT_TRUE(agrees(tested.spec, spectrum_of(plan, test::to_frame(sum)), expected));
  });
}

// A single pixel has the same magnitude everywhere, with the phase (or the signs) of its place.
TEST_P(Properties, Impulse) {
  each(cases(kEverySpectrum, {"impulse8", "impulse16"}), 1, [&](const Case& tested, Plan& plan) {
    const MetricSpec& spec = tested.spec;
    const int n = spec.n;
    for (const auto& [px, py] : {std::pair(0, 0), {n - 1, 0}, {n / 2, n / 4 + 1}, {3, n - 1}}) {
      test::Pixels pixels = test::make_pixels("zero", tested.bits, n, n, 0);
      pixels.at(px, py) = static_cast<std::uint16_t>(pixels.largest());
      const double height =
          pixels.largest() * taper_at(spec, px) * taper_at(spec, py) / (double(n) * n);
      Spectrum expected(n);
      for (int row = 0; row < n; ++row) {
        for (int col = 0; col < n; ++col) {
          expected.at(row, col) =
              is_real(spec)
                  ? Coefficient(height * basis_at(spec, row, py) * basis_at(spec, col, px))
                  : height * turned(-double((col - n / 2) * px + (row - n / 2) * py) / n);
        }
      }
      // In a corner the taper leaves next to nothing; rounding is relative to what stood there.
      const double untapered_norm = pixels.largest() / double(n);
      EXPECT_TRUE(agrees(spec, spectrum_of(plan, test::to_frame(pixels)), expected, untapered_norm))
          << "pixel at " << px << "," << py;
    }
  });
}

// A constant is zero frequency alone, spread by the taper: by hann to exactly 3 x 3 coefficients.
TEST_P(Properties, Constant) {
  each(cases({"fft:8:none", "fft:64:none", "fft:16:hann", "fft:64:hann", "walsh-paley:64",
              "walsh-sequency:64", "walsh-hadamard:8", "dct:8", "dct:64"},
             {"flat8", "full16"}),
       1, [&](const Case& tested, Plan& plan) {
         const MetricSpec& spec = tested.spec;
         const Frame frame = tested.frame();
         const double level = frame.at(0, 0);
         Spectrum expected(spec.n);
         if (is_real(spec)) {
           expected.at(0, 0) = level;
         } else if (spec.taper == Taper::none()) {
           expected.frequency(0, 0) = level;
         } else {
           const auto w = [&](int u) {
             return u == 0 ? Coefficient(0.5) : -0.25 * turned(u * 0.5 / spec.n);
           };
           for (int v = -1; v <= 1; ++v) {
             for (int u = -1; u <= 1; ++u) expected.frequency(u, v) = level * w(u) * w(v);
           }
         }
         EXPECT_TRUE(agrees(spec, spectrum_of(plan, frame), expected));
       });
}

// Windows of a picture that repeats every N pixels are circular shifts of each other.
TEST_P(Properties, CircularShiftTurnsThePhaseOfTheFourierSpectrum) {
  each(cases(kUntaperedFourier, {"natural8", "random16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const test::Pixels tile = tested.pixels(n, n);
    test::Pixels repeated = test::make_pixels("zero", tested.bits, 2 * n, 2 * n, 0);
    for (int y = 0; y < 2 * n; ++y) {
      for (int x = 0; x < 2 * n; ++x) repeated.at(x, y) = tile.at(x % n, y % n);
    }
    const Frame frame = test::to_frame(repeated);
    const Spectrum original = spectrum_of(plan, frame, {0, 0, n});
    for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}, {n / 2, 3}, {n - 1, n}}) {
      Spectrum expected(n);
      for (int v = -n / 2; v < n / 2; ++v) {
        for (int u = -n / 2; u < n / 2; ++u) {
          expected.frequency(u, v) = original.frequency(u, v) * turned(double(u * dx + v * dy) / n);
        }
      }
      const Window shifted{dx, dy, n};
      EXPECT_TRUE(agrees(tested.spec, spectrum_of(plan, frame, shifted), expected))
          << "shift " << dx << "," << dy;
      EXPECT_TRUE(score_matches(plan.score(frame, shifted), plan.score(frame, {0, 0, n}),
                                tested.spec, 2 * tolerance(tested.spec)));
    }
  });
}

// A window and its mirror images have the same cosine coefficients but for the signs of the odd ones.
TEST_P(Properties, MirrorImagesTurnSignsOfTheCosineSpectrum) {
  each(cases({"dct:8", "dct:64", "dct:16:entropy"}, {"natural8", "random16"}), 1,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const test::Pixels pixels = tested.pixels(n, n);
         test::Pixels mirrored = pixels;
         Spectrum expected = spectrum_of(plan, test::to_frame(pixels));
         for (int y = 0; y < n; ++y) {
           for (int x = 0; x < n; ++x) {
             mirrored.at(x, y) = pixels.at(n - 1 - x, y);
             if (x % 2 == 1) expected.at(y, x) = -expected.at(y, x);
           }
         }
         const Frame frame = test::to_frame(mirrored);
         EXPECT_TRUE(agrees(tested.spec, spectrum_of(plan, frame), expected));
         EXPECT_TRUE(score_matches(plan.score(frame, {0, 0, n}),
                                   plan.score(test::to_frame(pixels), {0, 0, n}), tested.spec,
                                   2 * tolerance(tested.spec)));
       });
}

// f(x xor k) multiplies W(i) by wal_i(k): no magnitude changes, so no bit of the score does.
TEST_P(Properties, DyadicShiftTurnsSignsOfTheWalshSpectrum) {
  each(cases(kUntaperedWalsh, {"natural8", "random16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const test::Pixels pixels = tested.pixels(n, n);
    const Spectrum original = spectrum_of(plan, test::to_frame(pixels));
    const double score = plan.score(test::to_frame(pixels), {0, 0, n});
    for (const auto& [kx, ky] : {std::pair(1, 0), {0, n / 2}, {n - 1, 5}}) {
      test::Pixels shifted = pixels;
      Spectrum expected(n);
      for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
          shifted.at(x, y) = pixels.at(x ^ kx, y ^ ky);
          expected.at(y, x) = original.at(y, x) * double(walsh_at(tested.spec, y, ky)) *
                              double(walsh_at(tested.spec, x, kx));
        }
      }
      const Frame frame = test::to_frame(shifted);
      EXPECT_TRUE(agrees(tested.spec, spectrum_of(plan, frame), expected));
      EXPECT_TRUE(test::bit_equal(plan.score(frame, {0, 0, n}), score));
    }
  });
}

// Sequency n stands at its Gray code in Paley order, Hadamard n at its bits reversed (thesis T5).
TEST_P(Properties, WalshOrdersHoldTheSameCoefficients) {
  each(cases({"walsh-paley:8", "walsh-paley:16", "walsh-paley:64", "walsh-paley:32:hann"},
             {"random8", "natural16"}),
       1, [&](const Case& tested, Plan& paley_plan) {
         const int n = tested.spec.n;
         const Frame frame = tested.frame();
         const Spectrum paley = spectrum_of(paley_plan, frame);
         const auto reversed = [n](int i) {
           int result = 0;
           for (int bit = 1; bit < n; bit *= 2) result = 2 * result + ((i & bit) != 0);
           return result;
         };
         MetricSpec sequency = tested.spec, hadamard = tested.spec;
         sequency.transform = Transform::walsh_sequency;
         hadamard.transform = Transform::walsh_hadamard;
         Spectrum expected_sequency(n), expected_hadamard(n);
         for (int i = 0; i < n; ++i) {
           for (int j = 0; j < n; ++j) {
             expected_sequency.at(i, j) = paley.at(i ^ (i >> 1), j ^ (j >> 1));
             expected_hadamard.at(i, j) = paley.at(reversed(i), reversed(j));
           }
         }
         const auto check = [&](const MetricSpec& spec, const Spectrum& expected) {
           if (!device().unsupported(spec).empty()) return;
           EXPECT_TRUE(agrees(spec, spectrum_of(*plan(spec, 1), frame), expected)) << spec.text();
         };
         check(sequency, expected_sequency);
         check(hadamard, expected_hadamard);
       });
}

TEST_P(Properties, AScoreIsTheMomentOrTheEntropyOfItsSpectrum) {
  auto specs = typical_specs();
  specs.insert(specs.end(), kEverySpectrum.begin(), kEverySpectrum.end());
  specs.insert(specs.end(), {"fft:64:hann:band=0.1-0.3", "fft:32:none:power:band=0.05-0.5",
                             "walsh-sequency:32:power:band=0.1-0.4"});
  each(cases(specs, {"random8", "natural16"}), 1, [&](const Case& tested, Plan& plan) {
    const Frame frame = tested.frame();
    const Spectrum spectrum = spectrum_of(plan, frame);
    const double expected = tested.spec.measure == Measure::entropy
                                ? entropy_of(tested.spec, spectrum)
                                : moment_of(tested.spec, spectrum);
    ASSERT_GT(expected, 0);
    EXPECT_TRUE(score_matches(plan.score(frame, {0, 0, tested.spec.n}), expected, tested.spec,
                              2 * tolerance(tested.spec)));
    // What a device without a kernel would make of it.
    double measured = 0;
    SpectrumMeasure measure(tested.spec);
    measure(spectrum.values(), {&measured, 1});
    EXPECT_NEAR(measured / expected, 1, 1e-12);
  });
}

TEST_P(Properties, SpectraOfRealPicturesAreSymmetric) {
  each(cases(kEverySpectrum, {"random8", "natural16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const Spectrum spectrum = spectrum_of(plan, tested.frame());
    Spectrum expected(n);
    for (int v = 0; v < n; ++v) {
      for (int u = 0; u < n; ++u) {
        if (is_real(tested.spec)) {
          expected.at(v, u) = spectrum.at(v, u).real();
        } else {
          expected.frequency(u, v) = std::conj(spectrum.frequency(-u, -v));
        }
      }
    }
    EXPECT_TRUE(agrees(tested.spec, spectrum, expected));
  });
}

// The options weigh a spectrum; they do not change it.
TEST_P(Properties, PowerAndBandLeaveTheSpectrumAlone) {
  each(
      cases({"fft:32:hann:power:band=0-0.25", "walsh-sequency:32:power:band=0-0.25"}, {"natural8"}),
      1, [&](const Case& tested, Plan& weighed) {
        MetricSpec plain = tested.spec;
        plain.power = false;
        plain.band.reset();
        const Frame frame = tested.frame();
        EXPECT_TRUE(
            agrees(tested.spec, spectrum_of(weighed, frame), spectrum_of(*oracle(plain), frame)));
      });
}

}  // namespace
}  // namespace fathom::conformance
