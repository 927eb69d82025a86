// SPDX-License-Identifier: Apache-2.0
#include "depth/align.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <utility>
#include <vector>

#include "depth/band_match.hpp"
#include "depth/growth_fit.hpp"
#include "depth/plane.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

using depth::Band;
using depth::BandMatch;
using depth::Motion;
using depth::Plane;
using Complex = std::complex<double>;

constexpr int kLargestSide = 800;
constexpr int kSmallestSide = 24;

/// Sums of `factor` greys of a row each.
void add_row(const Frame& frame, int y, int factor, std::vector<std::uint32_t>& sums) {
  const std::byte* at = frame.row(y);
  const bool is_wide = frame.depth() == Depth::bits16;
  for (std::uint32_t& sum : sums) {
    for (int k = 0; k < factor; ++k) {
      std::uint16_t grey = std::to_integer<std::uint16_t>(*at);
      if (is_wide) std::memcpy(&grey, at, sizeof grey);
      sum += grey;
      at += bytes_per_pixel(frame.depth());
    }
  }
}

/// The grey values, in cells of `factor` x `factor` px; what is left over at the far edges is not
/// looked at.
Plane reduced(const Frame& frame, int factor) {
  Plane plane(frame.width_px() / factor, frame.height_px() / factor);
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(plane.width));
  for (int y = 0; y < plane.height; ++y) {
    std::fill(sums.begin(), sums.end(), 0u);
    for (int r = 0; r < factor; ++r) add_row(frame, y * factor + r, factor, sums);
    for (int x = 0; x < plane.width; ++x)
      plane.row(y)[x] = static_cast<float>(sums[static_cast<std::size_t>(x)]);
  }
  return plane;
}

/// Means over 2 kReach + 1 values, `count` of them `step` apart; those at the ends repeat.
void average(const float* from, int count, std::size_t step, float* to) {
  constexpr int kReach = 4;
  const auto at = [&](int i) {
    return from[static_cast<std::size_t>(std::clamp(i, 0, count - 1)) * step];
  };
  float sum = 0;
  for (int i = -kReach; i <= kReach; ++i) sum += at(i);
  for (int i = 0; i < count; ++i) {
    to[static_cast<std::size_t>(i) * step] = sum / (2 * kReach + 1);
    sum += at(i + kReach + 1) - at(i - kReach);
  }
}

/// Periods from some 8 to some 40 cells. Nothing here may know of a grid that is coarser than cells,
/// which would stand still while the picture moves.
Plane band_of(const Plane& plane) {
  Plane low = plane, other = plane;
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < low.height; ++y) average(low.row(y), low.width, 1, other.row(y));
    for (int x = 0; x < low.width; ++x)
      average(other.row(0) + x, low.height, static_cast<std::size_t>(low.width), low.row(0) + x);
  }
  Plane band = depth::smoothed(depth::smoothed(depth::smoothed(plane)));
  for (std::size_t i = 0; i < band.values.size(); ++i) band.values[i] -= low.values[i];
  return band;
}

/// A frame as it is compared: bands from fine to coarse, each a quarter of the one before.
std::vector<Band> bands_of(const Frame& frame, int factor) {
  std::vector<Band> bands;
  Plane plane = reduced(frame, factor);
  while (std::min(plane.width, plane.height) >= kSmallestSide || bands.empty()) {
    bands.emplace_back(band_of(plane));
    plane = depth::pooled(plane);
  }
  return bands;
}

}  // namespace

const char* to_string(Alignment alignment) noexcept {
  switch (alignment) {
    case Alignment::none:
      return "none";
    case Alignment::scale:
      return "scale";
    case Alignment::similarity:
      return "similarity";
  }
  return "";
}

class StackAligner::Impl {
 public:
  Impl(Alignment alignment, std::optional<GrowthLaw> law) : alignment_(alignment) {
    if (law && alignment == Alignment::scale) growth_.emplace(*std::move(law));
  }

  Similarity add(const Frame& grey) {
    if (alignment_ == Alignment::none) return {};
    require_alike(grey);
    std::vector<Band> bands = bands_of(grey, factor_);
    if (!before_.empty()) growth_ ? follow_law(bands) : follow(bands);
    before_ = std::move(bands);
    ++frames_;
    return similarity();
  }

  std::optional<double> growth_per_unit() const {
    if (!growth_) return std::nullopt;
    return growth_->per_unit();
  }

 private:
  void require_alike(const Frame& grey) {
    if (width_ == 0) {
      width_ = grey.width_px();
      height_ = grey.height_px();
      factor_ = (std::max(width_, height_) + kLargestSide - 1) / kLargestSide;
    }
    if (grey.width_px() == width_ && grey.height_px() == height_) return;
    throw Error(ErrorCode::bad_argument, "frames of one size alone can be aligned");
  }

  void follow(const std::vector<Band>& bands) {
    pair_ = match(bands);
    whole_ = {pair_.turn * whole_.turn, pair_.turn * whole_.shift + pair_.shift};
  }

  void follow_law(const std::vector<Band>& bands) {
    const Motion told{.turn = growth_->ratio(frames_), .shift = {}};
    const Motion seen = refined(told, bands);
    const BandMatch finest(before_[0], bands[0], 1);
    constexpr double kMostUnlike = 0.9;  // noise has nothing in common with the next frame's
    if (finest.unlike(seen) <= kMostUnlike)
      growth_->add(frames_, seen.turn.real(), finest.growth_sigma(seen));
    whole_ = {growth_->scale(frames_), {}};
  }

  /// Both frames' bands bring a motion, in cells of the finest ones, nearer to what they show.
  Motion refined(Motion motion, const std::vector<Band>& bands) const {
    for (std::size_t level = bands.size(); level-- > 0;) {
      const double cells = std::pow(depth::kCell, static_cast<double>(level));
      motion.shift /= cells;
      motion = BandMatch(before_[level], bands[level], unknowns()).improved(motion);
      motion.shift *= cells;
    }
    return motion;
  }

  int unknowns() const { return alignment_ == Alignment::scale ? 1 : 4; }

  /// From the frame before to this one, in cells of the finest band. It begins as the last pair
  /// ended, for a lens moves evenly, and stays so where the frames tell no better; standing still is
  /// what noise does.
  Motion match(const std::vector<Band>& bands) const {
    const Motion motion = refined(pair_, bands);
    const BandMatch finest(before_[0], bands[0], unknowns());
    if (is_of_a_lens(motion) && finest.is_beyond_chance(motion, {})) return motion;
    return finest.unlike(pair_) < finest.unlike({}) ? pair_ : Motion{};
  }

  /// Whether a picture may change so from one frame to the next. Noise that a grid was put on, as
  /// JPEG's blocks are, may seem to turn and to shrink by anything.
  bool is_of_a_lens(const Motion& motion) const {
    constexpr double kMostTurn = 0.1, kMostShift = 0.25;
    const double side = std::min(width_, height_) / static_cast<double>(factor_);
    return std::abs(motion.turn - 1.0) <= kMostTurn && std::abs(motion.shift) <= kMostShift * side;
  }

  Similarity similarity() const {
    constexpr double kStill_px = 0.25;
    // Cells begin at the picture's corner, so their middle is not quite the picture's.
    const Complex off = {0.5 * (width_ / factor_ * factor_ - width_),
                         0.5 * (height_ / factor_ * factor_ - height_)};
    const Complex shift = whole_.shift * static_cast<double>(factor_) + (1.0 - whole_.turn) * off;
    const double reach = 0.5 * std::hypot(width_, height_);
    if (std::abs(whole_.turn - 1.0) * reach + std::abs(shift) < kStill_px) return {};
    return {.scale = std::abs(whole_.turn),
            .angle_rad = std::arg(whole_.turn),
            .dx_px = shift.real(),
            .dy_px = shift.imag()};
  }

  Alignment alignment_;
  int width_ = 0, height_ = 0, factor_ = 1;
  std::size_t frames_ = 0;
  std::vector<Band> before_;
  Motion pair_, whole_;
  std::optional<depth::GrowthFit> growth_;
};

StackAligner::StackAligner(Alignment alignment, std::optional<GrowthLaw> law)
    : impl_(std::make_unique<Impl>(alignment, std::move(law))) {}
StackAligner::~StackAligner() = default;
StackAligner::StackAligner(StackAligner&&) noexcept = default;
StackAligner& StackAligner::operator=(StackAligner&&) noexcept = default;

Similarity StackAligner::add(const Frame& grey) { return impl_->add(grey); }
std::optional<double> StackAligner::growth_per_unit() const { return impl_->growth_per_unit(); }

}  // namespace fathom
