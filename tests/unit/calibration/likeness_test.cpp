// SPDX-License-Identifier: Apache-2.0
#include "calibration/likeness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/range.hpp"

namespace fathom {
namespace {

using Spectrum = std::vector<double>;

const Spectrum kChart = {3.7, 2.2, 1.6, 0.9, 0.6, 0.55, 0.53, 0.51};
const Spectrum kSeedling = {2.7, 1.9, 1.55, 1.2, 0.9, 0.65, 0.48, 0.38};

/// The same object in another light, and a little otherwise by noise.
Spectrum seen(Spectrum spectrum, double light, double noise) {
  for (std::size_t k = 0; k < spectrum.size(); ++k)
    spectrum[k] *= light * (k % 2 ? 1 + noise : 1 - noise);
  return spectrum;
}

/// Eight points on the thesis rig's curve, off by 0.1 steps to either side in turn.
std::vector<CalibrationPoint> points_of(const Spectrum& spectrum, double peak_sigma) {
  std::vector<CalibrationPoint> points;
  for (int i = 0; i < 8; ++i) {
    const double distance = 1400 + 170.0 * i;
    points.push_back({1.3e6 / (distance - 135) + (i % 2 ? 0.1 : -0.1), distance, peak_sigma,
                      spectrum.empty() ? spectrum : seen(spectrum, 1 - 0.05 * i, 0.02)});
  }
  return points;
}

Calibration calibration_of(const Spectrum& spectrum, double peak_sigma = 0.1) {
  return Calibration::fit(CalibrationModel::inverse, points_of(spectrum, peak_sigma),
                          {"rig", "fft:64:hann", {96, 88, 64}, "steps"});
}

Peak peak_at(double position, double sigma = 0.1) {
  return {.shape = PeakShape::gaussian, .position = position, .sigma = sigma, .half_width = 20};
}

TEST(SpectraApart, DoNotDependOnLight) {
  EXPECT_NEAR(spectra_apart(kChart, seen(kChart, 0.2, 0)).value(), 0, 1e-12);
  EXPECT_GT(spectra_apart(kChart, kSeedling).value(), 0.2);
  EXPECT_NEAR(spectra_apart(kChart, kSeedling).value(), spectra_apart(kSeedling, kChart).value(),
              1e-12);
}

TEST(SpectraApart, AreUnknownWhereEitherIs) {
  EXPECT_FALSE(spectra_apart(kChart, {}));
  EXPECT_FALSE(spectra_apart(Spectrum{}, Spectrum{}));
  EXPECT_FALSE(spectra_apart(kChart, Spectrum{1, 2}));
  EXPECT_FALSE(spectra_apart(Spectrum{1, 0}, Spectrum{1, 2}));
}

TEST(Likeness, OfTheCalibratedObjectAddsNothing) {
  const Likeness likeness = likeness_of(calibration_of(kChart), peak_at(700), seen(kChart, 3, 0.03),
                                        {"rig", "fft:64:hann", {96, 88, 64}, "steps"});
  EXPECT_LT(likeness.apart.value(), 0.1);
  EXPECT_EQ(likeness.other_object, 0);
  EXPECT_EQ(likeness.sigma, 0);
}

TEST(Likeness, OfAnotherObjectAddsAPartOfThePeaksWidth) {
  const Calibration calibration = calibration_of(kChart);
  const Likeness likeness = likeness_of(calibration, peak_at(700), kSeedling, {});
  EXPECT_GT(likeness.other_object, 0.3);
  EXPECT_GT(likeness.sigma, 0.05 * 20);
  EXPECT_LT(likeness.sigma, 0.25 * 20);
  // No repetition helps against it.
  const std::vector<Peak> many(100, peak_at(700));
  const Distance told = range_from_peaks(calibration, many, 1, false, likeness.sigma);
  EXPECT_GE(told.sigma_mm, std::abs(calibration.slope_mm(700)) * likeness.sigma);
}

TEST(Likeness, KnowsAnotherMetricAndAnotherWindow) {
  const Calibration calibration = calibration_of(kChart);
  const Likeness metric =
      likeness_of(calibration, peak_at(700), kChart, {"", "walsh-sequency:64", {}, ""});
  EXPECT_TRUE(metric.other_metric);
  EXPECT_GT(metric.sigma, 0);
  const Likeness window =
      likeness_of(calibration, peak_at(700), kChart, {"", "", {96, 80, 64}, ""});
  EXPECT_TRUE(window.other_window && !window.other_metric);
  EXPECT_GT(window.sigma, 0);
}

TEST(Likeness, IsSilentWhereNobodyWroteItDown) {
  const Likeness likeness = likeness_of(calibration_of({}), peak_at(700), kSeedling, {});
  EXPECT_FALSE(likeness.apart);
  EXPECT_EQ(likeness.sigma, 0);
}

TEST(RunSigma, IsWhatTheCalibrationsPeaksWereReallyOffBy) {
  const double scatter = calibration_of({}, 0).position_scatter();
  ASSERT_LT(scatter, 0.2);
  EXPECT_EQ(calibration_of({}, 0).run_sigma(0.5), 0.5) << "nobody knows what its peaks said";
  const Calibration doubting = calibration_of({}, 0.2);
  EXPECT_NEAR(doubting.run_sigma(0.2), scatter, 1e-12) << "they said more than they were off by";
  EXPECT_EQ(doubting.run_sigma(0), scatter);
  const Calibration boasting = calibration_of({}, 0.01);
  EXPECT_NEAR(boasting.run_sigma(0.01), scatter, 1e-12);
  EXPECT_GT(boasting.run_sigma(3), 2.9) << "this one says that it is worse";
  EXPECT_GE(doubting.run_sigma(0.4), 0.3);
}

TEST(CalibrationFile, KeepsSpectraAndWhatPeaksSaid) {
  const Calibration kept = Calibration::parse(calibration_of(kChart).json(), "kept");
  ASSERT_EQ(kept.points().size(), 8u);
  EXPECT_EQ(kept.points()[3].spectrum, calibration_of(kChart).points()[3].spectrum);
  EXPECT_EQ(kept.points()[3].sigma, 0.1);
  EXPECT_EQ(calibration_of({}, 0).json().find("spectrum"), std::string::npos);
}

}  // namespace
}  // namespace fathom
