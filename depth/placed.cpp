// SPDX-License-Identifier: Apache-2.0
#include "depth/placed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// Weights of the four pixels around a point that lies t beyond the second of them.
std::array<float, 4> cubic(float t) {
  return {0.5F * t * (-1 + t * (2 - t)), 0.5F * (2 + t * t * (-5 + 3 * t)),
          0.5F * t * (1 + t * (4 - 3 * t)), 0.5F * t * t * (t - 1)};
}

/// A value that changes evenly from column to column and from row to row.
struct Slope {
  double at_origin, per_x, per_y;
  double at(double x, double y) const { return at_origin + per_x * x + per_y * y; }
};

/// The two passes of a similarity (Catmull and Smith 1980): columns first, then rows.
struct Passes {
  Slope column;  ///< Of the other picture, for a column of the result and a row of the other one.
  Slope row;     ///< Of the other picture, for a pixel of the result.
};

Passes passes_of(const Similarity& place, int width, int height) {
  const Point origin = place_of(place, 0, 0, width, height);
  const double cosine = place.scale * std::cos(place.angle_rad);
  const double sine = place.scale * std::sin(place.angle_rad);
  // row = origin.y + sine x + cosine y, solved for y, gives the column by x and row.
  const double turn = sine / cosine;
  return {.column = {origin.x + turn * origin.y, cosine + turn * sine, -turn},
          .row = {origin.y, sine, cosine}};
}

/// Some rows of the result: the other picture's rows that they need are resampled along their
/// columns into floats, then between each other.
template <class Sample, std::size_t kChannels>
class Band {
 public:
  Band(const Passes& passes, int width, int height)
      : passes_(passes), width_(width), height_(height) {}

  /// from, to: whole pictures, channels interleaved.
  void make(const Sample* from, int begin, int end, Sample* to) {
    const auto [low, high] = rows_needed(begin, end);
    first_ = low;
    lines_.resize(std::size_t{1} * (high - low + 1) * width_ * kChannels + kLanes);
    for (int row = low; row <= high; ++row)
      resample_columns(from + std::size_t{1} * row * width_ * kChannels, row);
    for (int y = begin; y < end; ++y)
      resample_rows(y, to + std::size_t{1} * y * width_ * kChannels);
  }

 private:
  int clamped_row(double row) const {
    // Before it becomes a whole number: a place may be anywhere.
    return static_cast<int>(std::clamp(row, 0.0, height_ - 1.0));
  }

  std::pair<int, int> rows_needed(int begin, int end) const {
    double low = passes_.row.at(0, begin), high = low;
    for (const int x : {0, width_ - 1}) {
      for (const int y : {begin, end - 1}) {
        low = std::min(low, passes_.row.at(x, y));
        high = std::max(high, passes_.row.at(x, y));
      }
    }
    return {clamped_row(std::floor(low) - 1), clamped_row(std::floor(high) + 2)};
  }

  float* line_of(int row) {
    return lines_.data() + std::size_t{1} * (row - first_) * width_ * kChannels;
  }

  /// Where a column of the result lies: pixels of the other picture's row, and their weights.
  struct Taps {
    std::array<std::size_t, 4> at;
    std::array<float, 4> weights;
  };

  /// Of every column, for rows near this one.
  void find_taps(int row) {
    taps_.resize(static_cast<std::size_t>(width_));
    taps_row_ = row;
    for (int x = 0; x < width_; ++x) {
      const double column = passes_.column.at(x, row), left = std::floor(column);
      Taps& taps = taps_[static_cast<std::size_t>(x)];
      taps.weights = cubic(static_cast<float>(column - left));
      for (int k = 0; k < 4; ++k) {
        const double tap = std::clamp(left + k - 1, 0.0, width_ - 1.0);
        taps.at[k] = static_cast<std::size_t>(tap) * kChannels;
      }
    }
  }

  void resample_columns(const Sample* from, int row) {
    const bool knows =
        !taps_.empty() && std::abs((row - taps_row_) * passes_.column.per_y) < kNothing;
    if (!knows) find_taps(row);
    row_.assign(from, from + kChannels * static_cast<std::size_t>(width_));
    row_.resize(row_.size() + kLanes);
    float* to = line_of(row);
    for (const Taps& taps : taps_) {
      // Four channels at once fill a register; what is too many the next pixel writes over.
      float sums[kLanes] = {};
      for (std::size_t k = 0; k < 4; ++k) {
        const float* const tap = row_.data() + taps.at[k];
        for (std::size_t c = 0; c < kLanes; ++c) sums[c] += taps.weights[k] * tap[c];
      }
      std::memcpy(to, sums, sizeof sums);
      to += kChannels;
    }
  }

  /// In runs of pixels that lie between the same rows, equally far: a turn is small, so they are
  /// long.
  void resample_rows(int y, Sample* to) {
    const double per_x = std::abs(passes_.row.per_x);
    const double longest = per_x * width_ > kNothing ? kNothing / per_x : width_;
    for (int x = 0; x < width_;) {
      const double row = passes_.row.at(x, y), top = std::floor(row);
      int end = std::min(width_, x + std::max(1, static_cast<int>(longest)));
      while (std::floor(passes_.row.at(end - 1, y)) != top) --end;
      const auto w = cubic(static_cast<float>(row - top));
      const float* taps[4];
      for (int k = 0; k < 4; ++k) taps[k] = line_of(clamped_row(top + k - 1));
      const float *const a = taps[0], *const b = taps[1], *const c = taps[2], *const d = taps[3];
      const std::size_t last = kChannels * static_cast<std::size_t>(end);
      for (std::size_t i = kChannels * static_cast<std::size_t>(x); i < last; ++i)
        to[i] = rounded(w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i]);
      x = end;
    }
  }

  static Sample rounded(float value) {
    constexpr auto kMost = static_cast<float>(std::numeric_limits<Sample>::max());
    const float above = value > 0 ? value : 0, within = above < kMost ? above : kMost;
    return static_cast<Sample>(static_cast<int>(within + 0.5F));
  }

  static constexpr std::size_t kLanes = kChannels == 1 ? 1 : 4;
  /// A part of a pixel that nobody sees.
  static constexpr double kNothing = 1.0 / 64;

  Passes passes_;
  int width_, height_;
  int first_ = 0;  // row of the other picture that lines_ begin with
  std::vector<float> lines_, row_;
  std::vector<Taps> taps_;
  int taps_row_ = 0;
};

template <std::size_t kChannels, class Sample>
std::vector<Sample> resampled(const std::vector<Sample>& from, const Passes& passes, int width,
                              int height) {
  constexpr std::size_t kRows = 32;
  constexpr int kThreads = 2;
  std::vector<Sample> to(from.size());
  share_out(static_cast<std::size_t>(height), kRows, kThreads,
            [&](std::size_t begin, std::size_t end) {
              Band<Sample, kChannels>(passes, width, height)
                  .make(from.data(), static_cast<int>(begin), static_cast<int>(end), to.data());
            });
  return to;
}

template <class Sample>
std::vector<Sample> samples_of(const Frame& frame) {
  const auto width = static_cast<std::size_t>(frame.width_px());
  std::vector<Sample> samples(width * frame.height_px());
  for (int y = 0; y < frame.height_px(); ++y)
    std::memcpy(samples.data() + y * width, frame.row(y), width * sizeof(Sample));
  return samples;
}

/// BT.601, as pictures/ has it.
template <class Sample>
std::vector<Sample> luma_of(const std::vector<Sample>& colours) {
  std::vector<Sample> luma(colours.size() / 3);
  for (std::size_t i = 0; i < luma.size(); ++i) {
    const Sample* const pixel = colours.data() + 3 * i;
    luma[i] =
        static_cast<Sample>((299u * pixel[0] + 587u * pixel[1] + 114u * pixel[2] + 500u) / 1000u);
  }
  return luma;
}

/// The grey of a picture with colours is their luma, which costs less than to bring it over too.
template <class Sample>
Placed placed_as(const Frame& grey, const Colours& colours, const Similarity& place) {
  const int width = grey.width_px(), height = grey.height_px();
  const Passes passes = passes_of(place, width, height);
  Placed result;
  if (colours.empty()) {
    result.grey =
        Frame(width, height, resampled<1>(samples_of<Sample>(grey), passes, width, height));
    return result;
  }
  result.colours.of<Sample>() = resampled<3>(colours.of<Sample>(), passes, width, height);
  result.grey = Frame(width, height, luma_of(result.colours.of<Sample>()));
  return result;
}

}  // namespace

Point place_of(const Similarity& place, double x, double y, int width_px, int height_px) {
  const double cx = 0.5 * (width_px - 1), cy = 0.5 * (height_px - 1);
  const double cosine = place.scale * std::cos(place.angle_rad);
  const double sine = place.scale * std::sin(place.angle_rad);
  return {cx + cosine * (x - cx) - sine * (y - cy) + place.dx_px,
          cy + sine * (x - cx) + cosine * (y - cy) + place.dy_px};
}

Placed placed(const Frame& grey, const Colours& colours, const Similarity& place) {
  return grey.depth() == Depth::bits8 ? placed_as<std::uint8_t>(grey, colours, place)
                                      : placed_as<std::uint16_t>(grey, colours, place);
}

}  // namespace fathom::depth
