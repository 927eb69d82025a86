// SPDX-License-Identifier: Apache-2.0
// A focus curve: what was evaluated, in the order of positions, with what every judgement of it
// asks for.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sample.hpp"

namespace fathom {

/// One entry of the thesis' arrays: the how-many-eth evaluation, where, and what it gave.
struct Evaluation {
  int loop = 0;                             ///< 1 for the first evaluation.
  double position = 0;                      ///< Where the lens really stood, in its unit.
  double score = 0;                         ///< Focus quality there.
  PictureFacts picture = {};                ///< Of the picture that was scored.
  std::optional<OnTheWay> on_the_way = {};  ///< Absent where the lens stood still for it.

  bool operator==(const Evaluation&) const = default;
};

/// Fewer live evaluations than this leave nothing to judge a focus by.
inline constexpr std::size_t kFewestLive = 3;

/// From so many evaluations on the steps between neighbours say something of the noise.
inline constexpr std::size_t kDense = 30;

/// Immutable. Its floor and its best are found once, when it is made.
class FocusCurve {
 public:
  FocusCurve() = default;
  /// Sorts by position; evaluations of one position keep their order.
  explicit FocusCurve(std::vector<Evaluation> evaluations);

  /// All of them, sorted by position.
  const std::vector<Evaluation>& evaluations() const { return evaluations_; }
  /// Those above a thousandth of the median of all scores above 0. The others are of black or
  /// wholly saturated pictures: their scores are nothing, and say nothing of the floor.
  const std::vector<Evaluation>& live() const { return live_; }
  /// How many are not live.
  std::size_t dead() const { return evaluations_.size() - live_.size(); }

  bool empty() const { return evaluations_.empty(); }
  std::size_t size() const { return evaluations_.size(); }
  const Evaluation& operator[](std::size_t i) const { return evaluations_[i]; }
  const Evaluation& front() const { return evaluations_.front(); }
  const Evaluation& back() const { return evaluations_.back(); }

  /// Score far from any focus: what a fifth of the live evaluations lie below; 0 if there are none.
  double floor() const { return floor_; }
  /// Index of the highest score, the first of equals; 0 in an empty curve.
  std::size_t best() const { return best_; }
  /// The evaluation with that score; the curve must not be empty.
  const Evaluation& top() const { return evaluations_[best_]; }
  /// How far its score stands above the floor.
  double height() const { return top().score - floor_; }

 private:
  std::vector<Evaluation> evaluations_;
  std::vector<Evaluation> live_;
  double floor_ = 0;
  std::size_t best_ = 0;
};

/// Those of the live ones that scored least, a fifth of them and two at least: what pictures are like
/// far from any focus.
std::vector<Evaluation> far_from_focus(const FocusCurve& curve);

/// The evaluation with the highest score, the earliest of equals, in whatever order they are.
/// Throws Error(bad_argument) if there is none.
const Evaluation& best_of(std::span<const Evaluation> evaluations);

/// First and last index of the evaluations above `least` that hang together with the one at `best`,
/// which is one of them whatever its score. curve: sorted by position.
std::pair<std::size_t, std::size_t> reach(std::span<const Evaluation> curve, std::size_t best,
                                          double least);

}  // namespace fathom
