// SPDX-License-Identifier: Apache-2.0
#include "session/picture_facts.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <type_traits>

#include "engine/error.hpp"
#include "engine/tables.hpp"
#include "session/greys.hpp"
#include "session/part_brightness.hpp"
#include "session/saturation.hpp"

namespace fathom {
namespace {

/// Standard deviation of the noise by Immerkaer's mask, 1 -2 1 along both axes: the mean of what it
/// leaves, over what it makes of noise of deviation 1. greys: n x n.
double noise_of(const std::vector<std::int32_t>& greys, int n) {
  const auto side = static_cast<std::size_t>(n);
  std::vector<std::int32_t> down(side);  // the mask down the columns of three rows
  std::int64_t sum = 0;
  for (std::size_t y = 1; y + 1 < side; ++y) {
    const std::int32_t* const row = greys.data() + y * side;
    for (std::size_t x = 0; x < side; ++x) down[x] = row[x - side] - 2 * row[x] + row[x + side];
    std::int32_t of_row = 0;  // at most 16 greys a pixel: a row of 2^11 16-bit pixels fits
    for (std::size_t x = 1; x + 1 < side; ++x)
      of_row += std::abs(down[x - 1] - 2 * down[x] + down[x + 1]);
    sum += of_row;
  }
  const double inside = n - 2;
  return std::sqrt(std::numbers::pi / 2) / 6 * static_cast<double>(sum) / (inside * inside);
}

/// Sums of whole numbers, so that no digits are lost; 32 bits hold a row of bytes, squared too.
template <class Pixel>
using Sum = std::conditional_t<sizeof(Pixel) == 1, std::uint32_t, std::uint64_t>;

void sum_greys(const Frame& frame, const Window& window, PictureFacts& facts) {
  std::uint64_t sum = 0, squares = 0;
  for_each_row(frame, window, [&](const auto* row) {
    Sum<std::remove_cvref_t<decltype(*row)>> of_row = 0, of_squares = 0;
    for (int x = 0; x < window.n; ++x) {
      const std::uint32_t grey = row[x];
      of_row += grey;
      of_squares += grey * grey;
    }
    sum += of_row;
    squares += of_squares;
  });
  const double count = static_cast<double>(window.n) * window.n;
  facts.brightness = static_cast<double>(sum) / count;
  const double spread = static_cast<double>(squares) - static_cast<double>(sum) * facts.brightness;
  facts.deviation = std::sqrt(std::max(0.0, spread) / count);
}

template <class Pixel>
std::uint64_t sum_of(const Pixel* row, int width) {
  Sum<Pixel> sum = 0;
  for (int x = 0; x < width; ++x) sum += row[x];
  return sum;
}

/// Mean grey value of the whole picture, of every fourth row.
double light_of(const Frame& frame) {
  constexpr int kStep = 4;
  const int width = frame.width_px();
  std::uint64_t sum = 0, count = 0;
  std::vector<std::uint16_t> copy(static_cast<std::size_t>(width));
  for (int y = 0; y < frame.height_px(); y += kStep) {
    const std::byte* const row = frame.row(y);
    if (frame.depth() == Depth::bits8) {
      sum += sum_of(reinterpret_cast<const std::uint8_t*>(row), width);
    } else {
      std::memcpy(copy.data(), row, copy.size() * sizeof copy[0]);
      sum += sum_of(copy.data(), width);
    }
    count += static_cast<std::uint64_t>(width);
  }
  return static_cast<double>(sum) / static_cast<double>(count);
}

Frame of_one_grey(int n) {
  return Frame(n, n, std::vector<std::uint8_t>(static_cast<std::size_t>(n) * n, 128));
}

double mass(const MetricSpec& spec, std::complex<double> coefficient) {
  return spec.power ? std::norm(coefficient) : std::abs(coefficient);
}

}  // namespace

BrightnessShare::BrightnessShare(Device& device, const MetricSpec& spec) : spec_(spec) {
  if (spec.taper == Taper::none()) return;
  const std::vector<double> weights = tables::moment_weights(spec);
  const bool is_fourier = family_of(spec.transform) == TransformFamily::fourier;
  if (is_fourier && spec.taper == Taper::hann()) {
    begin_lowest(weights);
  } else {
    begin_whole(device, weights);
  }
}

void BrightnessShare::begin_lowest(const std::vector<double>& weights) {
  lowest_.emplace(spec_);
  const int n = spec_.n;
  const auto constant = lowest_->of(of_one_grey(n), {0, 0, n});
  zero_ = constant.size() / 2;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      const auto at = static_cast<std::size_t>((v + 1) * LowestCoefficients::kAcross + u + 1);
      const auto stored = static_cast<std::size_t>((v + n) % n) * n + (u + n) % n;
      add_place(at, weights[stored], constant[at], constant[zero_]);
    }
  }
}

void BrightnessShare::begin_whole(Device& device, const std::vector<double>& weights) {
  plan_ = device.plan(spec_, 1);
  const int n = spec_.n, half = family_of(spec_.transform) == TransformFamily::fourier ? n / 2 : 0;
  const auto at = [n](int row, int column) { return static_cast<std::size_t>(row) * n + column; };
  zero_ = at(half, half);
  spectrum_.resize(weights.size());
  plan_->spectrum(of_one_grey(n), {0, 0, n}, spectrum_);
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      const std::size_t place = at((v + half) % n, (u + half) % n);
      add_place(place, weights[at(v, u)], spectrum_[place], spectrum_[zero_]);
    }
  }
}

void BrightnessShare::add_place(std::size_t at, double weight, std::complex<double> constant,
                                std::complex<double> zero) {
  constexpr double kNothing = 1e-6;  // of zero frequency
  // A quality is 1/N^4 of the sum, of the Fourier transform's mirrored plane half of that.
  const bool is_mirrored = family_of(spec_.transform) == TransformFamily::fourier;
  const double scale = std::pow(spec_.n, -4) / (is_mirrored ? 2 : 1);
  if (weight > 0 && std::abs(constant) > kNothing * std::abs(zero))
    places_.push_back({at, scale * weight, constant / zero});
}

void BrightnessShare::read(const Frame& frame, const Window& window) {
  if (plan_) return plan_->spectrum(frame, window, spectrum_);
  const auto values = lowest_->of(frame, window);
  spectrum_.assign(values.begin(), values.end());
}

double BrightnessShare::of(const Frame& frame, const Window& window) {
  if (places_.empty()) return 0;
  read(frame, window);
  double share = 0;
  for (const Place& place : places_) {
    const std::complex<double> all = spectrum_[place.at];
    const std::complex<double> rest = all - spectrum_[zero_] * place.constant;
    share += place.weight * (mass(spec_, all) - mass(spec_, rest));
  }
  return share;
}

namespace {

/// Whether a half of a window has what the metric asks for: a narrow band may hold no coefficient
/// of it.
bool has_parts(Device& device, const MetricSpec& half) {
  if (half.n < kSmallestWindow) return false;
  try {
    half.validate();
  } catch (const Error&) {
    return false;
  }
  return device.unsupported(half).empty();
}

}  // namespace

PictureReader::PictureReader(Device& device, const MetricSpec& spec, const Window& window)
    : window_(window) {
  MetricSpec half = spec;
  half.n = spec.n / 2;
  if (!has_parts(device, half)) return;
  plan_ = device.plan(half, kParts);
  share_.emplace(device, half);
  const int stride = half.n / 2;
  for (int row = 0; row < kPartsAcross; ++row) {
    for (int column = 0; column < kPartsAcross; ++column)
      parts_.push_back({window.x + column * stride, window.y + row * stride, half.n});
  }
}

PictureFacts PictureReader::read(const Frame& frame) {
  PictureFacts facts;
  read_greys(frame, window_, greys_);
  sum_greys(frame, window_, facts);
  facts.light = light_of(frame);
  facts.part_brightness = part_brightness(frame, window_);
  facts.noise = noise_of(greys_, window_.n);
  facts.saturated = saturated_part(frame, window_);
  if (!plan_) return facts;
  plan_->score(frame, parts_, facts.parts);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    facts.parts[i] = BrightnessShare::without(facts.parts[i], share_->of(frame, parts_[i]));
  return facts;
}

}  // namespace fathom
