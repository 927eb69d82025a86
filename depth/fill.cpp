// SPDX-License-Identifier: Apache-2.0
// Holes in a map are closed twice over: at cliffs each pixel goes to the side that is nearer, the
// guide's edges being far to cross; elsewhere they are closed smoothly, from averages over larger
// and larger cells (Gortler et al., The Lumigraph, 1996: pull and push).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "depth/interruption.hpp"
#include "depth/mapper.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

bool is_told(DepthClass kind) { return kind == DepthClass::known || kind == DepthClass::filled; }

std::size_t pixel_of(const DepthMaps& maps, int x, int y) {
  return static_cast<std::size_t>(y) * maps.width_px + x;
}

// --- How sure that is ---

/// By how much positions differ that lie so far from each other, root mean square: as the map shows
/// it where it is known (Matheron's variogram).
class Variogram {
 public:
  explicit Variogram(const DepthMaps& maps) : differences_(kLags) {
    for (const bool is_across : {true, false}) {
      double before = 0;
      for (int i = 0; i < kLags; ++i) {
        before = std::max(before, difference_at(maps, 1 << i, is_across).value_or(2 * before));
        differences_[i] = std::max(differences_[i], static_cast<float>(before));
      }
    }
  }

  /// At the next lag that is as far.
  float at(float distance_px) const {
    std::size_t lag = 0;
    while (lag + 1 < differences_.size() && static_cast<float>(1 << lag) < distance_px) ++lag;
    return differences_[lag];
  }

 private:
  static constexpr int kLags = 13;

  /// Along one axis; nothing where too few are known. There the surface may go on as steeply.
  static std::optional<double> difference_at(const DepthMaps& maps, int lag, bool is_across) {
    constexpr std::size_t kLooked = 200'000, kFewest = 50;
    const std::size_t every = std::max<std::size_t>(maps.classes.size() / kLooked, 1);
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < maps.classes.size(); i += every) {
      const auto x = static_cast<int>(i % maps.width_px), y = static_cast<int>(i / maps.width_px);
      if (is_across ? x + lag >= maps.width_px : y + lag >= maps.height_px) continue;
      const std::size_t other = i + static_cast<std::size_t>(lag) *
                                        static_cast<std::size_t>(is_across ? 1 : maps.width_px);
      if (maps.classes[i] != DepthClass::known || maps.classes[other] != DepthClass::known)
        continue;
      squares += std::pow(static_cast<double>(maps.position[i]) - maps.position[other], 2);
      ++count;
    }
    if (count < kFewest) return std::nullopt;
    return std::sqrt(squares / static_cast<double>(count));
  }

  std::vector<float> differences_;
};

/// Sigma of what is filled. It covers how much the surface may differ that far from what is known; and
/// where the focus lies at an end of the travel or beyond it, the way to the farther end.
class Doubt {
 public:
  explicit Doubt(const DepthMaps& maps)
      : variogram_(maps), classes_(maps.classes), distance_(maps.classes.size(), kFar) {
    for (std::size_t i = 0; i < distance_.size(); ++i) {
      if (!is_told(maps.classes[i])) continue;
      distance_[i] = 0;
      low_ = std::min(low_, maps.position[i]);
      high_ = std::max(high_, maps.position[i]);
    }
    low_ = std::isnan(maps.lowest) ? low_ : maps.lowest;
    high_ = std::isnan(maps.highest) ? high_ : maps.highest;
    sweep(maps.width_px, maps.height_px, 1);
    sweep(maps.width_px, maps.height_px, -1);
  }

  void add_to(DepthMaps& maps) const {
    for (std::size_t i = 0; i < distance_.size(); ++i) {
      if (maps.classes[i] != DepthClass::filled || is_told(classes_[i])) continue;
      float& sigma = maps.sigma[i];
      sigma = std::hypot(sigma, variogram_.at(distance_[i]));
      const float place = maps.position[i];
      if (classes_[i] == DepthClass::at_end) sigma = std::max({sigma, place - low_, high_ - place});
    }
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::max();

  /// Along rows and columns only: somewhat too far is on the safe side.
  void sweep(int width, int height, int way) {
    const int first = way > 0 ? 0 : width * height - 1;
    for (int step = 0; step < width * height; ++step) {
      const int i = first + way * step, x = i % width, y = i / width;
      float& here = distance_[static_cast<std::size_t>(i)];
      const int before_x = x - way, before_y = y - way;
      if (before_x >= 0 && before_x < width) here = std::min(here, distance_[i - way] + 1);
      if (before_y >= 0 && before_y < height) here = std::min(here, distance_[i - way * width] + 1);
    }
  }

  Variogram variogram_;
  std::vector<DepthClass> classes_;  ///< Before anything was filled.
  std::vector<float> distance_;      ///< To what is known, px.
  float low_ = kFar, high_ = -kFar;
};

// --- Cliffs ---

/// Brings to every pixel of two depths the position of the known one that costs least to reach.
class NearestSide {
 public:
  NearestSide(DepthMaps& maps, const Frame* guide)
      : maps_(maps), guide_(guide), cost_(maps.position.size(), kFar), step_(scale_of(guide)) {
    for (std::size_t i = 0; i < cost_.size(); ++i) {
      if (is_told(maps_.classes[i])) cost_[i] = 0;
    }
  }

  void run() {
    constexpr int kTimes = 2;
    for (int i = 0; i < kTimes; ++i) {
      sweep(1);
      sweep(-1);
    }
    for (std::size_t i = 0; i < cost_.size(); ++i) {
      if (maps_.classes[i] != DepthClass::two_depths || cost_[i] == kFar) continue;
      maps_.classes[i] = DepthClass::filled;
      maps_.confidence[i] = 0;
    }
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::max();

  /// Cost of a grey level between neighbours: as many as the picture usually has cost a pixel more.
  static float scale_of(const Frame* guide) {
    if (!guide) return 0;
    double sum = 1;
    std::size_t count = 1;
    constexpr int kEvery = 7;
    for (int y = 0; y < guide->height_px(); y += kEvery) {
      for (int x = 1; x < guide->width_px(); x += kEvery, ++count) {
        sum += std::abs(static_cast<double>(guide->at(x, y)) - guide->at(x - 1, y));
      }
    }
    return static_cast<float>(static_cast<double>(count) / sum);
  }

  /// From the first pixel to the last, or back; of each one's neighbours those that came before.
  void sweep(int way) {
    const int w = maps_.width_px, h = maps_.height_px;
    for (int row = 0; row < h; ++row) {
      depth::look_for_interruption();
      const int y = way > 0 ? row : h - 1 - row;
      for (int column = 0; column < w; ++column) {
        const int x = way > 0 ? column : w - 1 - column;
        if (maps_.classes[pixel_of(maps_, x, y)] != DepthClass::two_depths) continue;
        reach(x, y, x - way, y, 1);
        reach(x, y, x, y - way, 1);
        reach(x, y, x - way, y - way, std::numbers::sqrt2_v<float>);
        reach(x, y, x + way, y - way, std::numbers::sqrt2_v<float>);
      }
    }
  }

  void reach(int x, int y, int from_x, int from_y, float distance) {
    if (from_x < 0 || from_y < 0 || from_x >= maps_.width_px || from_y >= maps_.height_px) return;
    const std::size_t here = pixel_of(maps_, x, y), from = pixel_of(maps_, from_x, from_y);
    if (cost_[from] == kFar) return;
    const float cost = cost_[from] + distance + edge(x, y, from_x, from_y);
    if (cost >= cost_[here]) return;
    cost_[here] = cost;
    maps_.position[here] = maps_.position[from];
    maps_.sigma[here] = maps_.sigma[from];
  }

  float edge(int x, int y, int from_x, int from_y) const {
    if (!guide_) return 0;
    return step_ * std::abs(static_cast<float>(guide_->at(x, y)) -
                            static_cast<float>(guide_->at(from_x, from_y)));
  }

  DepthMaps& maps_;
  const Frame* guide_;
  std::vector<float> cost_;
  float step_;
};

// --- Elsewhere ---

/// What is known within a square of pixels.
struct Cell {
  float weight = 0;
  float mean = 0;
  float square = 0;    ///< Mean square of the positions about the origin of the map.
  float variance = 0;  ///< Mean of their own.

  void add(const Cell& other, float times) {
    if (other.weight * times == 0) return;
    const float part = other.weight * times / (weight + other.weight * times);
    weight += other.weight * times;
    mean += part * (other.mean - mean);
    square += part * (other.square - square);
    variance += part * (other.variance - variance);
  }
};

struct Cells {
  int width = 0, height = 0;
  std::vector<Cell> cells;

  const Cell& at(int x, int y) const {
    return cells[static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * width +
                 std::clamp(x, 0, width - 1)];
  }
};

/// Cells of twice the side.
template <class At>
Cells pulled(int width, int height, const At& at) {
  Cells out{(width + 1) / 2, (height + 1) / 2, {}};
  out.cells.resize(static_cast<std::size_t>(out.width) * out.height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      out.cells[static_cast<std::size_t>(y / 2) * out.width + x / 2].add(at(x, y), 1);
    }
  }
  // However much is known of a cell, what is beside it counts as one.
  for (Cell& cell : out.cells) cell.weight = std::min(cell.weight, 1.0f);
  return out;
}

/// What cells of twice the side say of one.
Cell pushed(const Cells& larger, int x, int y) {
  constexpr float kNear = 0.75f, kFar = 0.25f;
  Cell cell;
  for (int i = 0; i < 4; ++i) {
    const int beside_x = i % 2 ? (x % 2 ? 1 : -1) : 0, beside_y = i / 2 ? (y % 2 ? 1 : -1) : 0;
    cell.add(larger.at(x / 2 + beside_x, y / 2 + beside_y),
             (i % 2 ? kFar : kNear) * (i / 2 ? kFar : kNear));
  }
  return cell;
}

class Smoothly {
 public:
  explicit Smoothly(DepthMaps& maps) : maps_(maps) {
    for (std::size_t i = 0; i < maps.position.size() && !has_origin_; ++i) {
      has_origin_ = is_told(maps.classes[i]);
      origin_ = has_origin_ ? maps.position[i] : 0;
    }
  }

  void run() {
    if (!has_origin_) return;
    pull();
    for (std::size_t level = levels_.size() - 1; level-- > 0;) push(level);
    for (int y = 0; y < maps_.height_px; ++y) {
      depth::look_for_interruption();
      for (int x = 0; x < maps_.width_px; ++x) {
        const std::size_t pixel = pixel_of(maps_, x, y);
        if (!is_told(maps_.classes[pixel])) write(pixel, pushed(levels_[0], x, y));
      }
    }
  }

 private:
  Cell cell_of(int x, int y) const {
    const std::size_t pixel = pixel_of(maps_, x, y);
    if (!is_told(maps_.classes[pixel])) return {};
    const float place = maps_.position[pixel] - origin_, sigma = maps_.sigma[pixel];
    return {.weight = 1, .mean = place, .square = place * place, .variance = sigma * sigma};
  }

  void pull() {
    levels_.push_back(
        pulled(maps_.width_px, maps_.height_px, [this](int x, int y) { return cell_of(x, y); }));
    while (levels_.back().cells.size() > 1) {
      const Cells& last = levels_.back();
      levels_.push_back(
          pulled(last.width, last.height, [&](int x, int y) { return last.at(x, y); }));
    }
  }

  void push(std::size_t level) {
    Cells& cells = levels_[level];
    for (int y = 0; y < cells.height; ++y) {
      for (int x = 0; x < cells.width; ++x) {
        Cell& cell = cells.cells[static_cast<std::size_t>(y) * cells.width + x];
        cell.add(pushed(levels_[level + 1], x, y), 1 - cell.weight);
        cell.weight = 1;
      }
    }
  }

  void write(std::size_t pixel, const Cell& cell) {
    const float spread = std::max(cell.square - cell.mean * cell.mean, 0.0f);
    maps_.position[pixel] = origin_ + cell.mean;
    maps_.sigma[pixel] = std::sqrt(cell.variance + spread);
    maps_.confidence[pixel] = 0;
    maps_.classes[pixel] = DepthClass::filled;
  }

  DepthMaps& maps_;
  std::vector<Cells> levels_;
  bool has_origin_ = false;
  float origin_ = 0;
};

}  // namespace

void fill(DepthMaps& maps, const Frame* guide) {
  if (guide && (guide->width_px() != maps.width_px || guide->height_px() != maps.height_px)) {
    throw Error(ErrorCode::bad_argument, "the guide of a map must have the map's size");
  }
  const Doubt doubt(maps);
  NearestSide(maps, guide).run();
  Smoothly(maps).run();
  doubt.add_to(maps);
}

}  // namespace fathom
