// SPDX-License-Identifier: Apache-2.0
#include "session/beside.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Pixels along a side of what is looked at, and what tells anything at all.
constexpr int kSide = 64, kSmallest = 32;

/// The window, or a square round it that tells more; nothing where the picture is too small.
std::optional<Window> square_round(const Frame& frame, const Window& window) {
  const int room = std::min(frame.width_px(), frame.height_px());
  const int n = std::max(window.n, std::min(kSide, room));
  if (n < kSmallest) return std::nullopt;
  const int grown = (n - window.n) / 2;
  return Window{std::clamp(window.x - grown, 0, frame.width_px() - n),
                std::clamp(window.y - grown, 0, frame.height_px() - n), n};
}

/// Of a large window the square with the most detail.
Window liveliest(const Frame& frame, const Window& window) {
  if (window.n <= kSide) return window;
  const auto energy = detail_energy(patch_of(frame, {window.x, window.y, window.n, window.n}));
  Window best{window.x, window.y, kSide};
  double most = -1;
  for (int y = 0; y + kSide <= window.n; y += kSide / 2) {
    for (int x = 0; x + kSide <= window.n; x += kSide / 2) {
      double sum = 0;
      for (int row = y; row < y + kSide; ++row) {
        const float* const line = energy.data() + static_cast<std::size_t>(row) * window.n + x;
        for (int i = 0; i < kSide; ++i) sum += line[i];
      }
      if (sum <= most) continue;
      most = sum;
      best = {window.x + x, window.y + y, kSide};
    }
  }
  return best;
}

}  // namespace

std::optional<Resemblance> compare(const Frame& best, const Frame& other, const Window& window,
                                   int reach_px) {
  const auto square = square_round(best, window);
  const bool is_alike =
      best.width_px() == other.width_px() && best.height_px() == other.height_px();
  if (!square || !is_alike) return std::nullopt;
  const Window here = liveliest(best, *square);
  const int left = std::max(0, here.x - reach_px), top = std::max(0, here.y - reach_px);
  const int right = std::min(other.width_px(), here.x + here.n + reach_px);
  const int bottom = std::min(other.height_px(), here.y + here.n + reach_px);
  return compare(patch_of(best, {here.x, here.y, here.n, here.n}),
                 patch_of(other, {left, top, right - left, bottom - top}), here.x - left,
                 here.y - top, reach_px);
}

namespace {

/// Where a recording has pictures, in the order of positions.
std::vector<double> places_of(Rig& rig, const Focus& focus) {
  std::vector<double> places = rig.lens().info().stops;
  if (!places.empty()) return places;
  for (const Evaluation& e : focus.evaluations) places.push_back(e.position);
  std::sort(places.begin(), places.end());
  return places;
}

/// The picture there; nothing where it cannot be read, which is no fault of the peak.
std::optional<Frame> picture_at(Rig& rig, double position) {
  try {
    return shoot(rig.camera(), rig.lens(), position, rig.options().shot).frame;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    return std::nullopt;
  }
}

/// With the nearest picture on one side (step -1 or 1) that is there, and no copy.
std::optional<Resemblance> compare_side(Rig& rig, const Frame& best, std::span<const double> places,
                                        std::ptrdiff_t at, int step) {
  constexpr int kReach_px = 32, kTries = 3;
  for (int i = 1; i <= kTries; ++i) {
    const std::ptrdiff_t place = at + i * step;
    if (place < 0 || place >= std::ssize(places)) return std::nullopt;
    const auto other = picture_at(rig, places[static_cast<std::size_t>(place)]);
    if (!other) continue;
    if (auto found = compare(best, *other, rig.window(), kReach_px)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Resemblance> compare_beside(Rig& rig, const Focus& focus) {
  const double last = focus.evaluations.back().position;
  const std::vector<double> places = places_of(rig, focus);
  const double position = best_of(focus.evaluations).position;
  const auto at = std::lower_bound(places.begin(), places.end(), position) - places.begin();
  const auto best = picture_at(rig, position);
  if (!best) return std::nullopt;
  std::optional<Resemblance> resemblance;
  for (const int step : {-1, 1}) {
    const auto side = compare_side(rig, *best, places, at, step);
    if (side && (!resemblance || side->evidence > resemblance->evidence)) resemblance = side;
  }
  arrive(rig.lens(), last);
  return resemblance;
}

void TopKeeper::frame(const Frame& frame, const Arrival&, std::span<const double>) {
  latest_ = frame.clone();
}

void TopKeeper::keep_for_first(double position) {
  if (!first_) {
    first_ = PictureAt{position, latest_.clone()};
    return;
  }
  const double away = std::abs(position - first_->position);
  const bool is_nearer =
      !beside_first_ || away < std::abs(beside_first_->position - first_->position);
  if (is_nearer) beside_first_ = PictureAt{position, latest_.clone()};
}

std::optional<PictureAt> TopKeeper::best() const {
  if (seen_.empty()) return std::nullopt;
  return PictureAt{position_, best_.clone()};
}

void TopKeeper::evaluated(const Measurement& measurement) {
  if (measurement.on_the_way) return;
  constexpr int kReach_px = 2;  // what shakes
  const double score = measurement.sample().score;
  const bool is_new = seen_.insert(measurement.position).second;
  keep_for_first(measurement.position);
  if (is_new && score > score_) {
    score_ = score;
    position_ = measurement.position;
    best_ = std::move(latest_);
  } else if (!is_new && measurement.position == position_) {
    resemblance_ = compare(best_, latest_, window_, kReach_px);
  }
}

}  // namespace fathom
