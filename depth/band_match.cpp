// SPDX-License-Identifier: Apache-2.0
#include "depth/band_match.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fathom::depth {
namespace {

using Complex = std::complex<double>;

/// Cells along a side of a part, and how many of its places are looked at: enough for either.
constexpr int kPart = 32, kMostPlaces = 224;

/// Turns values, `count` of them `step` apart, into coefficients of cubic B-splines.
void make_splines(float* values, int count, std::size_t step) {
  constexpr float kPole = -0.26794919F;  // sqrt(3) - 2
  constexpr int kReach = 12;             // what the pole leaves of a value by then nobody sees
  const auto at = [&](int i) -> float& { return values[static_cast<std::size_t>(i) * step]; };
  float power = kPole;
  for (int i = 1; i < std::min(kReach, count); ++i, power *= kPole) at(0) += power * at(i);
  for (int i = 1; i < count; ++i) at(i) += kPole * at(i - 1);
  at(count - 1) *= -kPole / (1 - kPole);
  for (int i = count - 1; i-- > 0;) at(i) = kPole * (at(i + 1) - at(i));
  for (int i = 0; i < count; ++i) at(i) *= 6;
}

/// Weights of the four cells around a point that lies t beyond the second of them.
std::array<float, 4> spline(float t) {
  constexpr float kSixth = 1.0F / 6;
  const float s = 1 - t;
  return {kSixth * s * s * s, kSixth * (4 - 3 * t * t * (1 + s)),
          kSixth * (4 - 3 * s * s * (1 + t)), kSixth * t * t * t};
}

/// The value between 16 cells; the caller has made sure that they are there.
float value_at(const Plane& plane, float x, float y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto across = spline(x - static_cast<float>(left)),
             down = spline(y - static_cast<float>(top));
  const float* row = plane.row(top - 1) + left - 1;
  float sum = 0;
  for (int j = 0; j < 4; ++j, row += plane.width) {
    sum += down[j] *
           (across[0] * row[0] + across[1] * row[1] + across[2] * row[2] + across[3] * row[3]);
  }
  return sum;
}

}  // namespace

Band::Band(Plane its_values) : values(std::move(its_values)), splines(values) {
  for (int y = 0; y < splines.height; ++y) make_splines(splines.row(y), splines.width, 1);
  for (int x = 0; x < splines.width; ++x)
    make_splines(splines.row(0) + x, splines.height, static_cast<std::size_t>(splines.width));
}

BandMatch::BandMatch(const Band& before, const Band& after, int unknowns)
    : before_(before.values),
      after_(after.splines),
      unknowns_(unknowns),
      middle_(0.5 * (before_.width - 1), 0.5 * (before_.height - 1)),
      // At an edge a band shows what is repeated beyond it, which stands still.
      rim_(std::clamp(std::min(before_.width, before_.height) / 10, 1, 8)) {
  choose_places();
}

void BandMatch::choose_places() {
  const int right = before_.width - rim_, bottom = before_.height - rim_;
  for (int top = rim_; top < bottom; top += kPart) {
    for (int left = rim_; left < right; left += kPart)
      add_part(left, top, std::min(left + kPart, right), std::min(top + kPart, bottom));
  }
}

void BandMatch::add_part(int left, int top, int right, int bottom) {
  const std::size_t begin = places_.size();
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const float* const here = before_.row(y) + x;
      const float dx = 0.5F * (here[1] - here[-1]);
      const float dy = 0.5F * (here[before_.width] - here[-before_.width]);
      places_.push_back({.x = static_cast<float>(x),
                         .y = static_cast<float>(y),
                         .value = *here,
                         .slopes = {0, 0, dx, dy}});
    }
  }
  choose_steepest(begin);
  Part part{.begin = begin,
            .end = places_.size(),
            .left = static_cast<float>(left),
            .top = static_cast<float>(top),
            .right = static_cast<float>(right - 1),
            .bottom = static_cast<float>(bottom - 1),
            .sums = {}};
  for (std::size_t i = part.begin; i < part.end; ++i) {
    add_slopes(places_[i]);
    add_before(places_[i], part, part.sums);
  }
  parts_.push_back(part);
}

void BandMatch::choose_steepest(std::size_t begin) {
  if (places_.size() - begin <= kMostPlaces) return;
  const auto steepness = [](const Place& place) {
    return place.slopes[2] * place.slopes[2] + place.slopes[3] * place.slopes[3];
  };
  const auto first = places_.begin() + static_cast<std::ptrdiff_t>(begin);
  std::nth_element(first, first + kMostPlaces, places_.end(),
                   [&](const Place& a, const Place& b) { return steepness(a) > steepness(b); });
  places_.resize(begin + kMostPlaces);
}

void BandMatch::add_slopes(Place& place) const {
  const auto x = static_cast<float>((place.x - middle_.real()) / reach());
  const auto y = static_cast<float>((place.y - middle_.imag()) / reach());
  const float dx = place.slopes[2], dy = place.slopes[3];
  place.slopes[0] = dx * x + dy * y;
  place.slopes[1] = dy * x - dx * y;
}

BandMatch::Gains BandMatch::gains_of(const Place& place, const Part& part) {
  constexpr float kScale = 2.0F / kPart;
  const float u = kScale * (place.x - 0.5F * (part.left + part.right));
  const float v = kScale * (place.y - 0.5F * (part.top + part.bottom));
  return {place.value, u * place.value, v * place.value};
}

void BandMatch::add_before(const Place& place, const Part& part, Sums& sums) {
  const Gains b = gains_of(place, part);
  sums.count += 1;
  for (int g = 0; g < kGains; ++g) {
    for (int h = 0; h < kGains; ++h) sums.bb[g][h] += b[g] * b[h];
    for (int k = 0; k < kUnknowns; ++k) sums.bs[k][g] += place.slopes[k] * b[g];
  }
  for (int k = 0; k < kUnknowns; ++k) {
    for (int j = 0; j < kUnknowns; ++j) sums.ss[j][k] += place.slopes[j] * place.slopes[k];
  }
}

void BandMatch::add_after(const Place& place, const Part& part, float after, Sums& sums) {
  const Gains b = gains_of(place, part);
  const double a = after;
  sums.aa += a * a;
  for (int g = 0; g < kGains; ++g) sums.ba[g] += b[g] * a;
  for (int k = 0; k < kUnknowns; ++k) sums.sa[k] += place.slopes[k] * a;
}

bool BandMatch::is_there(const Motion& motion, float x, float y) const {
  const Complex there = motion.turn * (Complex(x, y) - middle_) + motion.shift + middle_;
  return there.real() >= rim_ && there.imag() >= rim_ && there.real() < after_.width - 2 - rim_ &&
         there.imag() < after_.height - 2 - rim_;
}

BandMatch::Sums BandMatch::sums_of(const Part& part, const Motion& motion) const {
  const bool is_whole =
      is_there(motion, part.left, part.top) && is_there(motion, part.right, part.top) &&
      is_there(motion, part.left, part.bottom) && is_there(motion, part.right, part.bottom);
  Sums sums = is_whole ? part.sums : Sums{};
  const Complex origin = motion.shift + middle_ - motion.turn * middle_;
  for (std::size_t i = part.begin; i < part.end; ++i) {
    const Place& place = places_[i];
    if (!is_whole && !is_there(motion, place.x, place.y)) continue;
    if (!is_whole) add_before(place, part, sums);
    const Complex there = motion.turn * Complex(place.x, place.y) + origin;
    add_after(place, part,
              value_at(after_, static_cast<float>(there.real()), static_cast<float>(there.imag())),
              sums);
  }
  return sums;
}

/// A part whose gains are the best ones: what they explain is taken out of slopes and values.
struct BandMatch::Solved {
  explicit Solved(const Sums& its) : sums(its) {
    for (int g = 0; g < kGains; ++g) {  // Cholesky's decomposition of bb
      for (int h = 0; h <= g; ++h) {
        double rest = sums.bb[g][h];
        for (int k = 0; k < h; ++k) rest -= lower[g][k] * lower[h][k];
        if (g != h) {
          lower[g][h] = rest / lower[h][h];
        } else if (rest > 1e-9 * sums.bb[g][g]) {
          lower[g][g] = std::sqrt(rest);
        } else {
          return;
        }
      }
    }
    is_determined = true;
    after = reduced(sums.ba);
    for (int k = 0; k < kUnknowns; ++k) slopes[k] = reduced(sums.bs[k]);
    Gains gains = after;
    for (int g = kGains; g-- > 0;) {
      for (int h = g + 1; h < kGains; ++h) gains[g] -= lower[h][g] * gains[h];
      gains[g] /= lower[g][g];
    }
    gain = gains[0];
  }
  Gains reduced(Gains values) const {
    for (int g = 0; g < kGains; ++g) {
      for (int h = 0; h < g; ++h) values[g] -= lower[g][h] * values[h];
      values[g] /= lower[g][g];
    }
    return values;
  }
  static double product(const Gains& a, const Gains& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  /// Whether the other band shows the same at all.
  bool is_alike() const { return is_determined && gain > 0; }
  /// Squares of the other band that are not explained.
  double left() const {
    return is_alike() ? std::max(sums.aa - product(after, after), 0.0) : sums.aa;
  }

  Sums sums;
  bool is_determined = false;
  double gain = 0;
  std::array<Gains, kGains> lower{};
  Gains after{};
  std::array<Gains, kUnknowns> slopes{};
};

std::vector<BandMatch::Solved> BandMatch::solved_at(const Motion& motion) const {
  std::vector<Solved> solved;
  for (const Part& part : parts_) {
    Solved its(sums_of(part, motion));
    if (its.is_alike()) solved.push_back(its);
  }
  return solved;
}

std::optional<BandMatch::Unknowns> BandMatch::solve(Equations e, int unknowns) {
  for (int i = 0; i < unknowns; ++i) {
    const double pivot = e.square[i][i];
    if (!(pivot > 1e-9)) return std::nullopt;
    for (int j = i + 1; j < unknowns; ++j) {
      const double factor = e.square[j][i] / pivot;
      for (int k = i; k < unknowns; ++k) e.square[j][k] -= factor * e.square[i][k];
      e.right[j] -= factor * e.right[i];
    }
  }
  Unknowns result{};
  for (int i = unknowns - 1; i >= 0; --i) {
    double sum = e.right[i];
    for (int k = i + 1; k < unknowns; ++k) sum -= e.square[i][k] * result[k];
    result[i] = sum / e.square[i][i];
  }
  return result;
}

Motion BandMatch::improved(Motion motion) const {
  constexpr int kMostSteps = 12;
  constexpr double kSmall = 0.0005;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto change = solve(equations_of(solved_at(motion)), unknowns_);
    if (!change) return motion;
    const auto& [growth, turn, dx, dy] = *change;
    motion.turn -= Complex(growth, turn) / reach();
    motion.shift -= Complex(dx, dy);
    if (std::abs(growth) + std::abs(turn) + std::abs(dx) + std::abs(dy) < kSmall) break;
  }
  return motion;
}

BandMatch::Equations BandMatch::equations_of(const std::vector<Solved>& parts) const {
  double left = 0, count = 0;
  for (const Solved& part : parts) {
    left += part.left();
    count += part.sums.count;
  }
  // What moves by itself is less alike and counts less; what is far out of focus, where texture is
  // faint and its waves come and go, does not count more because little of it is left.
  constexpr double kUsual = 5, kNothing = 1e-9;
  const double usual = kUsual * left / std::max(count, 1.0) + kNothing;
  Equations equations;
  for (const Solved& part : parts) {
    const double weight = part.gain / (part.left() / part.sums.count + usual);
    for (int i = 0; i < unknowns_; ++i) {
      equations.right[i] +=
          weight * (part.sums.sa[i] - Solved::product(part.slopes[i], part.after));
      for (int j = 0; j < unknowns_; ++j) {
        const double own = part.sums.ss[i][j] - Solved::product(part.slopes[i], part.slopes[j]);
        equations.square[i][j] += weight * part.gain * own;
      }
    }
  }
  return equations;
}

double BandMatch::growth_sigma(const Motion& motion) const {
  // Some 16 places say one thing, and what is left is counted five times where they are weighed; no
  // pair is trusted to better than a fiftieth of a cell at the corner.
  constexpr double kCounted = 16.0 / 5, kLeast = 0.02;
  const double information = equations_of(solved_at(motion)).square[0][0];
  return std::hypot(std::sqrt(kCounted / std::max(information, 1e-9)), kLeast) / reach();
}

double BandMatch::unlike(const Motion& motion) const {
  double left = 0, all = 0;
  for (const Part& part : parts_) {
    const Solved solved(sums_of(part, motion));
    left += solved.left();
    all += solved.sums.aa;
  }
  return all > 0 ? left / all : 1;
}

bool BandMatch::is_beyond_chance(const Motion& motion, const Motion& than) const {
  constexpr double kIndependent = 1.0 / 16, kLeast = 8;  // so many places say one thing
  // Smooth noise has fewer of them, and a grid of its own, but nothing in common with the next frame's.
  constexpr double kMostUnlike = 0.9;
  const double left = unlike(motion), still = unlike(than);
  if (left > kMostUnlike) return false;
  if (!(left > 0)) return left < still;
  const double things = kIndependent * static_cast<double>(places_.size());
  return (still - left) / left * things / unknowns_ > kLeast;
}

}  // namespace fathom::depth
