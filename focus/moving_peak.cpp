// SPDX-License-Identifier: Apache-2.0
#include "focus/moving_peak.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace fathom {
namespace {

/// How far speeds may change in a second, as a part of them.
constexpr double kSpeedChange = 0.1;
/// Speeds that are thought of beforehand, in half widths a second: their deviation and their end.
constexpr double kUsualSpeed = 1.5;
constexpr double kFastest = 4;

/// Between a Gaussian and a Lorentzian, 1 at the top and 1/2 at z = 1; and its slope.
struct Shape {
  double value, slope;

  explicit Shape(double z) {
    const double squared = z * z;
    value = 1 / (1 + squared * (0.75 + 0.25 * squared));
    slope = -z * (1.5 + squared) * value * value;
  }
};

/// What the shape gets wrong, as a part of the height: little at the top, more on the tails.
double unlikeness(double z) { return 0.012 + 0.06 * z * z / (4 + z * z); }

/// One place in the space of what is possible.
struct Guess {
  double position, speed, half_width;
};

class Likelihood {
 public:
  Likelihood(std::span<const Sighting> sightings, const PeakTemplate& peak, double middle_s)
      : sightings_(sightings), peak_(peak), middle_s_(middle_s) {}

  /// Of a guess about the middle time, as a logarithm; the height is summed over.
  double operator()(const Guess& guess) {
    const double height_sigma = peak_.height_part * peak_.height;
    const double known = 1 / (height_sigma * height_sigma);
    double by_shape = known, by_score = known * peak_.height;
    double squares = known * peak_.height * peak_.height, variances = 1, logarithms = 0;
    for (const Sighting& sighting : sightings_) {
      const double after_s = sighting.time_s - middle_s_;
      const double z =
          (sighting.position - guess.position - guess.speed * after_s) / guess.half_width;
      const Shape shape(z);
      const double variance = variance_of(guess, sighting.time_s, z, shape.slope);
      const double score = sighting.score - peak_.floor;
      by_shape += shape.value * shape.value / variance;
      by_score += shape.value * score / variance;
      squares += score * score / variance;
      variances *= variance / (peak_.height * peak_.height);
      if (variances < kTiny) logarithms += std::log(std::exchange(variances, 1.0));
    }
    logarithms += std::log(variances);
    height_ = by_score / by_shape;
    misfit_ = (squares - by_score * height_) / static_cast<double>(sightings_.size());
    return -(squares - by_score * height_ + logarithms + std::log(by_shape)) / 2 - doubt(guess);
  }

  // Of the last guess:
  double height() const { return height_; }
  double misfit() const { return misfit_; }

 private:
  /// A logarithm is dear, so it is of a product, before that becomes 0.
  static constexpr double kTiny = 1e-200;

  /// The speed is that at the last sighting: the older one is, the farther it may have strayed.
  double variance_of(const Guess& guess, double time_s, double z, double slope) const {
    const double before_s = sightings_.back().time_s - time_s;
    const double strayed = kSpeedChange / 2 * guess.speed * before_s * before_s / guess.half_width;
    const double of_shape = peak_.height * unlikeness(z), of_speed = peak_.height * slope * strayed;
    return peak_.noise * peak_.noise + of_shape * of_shape + of_speed * of_speed;
  }
  /// What was thought beforehand.
  double doubt(const Guess& guess) const {
    const double speed = guess.speed / (kUsualSpeed * peak_.half_width);
    const double width = std::log(guess.half_width / peak_.half_width) / peak_.width_part;
    return (speed * speed + width * width) / 2;
  }

  std::span<const Sighting> sightings_;
  const PeakTemplate& peak_;
  double middle_s_;
  double height_ = 0, misfit_ = 0;
};

/// From low to high in equal steps.
struct Axis {
  double low, high;
  int count;

  double operator[](int i) const {
    return count > 1 ? low + (high - low) * i / (count - 1) : (low + high) / 2;
  }
  double step() const { return count > 1 ? (high - low) / (count - 1) : 0; }
};

/// Moments of what is possible.
struct Moments {
  double position = 0, speed = 0;
  double positions = 0, speeds = 0, both = 0;  ///< Variances and covariance.
  Guess likeliest = {};
};

Moments moments_of(Likelihood& likelihood, const Axis& positions, const Axis& speeds,
                   const Axis& widths) {
  struct Weighed {
    Guess guess;
    double weight;
  };
  std::vector<Weighed> all;
  all.reserve(static_cast<std::size_t>(positions.count) * speeds.count * widths.count);
  double most = -1e300;
  Moments moments;
  for (int w = 0; w < widths.count; ++w) {
    for (int v = 0; v < speeds.count; ++v) {
      for (int p = 0; p < positions.count; ++p) {
        const Guess guess{positions[p], speeds[v], std::exp(widths[w])};
        all.push_back({guess, likelihood(guess)});
        if (all.back().weight > most) most = all.back().weight, moments.likeliest = guess;
      }
    }
  }
  double sum = 0;
  for (Weighed& one : all) {
    one.weight = std::exp(one.weight - most);
    sum += one.weight;
    moments.position += one.weight * one.guess.position;
    moments.speed += one.weight * one.guess.speed;
  }
  moments.position /= sum;
  moments.speed /= sum;
  for (const Weighed& one : all) {
    const double p = one.guess.position - moments.position, v = one.guess.speed - moments.speed;
    moments.positions += one.weight * p * p / sum;
    moments.speeds += one.weight * v * v / sum;
    moments.both += one.weight * p * v / sum;
  }
  // A grid knows nothing within its steps.
  moments.positions += positions.step() * positions.step() / 12;
  moments.speeds += speeds.step() * speeds.step() / 12;
  return moments;
}

/// Five deviations on either side, within what the axis was.
Axis narrowed(const Axis& axis, double mean, double variance, int count) {
  const double reach = 5 * std::sqrt(variance);
  return {std::max(axis.low, mean - reach), std::min(axis.high, mean + reach), count};
}

}  // namespace

MovingPeak locate(std::span<const Sighting> sightings, const PeakTemplate& peak, double low,
                  double high) {
  double middle_s = 0;
  for (const Sighting& sighting : sightings)
    middle_s += sighting.time_s / static_cast<double>(sightings.size());
  const double last_s = sightings.back().time_s, after_s = last_s - middle_s;
  Likelihood likelihood(sightings, peak, middle_s);
  const double fastest = kFastest * peak.half_width, width = std::log(peak.half_width);
  const double strayed = fastest * after_s;
  constexpr int kMost = 101;
  const double wide = (high - low + 2 * strayed) / (peak.half_width / 5);
  Axis positions{low - strayed, high + strayed,
                 static_cast<int>(std::clamp(wide, 21.0, 1.0 * kMost))};
  const double span_s = std::max(last_s - sightings.front().time_s, 0.1);
  Axis speeds{-fastest, fastest,
              static_cast<int>(
                  std::clamp(2 * fastest * span_s / (peak.half_width / 2), 21.0, 1.0 * kMost))};
  Axis widths{width - 1.5 * peak.width_part, width + 1.5 * peak.width_part, 3};
  Moments moments = moments_of(likelihood, positions, speeds, widths);
  widths = {width - 2 * peak.width_part, width + 2 * peak.width_part, 7};
  for (int zoom = 0; zoom < 2; ++zoom) {
    constexpr int kFine = 31;
    positions = narrowed(positions, moments.position, moments.positions, kFine);
    speeds = narrowed(speeds, moments.speed, moments.speeds, kFine);
    moments = moments_of(likelihood, positions, speeds, widths);
  }
  likelihood(moments.likeliest);
  // What the shape gets more wrong than was thought is noise too.
  const double more = std::max(1.0, likelihood.misfit());
  const double variance =
      more * (moments.positions + 2 * after_s * moments.both + after_s * after_s * moments.speeds);
  return {.time_s = last_s,
          .position = moments.position + after_s * moments.speed,
          .sigma = std::sqrt(std::max(variance, 0.0)),
          .speed = moments.speed,
          .speed_sigma = std::sqrt(more * moments.speeds),
          .height = likelihood.height(),
          .half_width = moments.likeliest.half_width,
          .misfit = likelihood.misfit()};
}

}  // namespace fathom
