// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/modes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "engine/error.hpp"

namespace fathom::v4l2 {
namespace {

/// No camera has more pixels in a row, and drivers multiply sides in 32 bits.
constexpr int kLargestSide = 32767;
/// No driver has more formats, sizes or rates; one that never ends its list is broken.
constexpr std::uint32_t kMostEntries = 256;
/// Rates are stored as fractions: 30 fps may be 10000000/333333.
constexpr double kRateTolerance = 1e-3;

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(fourcc >> shift & 0x7f);
  return text;
}

std::vector<std::uint32_t> offered_fourccs(const Device& device) {
  std::vector<std::uint32_t> fourccs;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (device.attempt(VIDIOC_ENUM_FMT, description) != 0) break;
    fourccs.push_back(description.pixelformat);
  }
  return fourccs;
}

v4l2_format format_of(const PixelFormat& format, int width_px, int height_px) {
  v4l2_format wanted{};
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.fmt.pix.width = static_cast<std::uint32_t>(std::clamp(width_px, 1, kLargestSide));
  wanted.fmt.pix.height = static_cast<std::uint32_t>(std::clamp(height_px, 1, kLargestSide));
  wanted.fmt.pix.pixelformat = format.fourcc;
  wanted.fmt.pix.field = V4L2_FIELD_NONE;
  return wanted;
}

/// What a driver made of a format; nothing if it is another one, or nonsense.
std::optional<Mode> mode_of(const v4l2_format& answer, const PixelFormat& format) {
  const v4l2_pix_format& pix = answer.fmt.pix;
  const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= kLargestSide; };
  if (pix.pixelformat != format.fourcc || !is_side(pix.width) || !is_side(pix.height)) {
    return std::nullopt;
  }
  const auto width_px = static_cast<int>(pix.width), height_px = static_cast<int>(pix.height);
  // Some drivers leave the stride at 0 where rows have no gaps.
  const std::size_t stride = std::max<std::size_t>(pix.bytesperline, row_bytes(format, width_px));
  return Mode{&format, {width_px, height_px, stride}};
}

long long distance(const Layout& layout, int width_px, int height_px) {
  return std::llabs(static_cast<long long>(layout.width_px) - width_px) +
         std::llabs(static_cast<long long>(layout.height_px) - height_px);
}

/// The nearest size of a driver that lists them; nothing where it does not.
std::optional<Mode> listed_mode(const Device& device, const PixelFormat& format, int width_px,
                                int height_px) {
  std::optional<Mode> best;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = format.fourcc;
    if (device.attempt(VIDIOC_ENUM_FRAMESIZES, size) != 0) break;
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) return std::nullopt;
    v4l2_format listed = format_of(format, width_px, height_px);
    listed.fmt.pix.width = size.discrete.width;
    listed.fmt.pix.height = size.discrete.height;
    const auto mode = mode_of(listed, format);
    if (!mode) continue;
    if (!best ||
        distance(mode->layout, width_px, height_px) < distance(best->layout, width_px, height_px)) {
      best = mode;
    }
  }
  return best;
}

/// The driver is only asked what it would do where it does not list its sizes: uvcvideo asks the
/// camera, and some cameras stumble over that while they stream.
std::optional<Mode> possible_mode(const Device& device, const PixelFormat& format, int width_px,
                                  int height_px) {
  if (auto listed = listed_mode(device, format, width_px, height_px)) return listed;
  v4l2_format wanted = format_of(format, width_px, height_px);
  const int error = device.attempt(VIDIOC_TRY_FMT, wanted);
  if (error == EINVAL) return std::nullopt;
  if (error != 0) device.fail(error, "cannot ask for its picture sizes");
  return mode_of(wanted, format);
}

/// Whether a mode can be as fast as asked for; true where the driver does not tell.
bool can_be_fast(const Device& device, const Mode& mode, double fps) {
  if (fps <= 0) return true;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = i;
    interval.pixel_format = mode.format->fourcc;
    interval.width = static_cast<std::uint32_t>(mode.layout.width_px);
    interval.height = static_cast<std::uint32_t>(mode.layout.height_px);
    if (device.attempt(VIDIOC_ENUM_FRAMEINTERVALS, interval) != 0) return i == 0;
    const bool is_discrete = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const v4l2_fract least = is_discrete ? interval.discrete : interval.stepwise.min;
    if (least.denominator >= fps * (1 - kRateTolerance) * least.numerator) return true;
    if (!is_discrete) return false;
  }
  return false;
}

/// Smaller is nearer to a wish.
auto badness(const Device& device, const Mode& mode, const ModeWish& wish) {
  const bool is_other_depth = wish.depth && *wish.depth != mode.format->depth;
  return std::make_tuple(is_other_depth, distance(mode.layout, wish.width_px, wish.height_px),
                         !can_be_fast(device, mode, wish.fps));
}

[[noreturn]] void fail_without_format(const Device& device, const ModeWish& wish) {
  std::vector<std::string> there, read;
  for (const std::uint32_t fourcc : offered_fourccs(device)) there.push_back(fourcc_text(fourcc));
  for (const PixelFormat& format : pixel_formats()) read.emplace_back(format.name);
  throw Error(ErrorCode::unsupported,
              fmt::format("{} does not give {}; it gives {}", device.path(),
                          wish.format != nullptr
                              ? std::string(wish.format->name)
                              : fmt::format("any format that is read ({})", fmt::join(read, ", ")),
                          there.empty() ? "none" : fmt::format("{}", fmt::join(there, ", "))));
}

}  // namespace

std::vector<const PixelFormat*> offered_formats(const Device& device) {
  const std::vector<std::uint32_t> there = offered_fourccs(device);
  std::vector<const PixelFormat*> formats;
  for (const PixelFormat& format : pixel_formats()) {
    if (std::find(there.begin(), there.end(), format.fourcc) != there.end()) {
      formats.push_back(&format);
    }
  }
  return formats;
}

Mode nearest_mode(const Device& device, const ModeWish& wish) {
  std::optional<Mode> best;
  for (const PixelFormat* format : offered_formats(device)) {
    if (wish.format != nullptr && wish.format != format) continue;
    const auto mode = possible_mode(device, *format, wish.width_px, wish.height_px);
    if (!mode) continue;
    // Not nearer is not better: formats come best first.
    if (!best || badness(device, *mode, wish) < badness(device, *best, wish)) best = mode;
  }
  if (!best) fail_without_format(device, wish);
  return *best;
}

std::string sizes_text(const Device& device, const PixelFormat& format) {
  std::vector<std::string> sizes;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = format.fourcc;
    if (device.attempt(VIDIOC_ENUM_FRAMESIZES, size) != 0) break;
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      const v4l2_frmsize_stepwise& range = size.stepwise;
      return fmt::format("{} x {} to {} x {}", range.min_width, range.min_height, range.max_width,
                         range.max_height);
    }
    sizes.push_back(fmt::format("{} x {}", size.discrete.width, size.discrete.height));
  }
  constexpr std::size_t kEnough = 6;
  if (sizes.size() <= kEnough) return fmt::format("{}", fmt::join(sizes, ", "));
  return fmt::format("{}, and {} more", fmt::join(sizes.begin(), sizes.begin() + kEnough, ", "),
                     sizes.size() - kEnough);
}

Mode set_mode(const Device& device, const Mode& mode) {
  const Layout& layout = mode.layout;
  v4l2_format wanted = format_of(*mode.format, layout.width_px, layout.height_px);
  const auto what = fmt::format("cannot set {} of {} x {} px", mode.format->name, layout.width_px,
                                layout.height_px);
  device.call(VIDIOC_S_FMT, wanted, what);
  const auto got = mode_of(wanted, *mode.format);
  if (got && got->layout.width_px == layout.width_px && got->layout.height_px == layout.height_px) {
    return *got;
  }
  throw Error(ErrorCode::unsupported,
              fmt::format("{}: {}: the driver makes {} x {} px of {} of it", device.path(), what,
                          wanted.fmt.pix.width, wanted.fmt.pix.height,
                          fourcc_text(wanted.fmt.pix.pixelformat)));
}

std::int64_t frame_interval_ns(const Device& device) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device.attempt(VIDIOC_G_PARM, parameters) != 0) return 0;
  const v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (interval.numerator == 0 || interval.denominator == 0) return 0;
  return std::llround(1e9 * interval.numerator / interval.denominator);
}

void set_frame_rate(const Device& device, double fps) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  interval.numerator = 1'000'000;
  interval.denominator = static_cast<std::uint32_t>(std::lround(fps * 1e6));
  const int error = device.attempt(VIDIOC_S_PARM, parameters);
  if (error != 0 && error != ENOTTY && error != EINVAL) device.fail(error, "cannot set its fps");
  const std::int64_t got_ns = error == 0 ? frame_interval_ns(device) : 0;
  if (got_ns > 0 && std::abs(1e9 / static_cast<double>(got_ns) - fps) <= kRateTolerance * fps) {
    return;
  }
  throw Error(ErrorCode::unsupported,
              got_ns == 0
                  ? fmt::format("{} has no frame rate to set; leave fps out", device.path())
                  : fmt::format("{} cannot give {} fps in this size and format; the nearest "
                                "is {:.3f}",
                                device.path(), fps, 1e9 / static_cast<double>(got_ns)));
}

}  // namespace fathom::v4l2
