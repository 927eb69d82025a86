// SPDX-License-Identifier: Apache-2.0
#include "calibration/likeness.hpp"

#include <algorithm>
#include <cmath>

namespace fathom {
namespace {

/// Another object's depth, as a part of the half width of the peak. Relief of half a width would
/// show in the peak's shape; what lies below is taken as even between the tape's point and there.
/// Measured on the three targets of `sim`: 0.09 to 0.18 (bench/honesty).
constexpr double kHiddenRelief = 0.2;
/// Another metric weighs the same relief otherwise; another window sees another part of it.
constexpr double kOtherMetric = 0.05;
constexpr double kOtherWindow = 0.05;

/// Spectra that are apart by this much beyond the object's own spread are of another object, by
/// 1 - 1/e. Chart and seedling are 0.3 apart, seedlings among each other 0.15.
constexpr double kAnother = 0.3;
/// An object's spectrum does not repeat better than this, by noise and by the last steps of focus.
constexpr double kLeastSpread = 0.05;

struct KnownSpectrum {
  double position;
  std::vector<double> spectrum;
};

/// Of the points that have a say and a spectrum of this size, sorted by position.
std::vector<KnownSpectrum> known_spectra(const Calibration& calibration, std::size_t size) {
  std::vector<KnownSpectrum> known;
  const auto& points = calibration.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!calibration.left_out(i) && size > 0 && points[i].spectrum.size() == size)
      known.push_back({points[i].position, points[i].spectrum});
  }
  std::sort(known.begin(), known.end(),
            [](const KnownSpectrum& a, const KnownSpectrum& b) { return a.position < b.position; });
  return known;
}

/// As the object looks at a position: between its neighbours, ring by ring, in logarithms. Nearer
/// or farther it shows another part, in another size. skip: an index that is not to be used.
std::vector<double> spectrum_at(const std::vector<KnownSpectrum>& known, double position,
                                std::size_t skip) {
  const KnownSpectrum *below = nullptr, *above = nullptr;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (i == skip) continue;
    if (known[i].position <= position) below = &known[i];
    if (known[i].position >= position && above == nullptr) above = &known[i];
  }
  if (below == nullptr && above == nullptr) return {};
  if (below == nullptr || above == nullptr) return (below ? below : above)->spectrum;
  const double span = above->position - below->position;
  const double part = span > 0 ? (position - below->position) / span : 0;
  std::vector<double> spectrum;
  for (std::size_t k = 0; k < below->spectrum.size(); ++k)
    spectrum.push_back(std::pow(below->spectrum[k], 1 - part) * std::pow(above->spectrum[k], part));
  return spectrum;
}

constexpr std::size_t kSkipNone = static_cast<std::size_t>(-1);

/// How far the calibrated object is from itself at most: each point from what its neighbours say.
double own_spread(const std::vector<KnownSpectrum>& known) {
  double most = kLeastSpread;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto apart = spectra_apart(known[i].spectrum, spectrum_at(known, known[i].position, i));
    most = std::max(most, apart.value_or(0));
  }
  return most;
}

void compare_objects(Likeness& likeness, const Calibration& calibration, double position,
                     std::span<const double> spectrum) {
  const auto known = known_spectra(calibration, spectrum.size());
  likeness.apart = spectra_apart(spectrum, spectrum_at(known, position, kSkipNone));
  if (!likeness.apart) return;
  const double own = own_spread(known);
  const double beyond = std::max(0.0, *likeness.apart * *likeness.apart - own * own);
  likeness.other_object = 1 - std::exp(-beyond / (kAnother * kAnother));
}

/// Whether both know their windows, and they differ.
bool is_other_window(const Window& then, const Window& now) {
  if (then.n == 0 || now.n == 0) return false;
  constexpr int kUnknown = CalibrationConditions::kUnknown;
  const bool place_known = then.x != kUnknown && now.x != kUnknown;
  return then.n != now.n || (place_known && (then.x != now.x || then.y != now.y));
}

}  // namespace

std::optional<double> spectra_apart(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || a.size() != b.size()) return std::nullopt;
  const auto count = static_cast<double>(a.size());
  double mean = 0, squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(a[k] > 0 && b[k] > 0)) return std::nullopt;
    mean += std::log(a[k] / b[k]) / count;
  }
  for (std::size_t k = 0; k < a.size(); ++k)
    squares += std::pow(std::log(a[k] / b[k]) - mean, 2) / count;
  return std::sqrt(squares);
}

Likeness likeness_of(const Calibration& calibration, const Peak& peak,
                     std::span<const double> spectrum, const CalibrationConditions& now) {
  const CalibrationConditions& then = calibration.conditions();
  Likeness likeness;
  compare_objects(likeness, calibration, peak.position, spectrum);
  likeness.other_metric = !then.metric.empty() && !now.metric.empty() && then.metric != now.metric;
  likeness.other_window = is_other_window(then.window, now.window);
  const double parts[] = {kHiddenRelief * likeness.other_object,
                          likeness.other_metric ? kOtherMetric : 0,
                          likeness.other_window ? kOtherWindow : 0};
  likeness.sigma = peak.half_width * std::hypot(parts[0], parts[1], parts[2]);
  return likeness;
}

}  // namespace fathom
