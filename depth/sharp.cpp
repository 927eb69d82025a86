// SPDX-License-Identifier: Apache-2.0
#include "depth/sharp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "depth/blending.hpp"
#include "depth/placed.hpp"
#include "depth/plane.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

using depth::blend_row;
using depth::Plane;
using depth::shares_of;
using depth::with_surroundings;

/// What a detail is stored as: 8 bits as 64ths of a grey level, 16 bits as floats.
template <class Sample>
struct Stored;
template <>
struct Stored<std::uint8_t> {
  using Type = std::int16_t;
  static constexpr float kUnits = 64;
};
template <>
struct Stored<std::uint16_t> {
  using Type = float;
  static constexpr float kUnits = 1;
};

/// One part of the picture's spectrum: whose weight it has so far, and the details of each channel.
struct Band {
  Plane weights;
  std::vector<Plane> details;
};

/// BT.601, as pictures/ has it.
template <class Sample>
Sample luma_of(const Sample* pixel) {
  return static_cast<Sample>((299u * pixel[0] + 587u * pixel[1] + 114u * pixel[2] + 500u) / 1000u);
}

}  // namespace

class SharpPicture::Impl {
 public:
  virtual ~Impl() = default;
  virtual void add(std::size_t frame, const Frame& grey, const Colours& colours,
                   const Similarity& place, double gain) = 0;
  virtual std::vector<float> energies(int columns, int rows) const = 0;
  virtual Sharp finish() = 0;

  int width = 0, height = 0, channels = 1;
  Depth depth = Depth::bits8;
};

namespace {

template <class Sample>
class Blend final : public SharpPicture::Impl {
 public:
  using Store = typename Stored<Sample>::Type;
  static constexpr float kUnits = Stored<Sample>::kUnits;

  Blend(int picture_width, int picture_height, int picture_channels) {
    width = picture_width;
    height = picture_height;
    channels = picture_channels;
    depth = sizeof(Sample) == 1 ? Depth::bits8 : Depth::bits16;
    const std::size_t pixels = std::size_t{1} * width * height;
    details_.assign(pixels * channels, Store{});
    int w = depth::cells(width), h = depth::cells(height);
    weights_ = strongest_ = Plane(w, h);
    frames_.assign(weights_.values.size(), 0);
    constexpr int kSmallest = 16;
    for (; bands_.size() < 2 && std::min(w, h) >= kSmallest;) {
      const Plane empty(w, h);
      w = depth::cells(w), h = depth::cells(h);
      bands_.push_back({Plane(w, h), std::vector<Plane>(channels, empty)});
    }
    rest_ = {Plane(w, h), std::vector<Plane>(channels, Plane(w, h))};
    for (auto* const row : {&share_, &value_, &base_}) row->resize(width);
    scratch_.resize(weights_.width);
  }

  void add(std::size_t frame, const Frame& grey, const Colours& colours, const Similarity& place,
           double gain) override {
    gain_ = static_cast<float>(gain);
    const Sample* const samples = channels == 3 ? colours.of<Sample>().data() : nullptr;
    std::vector<Plane> base = bases_of(grey, samples);
    Plane grey_base = channels == 3 ? grey_base_of(grey) : base[0];
    energy_ = energy_of(grey, grey_base);
    shown_ = place == Similarity{} ? Plane() : depth::shown_by(place, width, height);
    hide_unshown(energy_, shown_);
    Plane energy = with_surroundings(energy_);
    hide_unshown(energy, shown_);
    note_strongest(frame, energy);
    blend_details(grey, samples, base, shares_of(energy, weights_));
    blend_coarse(std::move(base), std::move(grey_base));
    ++added_;
  }

  std::vector<float> energies(int columns, int rows) const override {
    return depth::means_of_parts(energy_, columns, rows);
  }

  Sharp finish() override {
    if (added_ == 0)
      throw Error(ErrorCode::bad_argument, "no frame was added to the all-in-focus picture");
    Sharp result;
    const std::vector<Plane> base = collapsed();
    std::vector<Sample> grey(std::size_t{1} * width * height);
    std::vector<Sample>& colours = result.colours.of<Sample>();
    if (channels == 3) colours.resize(3 * grey.size());
    for (int y = 0; y < height; ++y) {
      Sample* const line = grey.data() + std::size_t{1} * y * width;
      Sample* const colour = channels == 3 ? colours.data() + std::size_t{3} * y * width : line;
      for (int c = 0; c < channels; ++c) finish_row(base[c], y, c, colour);
      for (int x = 0; channels == 3 && x < width; ++x) line[x] = luma_of(colour + 3 * x);
    }
    result.frame = frames_of_pixels();
    details_ = {};
    result.grey = Frame(width, height, std::move(grey));
    return result;
  }

 private:
  const Sample* grey_row(const Frame& grey, int y) {
    if constexpr (sizeof(Sample) == 1) {
      return reinterpret_cast<const Sample*>(grey.row(y));
    } else {  // rows of 16 bits need not be aligned
      aligned_.resize(static_cast<std::size_t>(width));
      std::memcpy(aligned_.data(), grey.row(y), aligned_.size() * sizeof(Sample));
      return aligned_.data();
    }
  }

  /// The samples of a channel, as they lie `step` apart, added to their cells.
  void pool_row(const Sample* samples, int step, float* cells_row) const {
    const int whole = width / depth::kCell;
    for (int i = 0; i < whole; ++i) {
      const Sample* const at = samples + i * depth::kCell * step;
      cells_row[i] += static_cast<float>(at[0] + at[step] + at[2 * step] + at[3 * step]);
    }
    for (int x = whole * depth::kCell; x < width; ++x)
      cells_row[whole] += static_cast<float>(samples[x * step]);
  }

  void divide_by_counts(Plane& plane) const {
    for (int y = 0; y < plane.height; ++y) {
      const int rows = std::min(depth::kCell, height - y * depth::kCell);
      for (int x = 0; x < plane.width; ++x)
        plane.row(y)[x] /=
            static_cast<float>(rows * std::min(depth::kCell, width - x * depth::kCell));
    }
  }

  /// The means of cells whose samples were added up, levelled.
  void make_base(Plane& sums) const {
    divide_by_counts(sums);
    for (float& value : sums.values) value *= gain_;
  }

  Plane grey_base_of(const Frame& grey) {
    Plane base(weights_.width, weights_.height);
    for (int y = 0; y < height; ++y) pool_row(grey_row(grey, y), 1, base.row(y / depth::kCell));
    make_base(base);
    return base;
  }

  std::vector<Plane> bases_of(const Frame& grey, const Sample* samples) {
    if (channels == 1) return {grey_base_of(grey)};
    std::vector<Plane> base(3, Plane(weights_.width, weights_.height));
    for (int y = 0; y < height; ++y) {
      for (int c = 0; c < 3; ++c)
        pool_row(samples + std::size_t{3} * y * width + c, 3, base[c].row(y / depth::kCell));
    }
    for (Plane& plane : base) make_base(plane);
    return base;
  }

  /// Mean square of the grey details of each cell, in levels of 8 bits.
  Plane energy_of(const Frame& grey, const Plane& base) {
    Plane energy(base.width, base.height);
    for (int y = 0; y < height; ++y) {
      depth::expand_row(base, y, width, scratch_.data(), base_.data());
      const Sample* const line = grey_row(grey, y);
      for (int x = 0; x < width; ++x) {
        const float detail = gain_ * static_cast<float>(line[x]) - base_[x];
        value_[x] = detail * detail;
      }
      float* const to = energy.row(y / depth::kCell);
      const int whole = width / depth::kCell;
      for (int i = 0; i < whole; ++i) {
        const float* const at = value_.data() + i * depth::kCell;
        to[i] += (at[0] + at[1]) + (at[2] + at[3]);
      }
      for (int x = whole * depth::kCell; x < width; ++x) to[whole] += value_[x];
    }
    divide_by_counts(energy);
    constexpr float kLevel = 255.0F / static_cast<float>(std::numeric_limits<Sample>::max());
    for (float& value : energy.values) value *= kLevel * kLevel;
    if (gain_ < 1) depth::doubt_clipped(grey, energy);
    return energy;
  }

  /// A frame has no say where it shows nothing. shown: empty where it shows all.
  static void hide_unshown(Plane& energy, const Plane& shown) {
    for (std::size_t i = 0; i < shown.values.size(); ++i) {
      if (shown.values[i] < 1) energy.values[i] = 0;
    }
  }

  void note_strongest(std::size_t frame, const Plane& energy) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (added_ > 0 && energy.values[i] <= strongest_.values[i]) continue;
      strongest_.values[i] = energy.values[i];
      frames_[i] = static_cast<std::uint16_t>(frame);
    }
  }

  void blend_details(const Frame& grey, const Sample* samples, const std::vector<Plane>& base,
                     const Plane& shares) {
    for (int y = 0; y < height; ++y) {
      depth::expand_row(shares, y, width, scratch_.data(), share_.data());
      for (int c = 0; c < channels; ++c) {
        depth::expand_row(base[c], y, width, scratch_.data(), base_.data());
        if (channels == 1) {
          take_details(grey_row(grey, y), 1);
        } else {
          take_details(samples + std::size_t{3} * y * width + c, 3);
        }
        blend_row(share_.data(), value_.data(), detail_row(c, y), width);
      }
    }
  }

  void take_details(const Sample* samples, int step) {
    for (int x = 0; x < width; ++x)
      value_[x] = kUnits * (gain_ * static_cast<float>(samples[x * step]) - base_[x]);
  }

  Store* detail_row(int channel, int y) {
    return details_.data() + (std::size_t{1} * channel * height + y) * width;
  }

  /// The parts of longer periods: their energy decides with that of the finer ones, which change
  /// more with the focus.
  void blend_coarse(std::vector<Plane> base, Plane grey_base) {
    constexpr float kFinerCounts = 4;
    Plane energy = energy_, shown = shown_;
    for (Band& band : bands_) {
      const Plane grey_next = depth::pooled(grey_base);
      Plane squares = depth::difference(grey_base, grey_next);
      for (float& value : squares.values) value *= value * level_squared();
      energy = depth::pooled(energy);
      const Plane coarse = depth::pooled(squares);
      for (std::size_t i = 0; i < energy.values.size(); ++i)
        energy.values[i] = kFinerCounts * energy.values[i] + coarse.values[i];
      Plane smooth = depth::smoothed(energy);
      if (!shown_.values.empty()) hide_unshown(smooth, shown = depth::pooled(shown));
      const Plane shares = shares_of(smooth, band.weights);
      for (int c = 0; c < channels; ++c) {
        Plane next = depth::pooled(base[c]);
        blend_plane(shares, depth::difference(base[c], next), band.details[c]);
        base[c] = std::move(next);
      }
      grey_base = grey_next;
    }
    Plane smooth = depth::smoothed(depth::smoothed(energy));
    if (!shown.values.empty() && shown.width == smooth.width) hide_unshown(smooth, shown);
    const Plane shares = shares_of(smooth, rest_.weights);
    for (int c = 0; c < channels; ++c) {
      for (std::size_t i = 0; i < shares.values.size(); ++i) {
        float& stored = rest_.details[c].values[i];
        stored += shares.values[i] * (base[c].values[i] - stored);
      }
    }
  }

  static constexpr float level_squared() {
    constexpr float kLevel = 255.0F / static_cast<float>(std::numeric_limits<Sample>::max());
    return kLevel * kLevel;
  }

  void blend_plane(const Plane& shares, const Plane& values, Plane& stored) {
    for (int y = 0; y < values.height; ++y) {
      depth::expand_row(shares, y, values.width, scratch_.data(), share_.data());
      blend_row(share_.data(), values.row(y), stored.row(y), values.width);
    }
  }

  /// The blended picture without its finest details, one plane a channel.
  std::vector<Plane> collapsed() {
    std::vector<Plane> base = std::move(rest_.details);
    for (auto band = bands_.rbegin(); band != bands_.rend(); ++band) {
      for (int c = 0; c < channels; ++c) {
        Plane& details = band->details[c];
        for (int y = 0; y < details.height; ++y) {
          depth::expand_row(base[c], y, details.width, scratch_.data(), base_.data());
          float* const row = details.row(y);
          for (int x = 0; x < details.width; ++x) row[x] += base_[x];
        }
        base[c] = std::move(details);
      }
    }
    return base;
  }

  void finish_row(const Plane& base, int y, int channel, Sample* line) {
    constexpr auto kMost = static_cast<float>(std::numeric_limits<Sample>::max());
    depth::expand_row(base, y, width, scratch_.data(), base_.data());
    const Store* const details = detail_row(channel, y);
    for (int x = 0; x < width; ++x) {
      const float value = base_[x] + static_cast<float>(details[x]) / kUnits;
      line[x * channels + channel] = static_cast<Sample>(std::clamp(value, 0.0F, kMost) + 0.5F);
    }
  }

  std::vector<std::uint16_t> frames_of_pixels() const {
    std::vector<std::uint16_t> result(std::size_t{1} * width * height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        result[std::size_t{1} * y * width + x] =
            frames_[std::size_t{1} * (y / depth::kCell) * weights_.width + x / depth::kCell];
      }
    }
    return result;
  }

  std::vector<Store> details_;  // channel by channel
  Plane weights_, strongest_, energy_;
  Plane shown_;  // of the frame at hand
  std::vector<std::uint16_t> frames_;
  std::vector<Band> bands_;
  Band rest_;
  std::size_t added_ = 0;
  float gain_ = 1;                                     // of the frame at hand
  std::vector<float> share_, value_, base_, scratch_;  // rows
  std::vector<Sample> aligned_;
};

void require_alike(const SharpPicture::Impl& impl, const Frame& grey, const Colours& colours) {
  const std::size_t samples =
      impl.depth == Depth::bits8 ? colours.bits8.size() : colours.bits16.size();
  const std::size_t expected =
      impl.channels == 3 ? std::size_t{3} * impl.width * impl.height : std::size_t{0};
  const bool is_alike = grey.width_px() == impl.width && grey.height_px() == impl.height &&
                        grey.depth() == impl.depth;
  if (is_alike && (expected == 0 || samples == expected)) return;
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("a frame of {} x {} px, {} bit and {} samples of colour does not go with "
                  "an all-in-focus picture of {} x {} px, {} bit and {}",
                  grey.width_px(), grey.height_px(), static_cast<int>(grey.depth()), samples,
                  impl.width, impl.height, static_cast<int>(impl.depth), expected));
}

}  // namespace

SharpPicture::SharpPicture(int width_px, int height_px, Depth depth, bool has_colours) {
  if (width_px < 1 || height_px < 1)
    throw Error(ErrorCode::bad_argument, "an all-in-focus picture has at least one pixel");
  const int channels = has_colours ? 3 : 1;
  if (depth == Depth::bits8) {
    impl_ = std::make_unique<Blend<std::uint8_t>>(width_px, height_px, channels);
  } else {
    impl_ = std::make_unique<Blend<std::uint16_t>>(width_px, height_px, channels);
  }
}

SharpPicture::~SharpPicture() = default;
SharpPicture::SharpPicture(SharpPicture&&) noexcept = default;
SharpPicture& SharpPicture::operator=(SharpPicture&&) noexcept = default;

void SharpPicture::add(std::size_t frame, const Frame& grey, const Colours& colours,
                       const Similarity& place, double gain) {
  require_alike(*impl_, grey, colours);
  if (place == Similarity{}) return impl_->add(frame, grey, colours, place, gain);
  const depth::Placed moved = depth::placed(grey, colours, place);
  impl_->add(frame, moved.grey, moved.colours, place, gain);
}

std::vector<float> SharpPicture::energies(int columns, int rows) const {
  return impl_->energies(columns, rows);
}

Sharp SharpPicture::finish() { return impl_->finish(); }

}  // namespace fathom
