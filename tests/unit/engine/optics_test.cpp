// SPDX-License-Identifier: Apache-2.0
// The optics against the thesis' figures, Hopkins' series and what physics demands.
#include "engine/optics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "engine/thin_lens_depth.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using std::numbers::pi;
using test::expect_error;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Optics kThesis{135, 4, 0.04}, kWideOpen{135, 2.8, 0.04};

TEST(Optics, DepthOfFieldIsTheThesisOne) {
  // Chapters III and IX: "approximately 40 mm", "110 mm", "27.7 mm (1.9%)", "76.5 mm (3.1%)"; by
  // the thesis' own formula the last one is 76.8 mm.
  EXPECT_NEAR(optics::depth_of_field(kThesis, 1500).total_mm(), 40, 0.6);
  EXPECT_NEAR(optics::depth_of_field(kThesis, 2500).total_mm(), 110, 0.3);
  EXPECT_NEAR(optics::depth_of_field(kWideOpen, 1500).total_mm(), 27.7, 0.05);
  EXPECT_NEAR(optics::depth_of_field(kWideOpen, 2500).total_mm(), 76.8, 0.05);
}

TEST(Optics, DepthOfFieldIsTheFormulaAsItStands) {
  for (const double x : {200.0, 1500.0, 1e5}) {
    const double part = x * 0.04 * 4 / (135.0 * 135.0);
    const optics::DepthOfField depth = optics::depth_of_field(kThesis, x);
    EXPECT_NEAR(depth.near_mm, x / (1 + part), 1e-12 * x);
    EXPECT_NEAR(depth.far_mm, x / (1 - part), 1e-9 * x);
  }
}

TEST(Optics, FromTheHyperfocalDistanceOnTheFarLimitIsInfinite) {
  const double hyperfocal = optics::hyperfocal_mm(kThesis);
  EXPECT_NEAR(hyperfocal, 113906.25, 1e-9);  // 135^2/(0.04 * 4)
  EXPECT_TRUE(std::isfinite(optics::depth_of_field(kThesis, 0.999 * hyperfocal).far_mm));
  for (const double x : {1.0001 * hyperfocal, 10 * hyperfocal, kInfinity}) {
    EXPECT_EQ(optics::depth_of_field(kThesis, x).far_mm, kInfinity);
    EXPECT_EQ(optics::depth_of_field(kThesis, x).total_mm(), kInfinity);
  }
  EXPECT_NEAR(optics::depth_of_field(kThesis, hyperfocal).near_mm, hyperfocal / 2, 1e-6);
  EXPECT_NEAR(optics::depth_of_field(kThesis, kInfinity).near_mm, hyperfocal, 1e-6);
}

TEST(Optics, AiryDiscOfTheEyeIsTheThesisOne) {
  EXPECT_NEAR(optics::airy_radius_um(20, 2, 550), 6.7, 0.05);
}

TEST(Optics, ImageAndObjectAreInverse) {
  for (double object = 140; object < 1e6; object *= 1.7) {
    const double image = optics::image_distance_mm(135, object);
    EXPECT_NEAR(1 / image + 1 / object, 1 / 135.0, 1e-15);
    EXPECT_NEAR(optics::object_distance_mm(135, image) / object, 1, 1e-9);
    EXPECT_NEAR(optics::extension_mm(135, object), image - 135, 1e-9);
    EXPECT_NEAR(optics::magnification(135, object), image / object, 1e-12);
  }
}

TEST(Optics, AnObjectAtInfinityIsInFocusAtTheFocalLength) {
  EXPECT_EQ(optics::image_distance_mm(135, kInfinity), 135);
  EXPECT_EQ(optics::extension_mm(135, kInfinity), 0);
  EXPECT_EQ(optics::magnification(135, kInfinity), 0);
  EXPECT_EQ(optics::working_f_number(kThesis, kInfinity), 4);
  EXPECT_EQ(optics::object_distance_mm(135, 135), kInfinity);
}

TEST(Optics, AtTheEndsOfTheDepthOfFocusTheDiscIsTheCircle) {
  const double image = optics::image_distance_mm(135, 1500);
  const double half = optics::depth_of_focus_mm(kThesis, 1500) / 2;
  for (const double sensor : {image - half, image + half}) {
    EXPECT_NEAR(optics::disc_of_confusion_mm(135, 4, image, sensor), 0.04, 1e-12);
  }
  EXPECT_NEAR(half * optics::disc_per_defocus(kThesis, 1500), 0.04, 1e-12);
  EXPECT_EQ(optics::disc_of_confusion_mm(135, 4, image, image), 0);
}

TEST(Optics, AtTheLimitsOfTheDepthOfFieldTheDiscIsNearlyTheCircle) {
  // Eq. 3-3 takes X for X - f; the disc shows by how much.
  const double sensor = optics::image_distance_mm(135, 1500);
  const optics::DepthOfField depth = optics::depth_of_field(kThesis, 1500);
  for (const double limit : {depth.near_mm, depth.far_mm}) {
    const double image = optics::image_distance_mm(135, limit);
    EXPECT_NEAR(optics::disc_of_confusion_mm(135, 4, image, sensor), 0.04 * 1500 / 1365, 1e-9);
  }
}

TEST(Optics, AtTheLimitsOfTheExactDepthOfFieldTheDiscIsTheCircle) {
  const double sensor = optics::image_distance_mm(135, 1500);
  const optics::DepthOfField depth = optics::thin_lens_depth_of_field(kThesis, 1500);
  for (const double limit : {depth.near_mm, depth.far_mm}) {
    const double image = optics::image_distance_mm(135, limit);
    EXPECT_NEAR(optics::disc_of_confusion_mm(135, 4, image, sensor), 0.04, 1e-12);
  }
  // At 1:1, X = 2 f, eq. 3-3 takes twice X - f.
  EXPECT_NEAR(optics::depth_of_field(kThesis, 270).total_mm() /
                  optics::thin_lens_depth_of_field(kThesis, 270).total_mm(),
              2, 1e-4);
  EXPECT_EQ(optics::thin_lens_depth_of_field(kThesis, kInfinity).far_mm, kInfinity);
  EXPECT_EQ(optics::thin_lens_depth_of_field(kThesis, kInfinity).near_mm, 135.0 * 135 / 0.16);
}

TEST(Optics, ModulationIsOneForBlackAndZeroForNoContrast) {
  EXPECT_EQ(optics::modulation(3, 0), 1);
  EXPECT_EQ(optics::modulation(3, 3), 0);
  EXPECT_EQ(optics::modulation(3, 1), 0.5);
}

TEST(Optics, InFocusTheMtfIsTheClosedForm) {
  EXPECT_EQ(optics::diffraction_mtf(0), 1);
  EXPECT_NEAR(optics::diffraction_mtf(0.5), 2.0 / 3 - std::sqrt(3) / (2 * pi), 1e-15);
  EXPECT_EQ(optics::diffraction_mtf(1), 0);
  EXPECT_EQ(optics::diffraction_mtf(7), 0);
  for (double v = 0; v <= 1.1; v += 0.01) {
    EXPECT_NEAR(optics::defocused_otf(v, 0), optics::diffraction_mtf(v), 1e-13) << v;
  }
}

/// Hopkins' series, Proc. Roy. Soc. A 231 (1955) 91, with s = 2 v.
double hopkins_otf(double v, double waves) {
  const double a = 8 * pi * waves * v, beta = std::acos(v);
  double even = beta * ::jn(1, a), odd = 0;
  for (int n = 1; n < 200; ++n) {
    const double sign = n % 2 == 1 ? 1 : -1;
    even += sign * std::sin(2 * n * beta) / (2 * n) * (::jn(2 * n - 1, a) - ::jn(2 * n + 1, a));
  }
  for (int n = 0; n < 200; ++n) {
    const double sign = n % 2 == 0 ? 1 : -1;
    odd +=
        sign * std::sin((2 * n + 1) * beta) / (2 * n + 1) * (::jn(2 * n, a) - ::jn(2 * n + 2, a));
  }
  return 4 / (pi * a) * (std::cos(a * v) * even - std::sin(a * v) * odd);
}

TEST(Optics, OutOfFocusItIsHopkinsSeries) {
  for (const double waves : {0.05, 1 / pi, 1.0, 8 / pi, 10.0}) {
    for (double v = 0.01; v < 1; v += 0.03) {
      EXPECT_NEAR(optics::defocused_otf(v, waves), hopkins_otf(v, waves), 1e-10)
          << v << ", " << waves << " waves";
    }
  }
}

/// The pupil's autocorrelation as it is defined, summed over a grid.
std::complex<double> summed_otf(double v, double waves) {
  constexpr int kHalf = 700;
  const auto pupil = [&](double x, double y) {
    const double square = x * x + y * y;
    return square < 1 ? std::polar(1.0, 2 * pi * waves * square) : std::complex<double>(0);
  };
  std::complex<double> sum = 0;
  for (int row = -kHalf; row < kHalf; ++row) {
    for (int column = -kHalf; column < kHalf; ++column) {
      const double x = (column + 0.5) / kHalf, y = (row + 0.5) / kHalf;
      sum += pupil(x + v, y) * std::conj(pupil(x - v, y));
    }
  }
  return sum / (pi * kHalf * kHalf);
}

TEST(Optics, OutOfFocusItIsTheAutocorrelationOfThePupil) {
  for (const double waves : {1 / pi, 4 / pi}) {
    for (const double v : {0.1, 0.3, 0.7}) {
      const std::complex<double> sum = summed_otf(v, waves);
      EXPECT_NEAR(optics::defocused_otf(v, waves), sum.real(), 1e-3) << v << ", " << waves;
      EXPECT_NEAR(sum.imag(), 0, 1e-3);
    }
  }
}

TEST(Optics, DefocusTakesContrastAwayWhicheverWay) {
  for (double v = 0.05; v < 1; v += 0.05) {
    for (const double waves : {0.25, 1.0, 3.0}) {
      EXPECT_LT(std::abs(optics::defocused_otf(v, waves)), optics::diffraction_mtf(v));
      EXPECT_EQ(optics::defocused_otf(v, waves), optics::defocused_otf(v, -waves));
    }
  }
  EXPECT_LT(optics::defocused_otf(0.3, 1), 0) << "dark and bright change places";
  EXPECT_NEAR(optics::defocused_otf(0, 50), 1, 1e-12);
  EXPECT_EQ(optics::defocused_otf(0.5, 1e300), 0);
}

TEST(Optics, FarOutOfFocusRaysAreEnough) {
  // A disc of 0.04 mm to 4 mm at f/4: the wave result nears that of rays, for the same lines.
  double before = 1;
  for (const double disc_mm : {0.04, 0.4, 4.0}) {
    const double waves = optics::defocus_waves(disc_mm, 4, 550);
    const double cutoff = optics::cutoff_cycles_per_mm(4, 550);
    double worst = 0;
    for (double lines = 0.1; lines <= 4; lines += 0.1) {  // disc diameters to a period
      const double rays = optics::disc_otf(pi * lines);
      worst =
          std::max(worst, std::abs(optics::defocused_otf(lines / disc_mm / cutoff, waves) - rays));
    }
    EXPECT_LT(worst, before / 3) << disc_mm;
    before = worst;
  }
  EXPECT_LT(before, 2e-3);
}

TEST(Optics, TheDiscLosesItsFirstPatternAtTheAiryZero) {
  EXPECT_EQ(optics::disc_otf(0), 1);
  EXPECT_NEAR(optics::disc_otf(1.2196699 * pi), 0, 1e-7);  // first zero of J1
}

TEST(Optics, WavesAndCutoffOfTheThesisLens) {
  EXPECT_NEAR(optics::cutoff_cycles_per_mm(4, 550), 454.545, 1e-3);
  // w20 = (v - v0) d^2/(8 v v0), the sag of two spheres through the rim of the pupil.
  const double image = optics::image_distance_mm(135, 1500), sensor = image + 0.3;
  const double aperture = 135.0 / 4;
  const double disc = optics::disc_of_confusion_mm(135, 4, image, sensor);
  const double sag_mm = aperture * aperture / 8 * (1 / image - 1 / sensor);
  EXPECT_NEAR(optics::defocus_waves(disc, sensor / aperture, 550), sag_mm / 550e-6, 1e-9);
}

TEST(Optics, WhatNoLensHasIsRefused) {
  for (const double bad : {0.0, -135.0, kNaN, kInfinity}) {
    expect_error(ErrorCode::bad_argument, [&] { optics::image_distance_mm(bad, 1500); },
                 {"focal length", "above 0"});
    expect_error(ErrorCode::bad_argument,
                 [&] {
                   optics::hyperfocal_mm({135, bad, 0.04});
                 },
                 {"f-number"});
    expect_error(ErrorCode::bad_argument,
                 [&] {
                   optics::hyperfocal_mm({135, 4, bad});
                 },
                 {"circle of confusion"});
    expect_error(ErrorCode::bad_argument, [&] { optics::airy_radius_um(135, 30, bad); },
                 {"wavelength"});
    expect_error(ErrorCode::bad_argument, [&] { optics::airy_radius_um(135, bad, 550); },
                 {"aperture"});
    expect_error(ErrorCode::bad_argument,
                 [&] {
                   optics::working_f_number({135, bad, 1}, 1500);
                 },
                 {"f-number"});
  }
  for (const double object : {135.0, 20.0, -1500.0, kNaN}) {
    expect_error(ErrorCode::bad_argument, [&] { optics::image_distance_mm(135, object); },
                 {"135 mm lens", "above the focal length"});
    expect_error(ErrorCode::bad_argument, [&] { optics::depth_of_field(kThesis, object); });
    expect_error(ErrorCode::bad_argument, [&] { optics::extension_mm(135, object); });
    expect_error(ErrorCode::bad_argument, [&] { optics::magnification(135, object); });
  }
  expect_error(ErrorCode::bad_argument, [] { optics::object_distance_mm(135, 134); }, {"sensor"});
  expect_error(ErrorCode::bad_argument, [] { optics::object_at_extension_mm(135, -1); });
  expect_error(ErrorCode::bad_argument, [] { optics::modulation(0, 0); });
  expect_error(ErrorCode::bad_argument, [] { optics::modulation(1, 2); }, {"swap"});
  expect_error(ErrorCode::bad_argument, [] { optics::defocused_otf(-0.1, 1); });
  expect_error(ErrorCode::bad_argument, [] { optics::defocused_otf(0.1, kNaN); });
  expect_error(ErrorCode::bad_argument, [] { optics::diffraction_mtf(kNaN); });
}

}  // namespace
}  // namespace fathom
