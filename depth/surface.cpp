// SPDX-License-Identifier: Apache-2.0
#include "depth/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// Nodes to each side that a fit looks at, and how fast their weight falls off.
constexpr int kReach = 3;
constexpr float kSpread = kFittedNodes;
/// Nodes to each side among which another surface is looked for where texture lies aside.
constexpr int kLookedAt = 5;
/// Nodes that are nearer than this to each other tell the same, in sides of their windows.
constexpr float kAlike = 0.9f;
/// Of a quadratic surface: 1, x, y, x^2, x y, y^2.
constexpr int kTerms = 6;
using Coefficients = std::array<float, kTerms>;

/// x^a y^b to the fourth degree, those of lower degree first, which begin with the terms. All products
/// of two terms are among them. The last one fills a register.
constexpr int kPowers = 16;
using Powers = std::array<float, kPowers>;

/// Which power the product of two terms is.
constexpr int kProducts[kTerms][kTerms] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                           {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                           {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};

Powers powers_at(float x, float y) {
  const float xx = x * x, xy = x * y, yy = y * y;
  return {1,      x,      y,       xx,      xy,      yy,      xx * x,  xx * y,
          x * yy, yy * y, xx * xx, xx * xy, xx * yy, xy * yy, yy * yy, 0};
}

float value_at(const Coefficients& surface, const Powers& powers) {
  float sum = 0;
  for (int i = 0; i < kTerms; ++i) sum += surface[i] * powers[i];
  return sum;
}

/// Weighted least squares of a quadratic surface, bent no more than the data ask for.
class Fit {
 public:
  void add(const Powers& powers, float value, float weight) {
    const float weighted = weight * value;
    for (int i = 0; i < kPowers; ++i) sums_[i] += weight * powers[i];
    for (int i = 0; i < kRight; ++i) right_[i] += weighted * powers[i];
  }

  /// Coefficients. Of few points on a line the surface is level across it.
  Coefficients solve() {
    constexpr float kStiffness = 0.3f, kSlope = 1e-3f;
    for (int i = 0; i < kTerms; ++i) {
      for (int j = 0; j <= i; ++j) normal_[i][j] = sums_[kProducts[i][j]];
      if (i > 0) normal_[i][i] += sums_[0] * (i < 3 ? kSlope : kStiffness);
    }
    factor();
    Coefficients right;
    std::copy_n(right_.begin(), kTerms, right.begin());
    return substitute(right);
  }

  /// Of the first coefficient, for weights of 1/variance; after solve().
  float variance() const { return substitute({1})[0]; }

 private:
  static constexpr int kRight = 8;

  /// Cholesky's, in place.
  void factor() {
    for (int i = 0; i < kTerms; ++i) {
      for (int j = 0; j <= i; ++j) {
        float sum = normal_[i][j];
        for (int k = 0; k < j; ++k) sum -= normal_[i][k] * normal_[j][k];
        normal_[i][j] = i == j ? std::sqrt(std::max(sum, 1e-20f)) : sum / normal_[j][j];
      }
    }
  }

  Coefficients substitute(Coefficients x) const {
    for (int i = 0; i < kTerms; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= normal_[i][k] * x[k];
      x[i] /= normal_[i][i];
    }
    for (int i = kTerms - 1; i >= 0; --i) {
      for (int k = i + 1; k < kTerms; ++k) x[i] -= normal_[k][i] * x[k];
      x[i] /= normal_[i][i];
    }
    return x;
  }

  Powers sums_{};
  std::array<float, kRight> right_{};
  std::array<Coefficients, kTerms> normal_{};
};

/// A node near another one, known and not farther than kReach.
struct Neighbour {
  Powers powers;  ///< Of the way to its texture, in nodes.
  float place, weight, variance, nodes_away;
};

class Fitter {
 public:
  Fitter(const Nodes& nodes, const Scales& scales)
      : nodes_(nodes), scales_(scales), pitch_px_(static_cast<float>(nodes.level.pitch_px())) {
    neighbours_.reserve((2 * kReach + 1) * (2 * kReach + 1));
    for (int y = 0; y <= kLookedAt; ++y) {
      for (int x = 0; x <= kLookedAt; ++x)
        away_[y][x] = std::sqrt(static_cast<float>(x * x + y * y));
    }
    for (int i = 0; i <= kReach; ++i) {
      near_[i] = std::exp(static_cast<float>(-i * i) / (2 * kSpread * kSpread));
    }
  }

  Facet at(int column, int row) {
    const Peak& own = nodes_.at(column, row);
    Facet facet{.place = own.place, .confidence = own.confidence, .kind = own.kind};
    if (own.kind != DepthClass::known) return facet;
    gather(column, row);
    if (!is_of_one_depth(own) || (is_aside(own) && !is_on_its_side(own, column, row))) {
      facet.kind = DepthClass::two_depths;
      return facet;
    }
    fit(own, facet);
    return facet;
  }

 private:
  static constexpr float kLeastSupport = 0.2f;
  /// A window shows what is nearer to its middle than this part of its side.
  static constexpr float kSeen = 1;
  static constexpr float kMostShift = 2;
  static constexpr float kMostApart = 0.03f;
  /// Steepness of a surface that is no cliff, in parts of `apart` for each node.
  static constexpr float kSteep = 1;

  /// Nodes to each side of one, within the grid.
  struct Around {
    int left, right, top, bottom;
  };
  Around around(int column, int row, int reach) const {
    return {std::max(column - reach, 0), std::min(column + reach, nodes_.level.columns - 1),
            std::max(row - reach, 0), std::min(row + reach, nodes_.level.rows - 1)};
  }

  void gather(int column, int row) {
    neighbours_.clear();
    const Around a = around(column, row, kReach);
    for (int y = a.top; y <= a.bottom; ++y) {
      for (int x = a.left; x <= a.right; ++x) {
        const Peak& peak = nodes_.at(x, y);
        if (peak.kind != DepthClass::known) continue;
        const auto dx = static_cast<float>(x - column), dy = static_cast<float>(y - row);
        const float variance = variance_of(peak);
        const float near = near_[std::abs(x - column)] * near_[std::abs(y - row)];
        neighbours_.push_back({.powers = powers_at(dx + shift(peak.dx_px), dy + shift(peak.dy_px)),
                               .place = peak.place,
                               .weight = near / variance,
                               .variance = variance,
                               .nodes_away = away_[std::abs(y - row)][std::abs(x - column)]});
      }
    }
  }

  float variance_of(const Peak& peak) const {
    return peak.sigma * peak.sigma + scales_.least_sigma * scales_.least_sigma;
  }

  /// In nodes. A fit to places that all lie far to one side of it would be a guess.
  float shift(float px) const { return std::clamp(px / pitch_px_, -kMostShift, kMostShift); }

  /// Whether many of the neighbours lie at one depth with a node, and nearly all that its window
  /// shows.
  bool is_of_one_depth(const Peak& own) const {
    float all = 0, with = 0, seen = 0, seen_apart = 0;
    for (const Neighbour& other : neighbours_) {
      const bool agrees = agree(own, other.place, other.variance, other.nodes_away);
      all += other.weight;
      if (agrees) with += other.weight;
      if (other.nodes_away * pitch_px_ > kSeen * own.side_px) continue;
      seen += other.weight;
      if (!agrees) seen_apart += other.weight;
    }
    return with > kLeastSupport * all && seen_apart <= kMostApart * seen;
  }

  /// Whether what a node's windows told lies to one side of it, of windows that see less far than is
  /// looked at.
  bool is_aside(const Peak& own) const {
    constexpr float kAside = 0.1f;
    return own.side_px < kLookedAt * pitch_px_ &&
           std::hypot(own.dx_px, own.dy_px) > kAside * own.side_px;
  }

  /// Whether none but its own surface lies on the other side: a node between what it was told by and a
  /// cliff may be of either.
  bool is_on_its_side(const Peak& own, int column, int row) const {
    const Around a = around(column, row, kLookedAt);
    float seen = 0, apart = 0;
    for (int y = a.top; y <= a.bottom; ++y) {
      for (int x = a.left; x <= a.right; ++x) {
        const Peak& other = nodes_.at(x, y);
        const auto dx = static_cast<float>(x - column), dy = static_cast<float>(y - row);
        const float away = away_[std::abs(y - row)][std::abs(x - column)];
        const bool is_opposite = dx * own.dx_px + dy * own.dy_px <= 0;
        if (other.kind != DepthClass::known || !is_opposite || away > kLookedAt) continue;
        const float variance = variance_of(other);
        seen += 1 / variance;
        if (!agree(own, other.place, variance + variance_of(own), away)) apart += 1 / variance;
      }
    }
    return apart <= kMostApart * seen;
  }

  bool agree(const Peak& own, float place, float variance, float nodes_away) const {
    return std::abs(place - own.place) < tolerance(variance, 2 + kSteep * nodes_away);
  }

  float tolerance(float variance, float times) const {
    constexpr float kSigmas = 3;
    return std::max(times * scales_.apart, kSigmas * std::sqrt(variance));
  }

  /// What a fit found: the surface, the variance of its place by noise alone of nodes that told each
  /// something else, by how much the nodes on it scatter more, and the part that lies off it.
  struct Found {
    Coefficients surface;
    float variance = 0, misfit = 1, off = 0;
  };

  /// Again and again without those that lie off the surface so far.
  Found fitted(const Peak& own) const {
    constexpr std::array kTolerances = {1.4f, 0.9f, 0.7f};
    Found found{.surface = {own.place}};
    float tilt = kTilt;
    for (const float times : kTolerances) {
      Fit fit;
      float squares = 0, count = 0, all = 0, left_out = 0;
      for (const Neighbour& other : neighbours_) {
        const float limit = tolerance(other.variance, times + tilt * other.nodes_away);
        const float off = (other.place - value_at(found.surface, other.powers)) / limit;
        all += other.weight;
        if (std::abs(off) >= 1) {
          left_out += other.weight;
          continue;
        }
        const float part = (1 - off * off) * (1 - off * off);
        fit.add(other.powers, other.place, part * other.weight);
        squares += part * off * off * limit * limit / other.variance;
        count += part;
      }
      found = {.surface = fit.solve(),
               .variance = fit.variance(),
               .misfit = count > 0 ? squares / count : 1,
               .off = left_out / all};
      tilt = 0;
    }
    return found;
  }

  void fit(const Peak& own, Facet& facet) const {
    const Found found = fitted(own);
    facet.place = found.surface[0];
    facet.slope_x = found.surface[1] / pitch_px_;
    facet.slope_y = found.surface[2] / pitch_px_;
    facet.sigma = std::sqrt(fit_variance(own, found) + aside_variance(own, found.surface) +
                            scales_.least_sigma * scales_.least_sigma);
  }

  /// A fit is no worse than its own node where neighbours agree. Where some do not, its own may be one
  /// of those.
  float fit_variance(const Peak& own, const Found& found) const {
    constexpr float kOff = 0.5f;
    const float side = kAlike * own.side_px / pitch_px_;
    const float all = found.variance * side * side;
    const float off = kOff * scales_.apart;
    return std::min(all, own.sigma * own.sigma) + all * std::max(found.misfit - 1, 0.0f) +
           found.off * off * off;
  }

  /// What a steep surface may differ by, and one that bends, from what lies so far aside: large windows
  /// do not tell where in them their texture is.
  float aside_variance(const Peak& own, const Coefficients& surface) const {
    constexpr float kAside = 0.1f, kBend = 2;
    const float coarser = (own.side_px - static_cast<float>(nodes_.level.side_px())) / pitch_px_;
    const float dx = shift(own.dx_px), dy = shift(own.dy_px);
    const float steep = kAside * coarser * std::hypot(surface[1], surface[2]);
    const float bent = kBend * (dx * dx + dy * dy) * std::hypot(surface[3], surface[4], surface[5]);
    return steep * steep + bent * bent;
  }

  /// Steepness that a surface may have before it is known, in parts of `apart` for each node.
  static constexpr float kTilt = 0.3f;

  const Nodes& nodes_;
  const Scales& scales_;
  float pitch_px_;
  std::array<float, kReach + 1> near_{};  ///< Weight at so many nodes along one axis.
  std::array<std::array<float, kLookedAt + 1>, kLookedAt + 1> away_{};  ///< [rows][columns], nodes.
  std::vector<Neighbour> neighbours_;
};

}  // namespace

Surface surface_of(const Nodes& nodes, const Scales& scales, int threads) {
  Surface surface{nodes.level, std::vector<Facet>(nodes.peaks.size())};
  share_out(nodes.level.rows, 8, threads, [&](std::size_t first, std::size_t end) {
    Fitter fitter(nodes, scales);
    for (auto row = static_cast<int>(first); row < static_cast<int>(end); ++row) {
      Facet* const line =
          surface.facets.data() + static_cast<std::size_t>(row) * nodes.level.columns;
      for (int column = 0; column < nodes.level.columns; ++column) {
        line[column] = fitter.at(column, row);
      }
    }
  });
  return surface;
}

}  // namespace fathom::depth
