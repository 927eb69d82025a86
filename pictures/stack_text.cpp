// SPDX-License-Identifier: Apache-2.0
#include "pictures/stack_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

namespace fathom::pictures {
namespace {

/// No microscope writes more planes; a damaged number must not take the memory.
constexpr std::size_t kMostPlanes = std::size_t{1} << 20;

template <class Number>
Number number_of(std::string_view text, Number fallback) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  return problem == std::errc() && next == end ? value : fallback;
}

std::map<std::string_view, std::string_view> members_of(std::string_view text) {
  std::map<std::string_view, std::string_view> members;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos)
      members.emplace(line.substr(0, equals), line.substr(equals + 1));
  }
  return members;
}

/// The pages of an array that was written page by page, its last axis fastest.
std::optional<DescribedStack> stack_of_axes(const std::vector<std::size_t>& shape,
                                            std::string_view axes) {
  DescribedStack result;
  PictureStack& stack = result.stack;
  std::size_t step = 1, channel_step = 1, slice_step = 1, time_step = 1;
  for (std::size_t i = axes.size(); i-- > 0;) {
    if (axes[i] == 'Y' || axes[i] == 'X' || axes[i] == 'S') {
      if (step > 1) return std::nullopt;
      continue;
    }
    const std::size_t size = shape[i];
    if (size == 0 || size > kMostPlanes / step) return std::nullopt;
    if (axes[i] == 'C') {
      stack.channels = size, channel_step = step;
    } else if (axes[i] == 'Z') {
      stack.slices = size, slice_step = step;
    } else if (axes[i] == 'T') {
      stack.times = size, time_step = step;
    } else {
      return std::nullopt;
    }
    step *= size;
  }
  if (stack.channels * stack.slices * stack.times != step) return std::nullopt;  // an axis twice
  result.images = step;
  for (std::size_t time = 0; time < stack.times; ++time) {
    for (std::size_t channel = 0; channel < stack.channels; ++channel) {
      for (std::size_t slice = 0; slice < stack.slices; ++slice)
        stack.pages.push_back(channel * channel_step + slice * slice_step + time * time_step);
    }
  }
  return result;
}

}  // namespace

std::optional<double> micrometres(double length, std::string_view unit) {
  // ImageJ writes the micro sign as an escape; some programs take the Greek letter.
  static const std::map<std::string_view, double> kUnits = {
      {"um", 1},           {"micron", 1},   {"microns", 1},      {"micrometer", 1},
      {"micrometers", 1},  {"\\u00B5m", 1}, {"\xc2\xb5m", 1},    {"\xb5m", 1},
      {"\xce\xbcm", 1},    {"nm", 1e-3},    {"nanometer", 1e-3}, {"mm", 1e3},
      {"millimeter", 1e3}, {"cm", 1e4},     {"m", 1e6}};
  const auto found = kUnits.find(unit);
  const double result = found == kUnits.end() ? 0 : length * found->second;
  if (!(result > 0) || !std::isfinite(result)) return std::nullopt;
  return result;
}

std::optional<DescribedStack> parse_shaped(std::string_view description) {
  constexpr std::string_view kShape = "\"shape\": [", kAxes = "\"axes\": \"";
  const std::size_t shape_at = description.find(kShape);
  const std::size_t axes_at = description.find(kAxes);
  constexpr std::size_t kNowhere = std::string_view::npos;
  if (!description.starts_with('{') || shape_at == kNowhere || axes_at == kNowhere)
    return std::nullopt;
  std::string_view axes = description.substr(axes_at + kAxes.size());
  axes = axes.substr(0, axes.find('"'));
  std::vector<std::size_t> shape;
  std::string_view numbers = description.substr(shape_at + kShape.size());
  numbers = numbers.substr(0, numbers.find(']'));
  while (!numbers.empty()) {
    const std::size_t comma = std::min(numbers.find(','), numbers.size());
    shape.push_back(number_of(numbers.substr(0, comma), std::size_t{0}));
    numbers.remove_prefix(std::min(comma + 2, numbers.size()));  // and the blank
  }
  if (shape.size() != axes.size()) return std::nullopt;
  return stack_of_axes(shape, axes);
}

std::optional<DescribedStack> parse_imagej(std::string_view description) {
  if (!description.starts_with("ImageJ=")) return std::nullopt;
  const auto members = members_of(description);
  const auto count = [&](std::string_view key, std::size_t fallback) {
    const auto found = members.find(key);
    return found == members.end() ? fallback : number_of(found->second, fallback);
  };
  DescribedStack result;
  result.images = count("images", 1);
  PictureStack& stack = result.stack;
  stack.channels = count("channels", 1);
  stack.times = count("frames", 1);
  stack.slices = count("slices", 1);
  const std::size_t sizes[] = {stack.channels, stack.slices, stack.times};
  std::size_t product = 1;
  for (const std::size_t size : sizes) {
    if (size == 0 || size > kMostPlanes || product > kMostPlanes) return result;
    product *= size;
  }
  if (product == 1) stack.slices = product = result.images;
  if (product != result.images || product > kMostPlanes) return result;
  if (members.contains("spacing") && members.contains("unit")) {
    stack.spacing_um = micrometres(number_of(members.at("spacing"), 0.0), members.at("unit"));
  }
  stack.pages.resize(product);
  for (std::size_t i = 0; i < product; ++i) {
    const std::size_t channel = i % stack.channels;
    const std::size_t slice = i / stack.channels % stack.slices;
    const std::size_t time = i / stack.channels / stack.slices;
    stack.pages[(time * stack.channels + channel) * stack.slices + slice] = i;
  }
  return result;
}

}  // namespace fathom::pictures
