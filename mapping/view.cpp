// SPDX-License-Identifier: Apache-2.0
#include "mapping/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>

#include "mapping/colour_map.hpp"
#include "pictures/raster.hpp"
#include "session/json_line.hpp"

namespace fathom::mapping {
namespace {

constexpr char kPage[] = {
#include "view.html.text"
};
constexpr double kMostPlaces = 300'000;
constexpr int kWidestPicture = 1600;
constexpr int kJpegQuality = 88;

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string base64(const std::string& bytes) {
  return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// Every step-th pixel of a map, from the middle of what it stands for.
struct Thinning {
  int step, columns, rows;

  Thinning(const DepthMaps& maps)
      : step(std::max(1, static_cast<int>(std::ceil(
                             std::sqrt(static_cast<double>(maps.classes.size()) / kMostPlaces))))),
        columns(std::max(1, maps.width_px / step)),
        rows(std::max(1, maps.height_px / step)) {}

  template <class Visit>
  void each(const DepthMaps& maps, Visit visit) const {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const int x = std::min(column * step + step / 2, maps.width_px - 1);
        const int y = std::min(row * step + step / 2, maps.height_px - 1);
        visit(std::size_t{1} * y * maps.width_px + x);
      }
    }
  }
};

/// 16 bits each, 1 to 65535 between the least and the most; 0 for what is no number.
std::string packed(const Thinning& thinning, const DepthMaps& maps,
                   const std::vector<float>& values) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float low = kInfinity, high = -kInfinity;
  thinning.each(maps, [&](std::size_t i) {
    if (!std::isfinite(values[i])) return;
    low = std::min(low, values[i]);
    high = std::max(high, values[i]);
  });
  if (!(low <= high)) low = high = 0;
  const float scale = high > low ? 65534 / (high - low) : 0;
  std::vector<std::uint8_t> bytes;
  thinning.each(maps, [&](std::size_t i) {
    const auto word = std::isfinite(values[i])
                          ? static_cast<std::uint32_t>(1.5F + (values[i] - low) * scale)
                          : 0u;
    bytes.push_back(static_cast<std::uint8_t>(word & 0xff));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  });
  return JsonLine().add("low", low).add("high", high).add("values", base64(bytes)).text();
}

std::string class_bytes(const Thinning& thinning, const DepthMaps& maps) {
  std::vector<std::uint8_t> bytes;
  thinning.each(
      maps, [&](std::size_t i) { bytes.push_back(static_cast<std::uint8_t>(maps.classes[i])); });
  return base64(bytes);
}

std::uint8_t byte_of(const Sharp& sharp, int x, int y, std::size_t channel) {
  const bool is_wide = sharp.grey.depth() == Depth::bits16;
  const std::size_t at = 3 * (std::size_t{1} * y * sharp.grey.width_px() + x) + channel;
  const std::uint32_t value = sharp.colours.empty() ? sharp.grey.at(x, y)
                              : is_wide             ? sharp.colours.bits16[at]
                                                    : sharp.colours.bits8[at];
  return static_cast<std::uint8_t>(is_wide ? value >> 8 : value);
}

/// The sharp picture, each pixel the mean of a square of it, as a JPEG.
std::string small_picture(const Sharp& sharp) {
  const int width = sharp.grey.width_px(), height = sharp.grey.height_px();
  const int step = std::max(1, (std::max(width, height) + kWidestPicture - 1) / kWidestPicture);
  const int columns = std::max(1, width / step), rows = std::max(1, height / step);
  std::vector<std::uint8_t> samples;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        std::uint32_t sum = 0, count = 0;
        for (int y = row * step; y < std::min((row + 1) * step, height); ++y) {
          for (int x = column * step; x < std::min((column + 1) * step, width); ++x, ++count)
            sum += byte_of(sharp, x, y, channel);
        }
        samples.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
    }
  }
  Raster raster = raster_of(samples.data(), columns, rows);
  raster.channels = 3;
  return encode_jpeg(raster, kJpegQuality);
}

/// Each place's curve from its least to its most, 0 to 255.
std::string curves_json(const CurveGrid& grid) {
  const std::size_t cells = std::size_t{1} * grid.columns * grid.rows;
  std::vector<std::uint8_t> bytes;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    float low = std::numeric_limits<float>::infinity(), high = 0;
    for (const std::vector<float>& frame : grid.frames) {
      low = std::min(low, frame[cell]);
      high = std::max(high, frame[cell]);
    }
    for (const std::vector<float>& frame : grid.frames) {
      const float part = high > low ? (frame[cell] - low) / (high - low) : 0;
      bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * part)));
    }
  }
  return JsonLine()
      .add("columns", grid.columns)
      .add("rows", grid.rows)
      .add("values", base64(bytes))
      .text();
}

std::string rgb_list(std::span<const Rgb> colours) {
  std::string list;
  for (const Rgb& colour : colours)
    list += fmt::format("{}[{},{},{}]", list.empty() ? "" : ",", colour[0], colour[1], colour[2]);
  return "[" + list + "]";
}

std::string palette_json() {
  constexpr int kColours = 33;
  std::vector<Rgb> colours;
  for (int i = 0; i < kColours; ++i) colours.push_back(viridis(i / (kColours - 1.0)));
  return rgb_list(colours);
}

void add_classes(JsonLine& line, const DepthSummary& summary, std::size_t pixels) {
  std::vector<Rgb> colours;
  std::vector<double> parts;
  std::string names;
  for (const DepthClass value : kAllDepthClasses) {
    colours.push_back(colour_of(value));
    parts.push_back(summary.part(value, pixels));
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ",", to_string(value));
  }
  line.add_json("classNames", "[" + names + "]").add_json("classColours", rgb_list(colours));
  line.add("classParts", parts);
}

std::string summary_words(const DepthResult& result, const DepthSummary& summary) {
  return fmt::format(
      "{} x {} px from {} frames; {:.1f} % has a depth, sigma {:.2g} {} in the middle",
      result.maps.width_px, result.maps.height_px, result.positions.size(),
      100 * static_cast<double>(summary.numbers) / static_cast<double>(result.pixels()),
      summary.median_sigma, result.unit);
}

double or_zero(double value) { return std::isfinite(value) ? value : 0; }

/// A browser ends a script at its first "</", wherever that stands.
std::string harmless(std::string json) {
  for (std::size_t at = 0; (at = json.find("</", at)) != std::string::npos; at += 3)
    json.replace(at, 2, "<\\/");
  return json;
}

}  // namespace

std::string view_page(const DepthResult& result, const DepthSummary& summary) {
  const DepthMaps& maps = result.maps;
  const Thinning thinning(maps);
  JsonLine line;
  line.add("rig", result.rig).add("summary", summary_words(result, summary));
  line.add("width", maps.width_px).add("height", maps.height_px);
  line.add("columns", thinning.columns).add("rows", thinning.rows);
  line.add("unit", result.unit).add("lensUnit", result.lens_unit);
  line.add_json("nearIsSmall", result.is_metric() ? "true" : "false");
  line.add("low", or_zero(summary.low)).add("high", or_zero(summary.high));
  line.add("medianSigma", or_zero(summary.median_sigma));
  line.add("sigmaHigh", 3 * or_zero(summary.median_sigma));
  line.add("positions", result.positions);
  add_classes(line, summary, result.pixels());
  line.add_json("palette", palette_json());
  line.add_json("depth", packed(thinning, maps, maps.position));
  line.add_json("sigma", packed(thinning, maps, maps.sigma));
  line.add("classes", class_bytes(thinning, maps));
  line.add_json("curves", curves_json(result.curves));
  line.add("sharp", base64(small_picture(result.sharp)));
  std::string page(kPage, sizeof kPage);
  constexpr std::string_view kPlace = "@DATA@";
  return page.replace(page.find(kPlace), kPlace.size(), harmless(line.text()));
}

}  // namespace fathom::mapping
