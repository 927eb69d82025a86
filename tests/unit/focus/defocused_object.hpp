// SPDX-License-Identifier: Apache-2.0
// Pictures as the law of defocus makes them, for tests of what is computed from their rings. The
// transfer of a disc is summed over the coefficients of a ring by its formula, not by the table of
// the code under test.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "focus/blur.hpp"
#include "focus/curve.hpp"

namespace fathom::test {

/// The squared radii of the coefficients of each ring of an N x N window, and how many have each.
class RingRadii {
 public:
  explicit RingRadii(int n) : n_(n), radii_(static_cast<std::size_t>(rings_of_side(n))) {
    for (int v = -n / 2; v < n / 2; ++v) {
      for (int u = -n / 2; u < n / 2; ++u) {
        const double r = std::sqrt(u * u + v * v);
        for (int k = 0; k < count(); ++k) {
          const double low = 0.5 * k / count() * n, high = 0.5 * (k + 1) / count() * n;
          if (r > low && r <= high) ++radii_[k][u * u + v * v];
        }
      }
    }
  }

  int count() const { return static_cast<int>(radii_.size()); }
  double coefficients(int k) const {
    double sum = 0;
    for (const auto& [squared, count] : radii_[k]) sum += count;
    return sum;
  }
  /// Mean of (2 J1(x) / x)^2 over ring k, x = pi c f (Hopkins 1955).
  double transfer(int k, double diameter_px) const { return transfer(k, {diameter_px}, {1}); }
  /// The same of a picture that is the mean of several, each with its weight.
  double transfer(int k, const std::vector<double>& diameters_px,
                  const std::vector<double>& weights) const {
    double sum = 0;
    for (const auto& [squared, count] : radii_[k]) {
      double mean = 0;
      for (std::size_t i = 0; i < diameters_px.size(); ++i) {
        const double x = std::numbers::pi * diameters_px[i] * std::sqrt(squared) / n_;
        mean += weights[i] * (x < 1e-6 ? 1 : 2 * std::cyl_bessel_j(1, x) / x);
      }
      sum += count * mean * mean;
    }
    return sum / coefficients(k);
  }

 private:
  int n_;
  std::vector<std::map<int, int>> radii_;  // [ring][u^2 + v^2]: so many
};

/// A pink object before a lens that blurs, and a camera with white noise.
struct DefocusedObject {
  double focus = 600;
  double px_per_unit = 0.08, rest_px = 0.7;
  double contrast = 20;  ///< Grey values rms of the object; 0 is a blank card.
  double noise = 1;      ///< Grey values rms.
  unsigned seed = 1;

  /// What a picture at this position shows. light: by how much the lamp is brighter than at first.
  Evaluation at(double position, std::mt19937& random, double light = 1,
                double its_noise = 0) const {
    return seen_from({position}, random, light, its_noise);
  }

  /// Of a lens that passes this place, and goes so far meanwhile.
  Evaluation passing(double position, double smear, std::mt19937& random) const {
    std::vector<double> places;
    constexpr int kPlaces = 24;
    for (int i = 0; i < kPlaces; ++i)
      places.push_back(position + smear * ((i + 0.5) / kPlaces - 0.5));
    Evaluation e = seen_from(places, random, 1, 0);
    e.position = position;
    return e;
  }

  /// The mean of what these places show.
  Evaluation seen_from(const std::vector<double>& places, std::mt19937& random, double light,
                       double its_noise) const {
    const double position = places.front();
    const double noise_now = its_noise > 0 ? its_noise : noise;
    std::vector<double> blurs;
    for (const double place : places)
      blurs.push_back(std::hypot(px_per_unit * (place - focus), rest_px));
    const std::vector<double> weights(places.size(), 1.0 / static_cast<double>(places.size()));
    Evaluation e{.loop = 1, .position = position, .score = 1};
    e.picture.light = 100 * light;
    for (const int side : {64, 128}) {
      RingPowers rings{.side = side, .powers = {}};
      const RingRadii& radii = radii_of(side);
      const double white = white_power(side) * noise_now * noise_now;
      for (int k = 0; k < radii.count(); ++k) {
        const double seen = light * light * object(side, k) * radii.transfer(k, blurs, weights);
        rings.powers.push_back(
            static_cast<float>(scattered(seen, white, radii.coefficients(k) / 1.5, random)));
      }
      e.picture.rings.push_back(rings);
    }
    return e;
  }

  /// Power of the object in a ring: as 1 / f^2, and up or down by a factor of its own.
  double object(int side, int k) const {
    std::mt19937 random(seed * 1000 + static_cast<unsigned>(side + k));
    const double own = std::exp(0.5 * std::normal_distribution<double>()(random));
    const double cycles = (k + 0.5) / radii_of(side).count() * side / 2;
    return contrast * contrast * own / (cycles * cycles) / side;
  }

  /// White noise of variance 1 puts so much into every ring under the raised cosine: SUM w^2 / N^4
  /// of w(x) w(y), and SUM w(x)^2 = 3 N / 8.
  static double white_power(int side) { return std::pow(3.0 / 8 * side, 2) / std::pow(side, 4); }

  static const RingRadii& radii_of(int side) {
    static const RingRadii narrow(64), wide(128);
    return side == 64 ? narrow : wide;
  }

  /// Mean of |object + noise|^2 over coefficients with so many degrees of freedom: noncentral
  /// chi-squared.
  static double scattered(double seen, double white, double freedom, std::mt19937& random) {
    const double offset = std::sqrt(freedom * seen / white);
    const double first = std::normal_distribution<double>(offset, 1)(random);
    const double rest = std::gamma_distribution<double>((freedom - 1) / 2, 2)(random);
    return white / freedom * (first * first + rest);
  }
};

}  // namespace fathom::test
