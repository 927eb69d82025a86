// SPDX-License-Identifier: Apache-2.0
// fathom snap: one picture of a rig, with the window drawn, its score and its light.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.hpp"
#include "pictures/picture.hpp"
#include "session/grey_levels.hpp"
#include "session/light_meter.hpp"
#include "session/rig.hpp"
#include "session/saturation.hpp"
#include "tools/fathom/aiming.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  std::optional<double> at;
};

constexpr std::size_t kBins = 32;

/// What the grey values of a picture are.
struct Light {
  std::uint32_t lowest = 0, highest = 0;
  std::uint32_t full_scale = 255;
  GreyLevels greys = {};
};

template <typename Visit>
void for_each_pixel(const Frame& frame, Visit visit) {
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) visit(frame.at(x, y));
  }
}

Light light_of(const Frame& frame) {
  Light light{.lowest = frame.at(0, 0)};
  for_each_pixel(frame, [&](std::uint32_t grey) {
    light.lowest = std::min(light.lowest, grey);
    light.highest = std::max(light.highest, grey);
  });
  light.full_scale = full_scale(frame.depth(), light.highest);
  light.greys = grey_levels_of(frame, light.full_scale, kBins);
  return light;
}

/// One character a bin. The square root keeps few pixels visible beside many.
std::string bars_of(const Light& light) {
  static constexpr const char* kBars[] = {" ",      "\u2581", "\u2582", "\u2583", "\u2584",
                                          "\u2585", "\u2586", "\u2587", "\u2588"};
  const auto most = static_cast<double>(*std::ranges::max_element(light.greys.histogram));
  std::string bars;
  for (const std::size_t count : light.greys.histogram)
    bars += kBars[std::lround(std::ceil(8 * std::sqrt(static_cast<double>(count) / most)))];
  return bars;
}

/// What to do about the exposure, or that there is nothing to do.
std::string advice_of(const Frame& frame, const Window& window, const Light& light,
                      double exposure_ms) {
  constexpr double kMuchRoom = 0.5;
  const std::string now = exposure_ms > 0 ? fmt::format(" (now {:g} ms)", exposure_ms) : "";
  LightMeter meter(window);
  meter.see(frame);
  if (const auto poor = meter.judge(exposure_ms)) {
    return poor->kind == PoorLight::Kind::dark
               ? fmt::format(
                     "too dark: the window's mean is {:.1f} % of full scale; expose longer{}, "
                     "raise the gain or give more light",
                     100 * poor->part, now)
               : fmt::format(
                     "too bright: {:.0f} % of the window is at the maximum; expose "
                     "shorter{} or lower the gain",
                     100 * poor->part, now);
  }
  const double reached = static_cast<double>(light.highest) / light.full_scale;
  if (reached < kMuchRoom) {
    return fmt::format(
        "good, with room: no pixel is above {:.0f} % of full scale; an exposure up "
        "to {:.1f} times as long{} has less noise",
        100 * reached, 0.9 / std::max(reached, 0.01), now);
  }
  return "good" + now;
}

/// The picture in 8 bits with a frame round the window, which itself stays as it is.
class MarkedPicture {
 public:
  MarkedPicture(const Frame& frame, const Light& light)
      : width_(frame.width_px()), height_(frame.height_px()) {
    for_each_pixel(frame, [&](std::uint32_t grey) {
      const auto level = static_cast<std::uint8_t>(
          255 * std::uint64_t{std::min(grey, light.full_scale)} / light.full_scale);
      greys_.push_back(level);
      colours_.bits8.insert(colours_.bits8.end(), 3, level);
    });
  }

  /// Two lines, orange on black: seen on bright and on dark pictures, whichever colours one sees.
  void mark(const Window& window) {
    const int width = std::max(1, std::max(width_, height_) / 512);
    for (int i = 1; i <= 2 * width; ++i) {
      if (i <= width) {
        outline(window, i, {255, 176, 0});
      } else {
        outline(window, i, {0, 0, 0});
      }
    }
  }

  void write(const std::string& path) && {
    write_picture(path, Frame(width_, height_, std::move(greys_)), colours_);
  }

 private:
  using Colour = std::array<std::uint8_t, 3>;

  void outline(const Window& window, int distance, const Colour& colour) {
    const int left = window.x - distance, right = window.x + window.n - 1 + distance;
    const int top = window.y - distance, bottom = window.y + window.n - 1 + distance;
    for (int x = left; x <= right; ++x) {
      dot(x, top, colour);
      dot(x, bottom, colour);
    }
    for (int y = top; y <= bottom; ++y) {
      dot(left, y, colour);
      dot(right, y, colour);
    }
  }

  void dot(int x, int y, const Colour& colour) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const std::size_t at = 3 * (static_cast<std::size_t>(y) * width_ + x);
    std::copy(colour.begin(), colour.end(),
              colours_.bits8.begin() + static_cast<std::ptrdiff_t>(at));
  }

  int width_, height_;
  std::vector<std::uint8_t> greys_;
  Colours colours_;
};

std::string json_of(const Frame& frame, const Rig& rig, const Measurement& taken,
                    const Light& light, const std::string& advice) {
  const Window window = rig.window();
  std::string bins;
  for (const std::size_t count : light.greys.histogram)
    bins += fmt::format("{}{}", bins.empty() ? "" : ",", count);
  JsonLine line;
  line.add("width_px", frame.width_px())
      .add("height_px", frame.height_px())
      .add("position", taken.position)
      .add("x", window.x)
      .add("y", window.y)
      .add("n", window.n)
      .add("metric", rig.spec().text())
      .add("score", taken.score)
      .add("lowest", static_cast<double>(light.lowest))
      .add("highest", static_cast<double>(light.highest))
      .add("mean", light.greys.mean)
      .add("full_scale", static_cast<double>(light.full_scale))
      .add("saturated", light.greys.part(light.greys.white))
      .add_json("histogram", "[" + bins + "]")
      .add("exposure", advice);
  return line.text();
}

std::string text_of(const Frame& frame, Rig& rig, const Measurement& taken, const Light& light,
                    const std::string& advice) {
  return fmt::format(
      "{} x {} px, {} bit, lens at {:g} {}\n"
      "window {}: {} score {:.6g}\n"
      "grey values {} to {}, mean {:.1f}, {:.0f} % of full scale {}; {:.1f} % saturated\n"
      "histogram 0 |{}| {}\n"
      "exposure: {}\n",
      frame.width_px(), frame.height_px(), frame.depth() == Depth::bits8 ? 8 : 16, taken.position,
      rig.lens().info().unit, to_string(rig.window()), rig.spec().text(), taken.score, light.lowest,
      light.highest, light.greys.mean, 100 * light.greys.mean / light.full_scale, light.full_scale,
      100 * light.greys.part(light.greys.white), bars_of(light), light.full_scale, advice);
}

int run(const Arguments& arguments) {
  const std::string& output = arguments.rig.output;
  require_separate({arguments.rig.rig}, {output});
  RigArguments without_output = arguments.rig;
  without_output.output.clear();  // a look round keeps its run by itself
  std::optional<Rig> aimed =
      aimed_rig({.verb = "snap", .rig = without_output, .unmeasured = {"position", "score"}});
  if (!aimed) return kNoFocus;
  Rig& rig = *aimed;
  Frame frame;
  const double position = arguments.at.value_or(rig.lens().position());
  const Measurement taken = rig.measure(
      position, [&](const Frame& seen, const Arrival&, double) { frame = seen.clone(); });
  const Light light = light_of(frame);
  const std::string advice =
      advice_of(frame, rig.window(), light, rig.camera().settings().exposure_ms);
  if (!output.empty()) {
    MarkedPicture picture(frame, light);
    picture.mark(rig.window());
    std::move(picture).write(output);
  }
  if (arguments.rig.json) {
    print_line(json_of(frame, rig, taken, light, advice));
    return kDone;
  }
  print_lines(text_of(frame, rig, taken, light, advice));
  if (!output.empty()) print_line("picture written to " + output + ", the window marked");
  return kDone;
}

}  // namespace

void add_snap(Verb& program) {
  Verb verb = program.add_verb("snap", "Take one picture: the window drawn, its score, its light");
  verb.set_footer(
      "Examples:\n  fathom snap --rig sim:target=seedling -o picture.png\n"
      "  fathom snap --rig v4l2:/dev/video0 --at 120 -o picture.png\n"
      "  fathom snap --rig sim:target=stair --window nearest -o picture.png\n\n"
      "The picture is for the eye: 8 bit, with a frame round the window. fathom capture keeps "
      "pictures as they are.");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "Picture to write: .png or .tif", true, kAimHelp);
  verb.add_option("--at", arguments->at, "Lens position (default: where the lens stands)");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
