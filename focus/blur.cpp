// SPDX-License-Identifier: Apache-2.0
#include "focus/blur.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include "engine/error.hpp"
#include "engine/optics.hpp"
#include "engine/tables.hpp"

namespace fathom {
namespace {

constexpr BlurShape kShapes[] = {BlurShape::disc, BlurShape::gaussian};

/// Diameters between two rows of the table, px.
constexpr double kRowPx = 0.25;

/// Places of a TransferTable on a length of 1.
constexpr double kPerUnit = 16;

/// SUM w^2 of the raised cosine over N samples, squared for two axes, over N^4.
double white_power_of(int n) {
  double squares = 0;
  for (const double w : tables::taper(Taper::hann(), n)) squares += w * w;
  return squares * squares / std::pow(n, 4);
}

}  // namespace

const char* to_string(BlurShape shape) noexcept {
  switch (shape) {
    case BlurShape::disc:
      return "disc";
    case BlurShape::gaussian:
      return "gaussian";
  }
  return "unknown";
}

BlurShape parse_blur_shape(std::string_view name) {
  for (const BlurShape shape : kShapes) {
    if (name == to_string(shape)) return shape;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no shape of blur \"{}\"; there is disc, gaussian", name));
}

double BlurModel::diameter_px(double from_focus) const {
  return std::hypot(px_per_unit * from_focus, rest_px);
}

BlurModel blur_of_microscope(double aperture, double wavelength_nm, double pixel_um) {
  constexpr double kHighest = 1.49, kOil = 1.515, kUncertainty = 0.1;
  if (!(aperture > 0 && aperture <= kHighest && wavelength_nm > 0 && pixel_um > 0) ||
      !std::isfinite(wavelength_nm + pixel_um)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("no microscope has an aperture of {:g}, light of {:g} nm and pixels of "
                            "{:g} um; the aperture is at most {:g}, the others are above 0",
                            aperture, wavelength_nm, pixel_um, kHighest));
  }
  const double index = aperture < 1 ? 1 : kOil;
  const double slope = aperture / std::sqrt(index * index - aperture * aperture);
  // The disc of the Airy pattern's second moment is of no use, for that has none; its half width is.
  const double diffraction_um = wavelength_nm / 1000 / (2 * aperture);
  return {.px_per_unit = 2 * slope / pixel_um,
          .rest_px = std::hypot(BlurModel{}.rest_px, diffraction_um / pixel_um),
          .uncertainty = kUncertainty};
}

void require_valid(const BlurModel& model) {
  const bool is_finite = std::isfinite(model.px_per_unit) && std::isfinite(model.rest_px) &&
                         std::isfinite(model.uncertainty);
  if (is_finite && model.px_per_unit > 0 && model.rest_px >= 0 && model.uncertainty >= 0) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("a blur of {:g} px per unit of travel, {:g} px at the focus, is of no "
                          "lens; the first must be above 0, the second not below",
                          model.px_per_unit, model.rest_px));
}

int rings_of_side(int n) {
  constexpr int kSmallest = 32, kLargest = 256, kMost = 24;
  if (n < kSmallest || n > kLargest) return 0;
  return std::min(kMost, 3 * n / 8);
}

TransferTable::TransferTable(BlurShape shape, double largest) {
  const auto size = static_cast<std::size_t>(largest * kPerUnit) + 2;
  for (std::size_t i = 0; i < size; ++i) {
    const double x = static_cast<double>(i) / kPerUnit;
    // exp(-2 pi^2 sigma^2 f^2) with sigma = c/4 is exp(-x^2/8).
    const double otf = shape == BlurShape::disc ? optics::disc_otf(x) : std::exp(-x * x / 8);
    amplitude_.push_back(otf);
    squared_.push_back(otf * otf);
  }
}

double TransferTable::between(const std::vector<double>& values, double x) {
  const double place = x * kPerUnit;
  const auto i = std::min(static_cast<std::size_t>(place), values.size() - 2);
  const double part = std::min(place - static_cast<double>(i), 1.0);
  return values[i] + part * (values[i + 1] - values[i]);
}

/// The rings of the metric (docs/metrics.md, "Rings").
std::vector<DefocusLaw::Ring> DefocusLaw::rings_of(int n, int rings) {
  std::vector<Ring> made(rings);
  for (int v = -n / 2; v < n / 2; ++v) {
    for (int u = -n / 2; u < n / 2; ++u) {
      const double r = std::sqrt(u * u + v * v);
      const int strip = static_cast<int>(std::ceil(r / (0.5 * n) * rings * kStrips)) - 1;
      if (strip < 0 || strip >= rings * kStrips) continue;
      Strip& its = made[strip / kStrips][strip % kStrips];
      its.frequency += (r / n - its.frequency) / ++its.count;
    }
  }
  return made;
}

const DefocusLaw& DefocusLaw::of(int n, BlurShape shape) {
  static std::mutex mutex;
  static std::map<std::pair<int, BlurShape>, std::unique_ptr<DefocusLaw>> laws;
  const std::lock_guard lock(mutex);
  std::unique_ptr<DefocusLaw>& law = laws[{n, shape}];
  if (!law) law.reset(new DefocusLaw(n, shape));
  return *law;
}

DefocusLaw::DefocusLaw(int n, BlurShape shape)
    : n_(n),
      rings_(rings_of_side(n)),
      white_power_(white_power_of(n)),
      strips_(rings_of(n, rings_)),
      transfer_(shape, std::numbers::pi * n / 2) {
  const double largest = n;
  for (const Ring& ring : strips_) {
    double count = 0;
    for (const Strip& strip : ring) count += strip.count;
    counts_.push_back(static_cast<float>(count));
  }
  const int rows = static_cast<int>(largest / kRowPx) + 1;
  table_.reserve(static_cast<std::size_t>(rows) * rings_);
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < rings_; ++k) {
      double sum = 0;
      for (const Strip& strip : strips_[k])
        sum += strip.count * transfer_.squared(std::numbers::pi * kRowPx * row * strip.frequency);
      table_.push_back(static_cast<float>(sum / counts_[k]));
    }
  }
}

void DefocusLaw::transfer(double diameter_px, std::span<float> squared,
                          std::span<float> slope) const {
  const auto last = table_.size() / rings_ - 2;
  const double place = diameter_px / kRowPx;
  const auto row = std::min(static_cast<std::size_t>(place), last);
  const auto part = static_cast<float>(std::min(place - static_cast<double>(row), 1.0));
  const float* const low = table_.data() + row * rings_;
  const float* const high = low + rings_;
  for (int k = 0; k < rings_; ++k) {
    const float step = high[k] - low[k];
    squared[k] = low[k] + part * step;
    slope[k] = step / static_cast<float>(kRowPx);
  }
}

void DefocusLaw::transfer_of_mean(std::span<const double> diameters_px,
                                  std::span<const double> weights, std::span<float> squared) const {
  for (int k = 0; k < rings_; ++k) {
    double sum = 0;
    for (const Strip& strip : strips_[k]) {
      double mean = 0;
      for (std::size_t i = 0; i < diameters_px.size(); ++i)
        mean += weights[i] * transfer_.at(std::numbers::pi * diameters_px[i] * strip.frequency);
      sum += strip.count * mean * mean;
    }
    squared[k] = static_cast<float>(sum / counts_[k]);
  }
}

}  // namespace fathom
