// SPDX-License-Identifier: Apache-2.0
#include "depth/joining.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "engine/quantile.hpp"

namespace fathom::depth {
namespace {

/// 1 for cells that have no depth because there is nothing to see.
std::vector<char> bare_cells(const Cells& cells, const DepthMaps& maps) {
  std::vector<float> known;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cells.is_known(cell)) known.push_back(cells.texture[cell]);
  }
  // The map may call two depths what noise alone makes, so the picture has a say.
  constexpr float kOfUsual = 0.5F;
  const float faint = known.empty() ? 0 : kOfUsual * median(std::move(known));
  std::vector<int> bare(cells.size()), all(cells.size());
  for (int y = 0; y < maps.height_px; ++y) {
    for (int x = 0; x < maps.width_px; ++x) {
      const std::size_t cell = cells.at(x / cells.side_px, y / cells.side_px);
      const DepthClass kind = maps.classes[static_cast<std::size_t>(y) * maps.width_px + x];
      bare[cell] += kind == DepthClass::no_texture;
      all[cell] += kind != DepthClass::known;
    }
  }
  std::vector<char> is_bare(cells.size());
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    is_bare[cell] =
        !cells.is_known(cell) && (2 * bare[cell] > all[cell] || cells.texture[cell] < faint);
  }
  return is_bare;
}

using Pairs = std::set<std::pair<int, int>>;

/// Every part spreads over what is bare around it, all at one speed; those that meet there are
/// neighbours. The known rim of a part is its own.
class Spreading {
 public:
  Spreading(const Cells& cells, const std::vector<int>& owner, const std::vector<char>& jumps,
            const std::vector<char>& bare)
      : cells_(cells), owner_(owner), jumps_(jumps), bare_(bare) {}

  Pairs neighbours() {
    std::vector<std::size_t> front, next;
    for (std::size_t cell = 0; cell < owner_.size(); ++cell) {
      if (owner_[cell] >= 0) front.push_back(cell);
    }
    while (!front.empty()) {
      next.clear();
      for (const std::size_t cell : front) spread(cell, next);
      front.swap(next);
    }
    return std::move(pairs_);
  }

 private:
  void spread(std::size_t cell, std::vector<std::size_t>& next) {
    const auto column = static_cast<int>(cell % cells_.columns);
    const auto row = static_cast<int>(cell / cells_.columns);
    if (column > 0) reach(cell, cell - 1, next);
    if (column + 1 < cells_.columns) reach(cell, cell + 1, next);
    if (row > 0) reach(cell, cell - cells_.columns, next);
    if (row + 1 < cells_.rows) reach(cell, cell + cells_.columns, next);
  }

  void reach(std::size_t from, std::size_t to, std::vector<std::size_t>& next) {
    if (owner_[to] >= 0) {
      const bool is_bare = bare_[from] || bare_[to];
      if (is_bare && owner_[from] != owner_[to])
        pairs_.insert(std::minmax({owner_[from], owner_[to]}));
      return;
    }
    const bool is_rim = cells_.is_known(to) && !jumps_[to] && !bare_[from];
    if (!bare_[to] && !is_rim) return;
    owner_[to] = owner_[from];
    next.push_back(to);
  }

  const Cells& cells_;
  std::vector<int> owner_;
  const std::vector<char>& jumps_;
  const std::vector<char>& bare_;
  Pairs pairs_;
};

/// Whether one part's plane, as far as it is sure to lean, goes through the middle of the other.
bool goes_through(const PartPlane& plane, const PartPlane& other, double shared_sigma) {
  constexpr double kSigmas = 3, kShared = 2, kLeans = 4, kOfStep = 0.5;
  const double dx = other.x - plane.x, dy = other.y - plane.y;
  const auto leans = [](double slope, double sigma) { return std::abs(slope) > kLeans * sigma; };
  double step = 0, unsure = 0;
  if (leans(plane.slope_x, plane.slope_sigma_x)) {
    step += plane.slope_x * dx;
    unsure = std::hypot(unsure, plane.slope_sigma_x * dx);
  }
  if (leans(plane.slope_y, plane.slope_sigma_y)) {
    step += plane.slope_y * dy;
    unsure = std::hypot(unsure, plane.slope_sigma_y * dy);
  }
  const double noise = kSigmas * std::hypot(plane.sigma, other.sigma);
  const double slope = std::min(kSigmas * unsure, kOfStep * std::abs(step));
  const double off = other.position - (plane.position + step);
  return std::abs(off) <= std::hypot(noise, kShared * shared_sigma, slope);
}

/// The larger part has more to say of the plane.
bool share_a_plane(const Moments& a, const Moments& b, const DepthMaps& maps) {
  const bool a_first = a.weight() >= b.weight();
  const PartPlane large = (a_first ? a : b).plane(maps.reach_px);
  const PartPlane small = (a_first ? b : a).plane(maps.reach_px);
  return goes_through(large, small, maps.shared_sigma);
}

/// Parts that were joined, each known by its least number.
class Groups {
 public:
  explicit Groups(std::vector<Moments> moments) : moments_(std::move(moments)) {
    numbers_.resize(moments_.size());
    std::iota(numbers_.begin(), numbers_.end(), 0);
  }

  int of(int part) const {
    while (numbers_[static_cast<std::size_t>(part)] != part)
      part = numbers_[static_cast<std::size_t>(part)];
    return part;
  }

  /// Whether they were two groups on one plane, and are one now.
  bool join(int a, int b, const DepthMaps& maps) {
    const auto [low, high] = std::minmax({of(a), of(b)});
    if (low == high) return false;
    Moments& kept = moments_[static_cast<std::size_t>(low)];
    const Moments& added = moments_[static_cast<std::size_t>(high)];
    if (kept.empty() || added.empty() || !share_a_plane(kept, added, maps)) return false;
    kept += added;
    numbers_[static_cast<std::size_t>(high)] = low;
    return true;
  }

  double weight(int part) const { return moments_[static_cast<std::size_t>(of(part))].weight(); }

 private:
  std::vector<Moments> moments_;
  std::vector<int> numbers_;
};

}  // namespace

std::vector<int> joined_parts(const Cells& cells, const DepthMaps& maps,
                              const std::vector<int>& owner, const std::vector<char>& jumps,
                              std::vector<Moments> moments) {
  const Pairs met = Spreading(cells, owner, jumps, bare_cells(cells, maps)).neighbours();
  std::vector<std::pair<int, int>> pairs(met.begin(), met.end());
  const std::size_t parts = moments.size();
  Groups groups(std::move(moments));
  // The surest first: what they say of the plane decides on the smaller ones.
  const auto smaller = [&](const std::pair<int, int>& pair) {
    return std::min(groups.weight(pair.first), groups.weight(pair.second));
  };
  std::ranges::stable_sort(pairs,
                           [&](const auto& a, const auto& b) { return smaller(a) > smaller(b); });
  constexpr int kMostPasses = 8;
  for (int pass = 0, joined = 1; pass < kMostPasses && joined > 0; ++pass) {
    joined = 0;
    for (const auto& [a, b] : pairs) joined += groups.join(a, b, maps);
  }
  std::vector<int> numbers;
  for (std::size_t part = 0; part < parts; ++part)
    numbers.push_back(groups.of(static_cast<int>(part)));
  return numbers;
}

}  // namespace fathom::depth
