// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom::cli {

using namespace mapping;

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<int> number_in(std::string_view text) {
  text = trimmed(text);
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end || text.empty()) return std::nullopt;
  return value;
}

std::optional<Window> window_in(std::string_view line) {
  std::array<int, 3> numbers{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
    const auto number = number_in(line.substr(0, comma));
    if (!number) return std::nullopt;
    numbers[i] = *number;
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  return Window{numbers[0], numbers[1], numbers[2]};
}

bool is_words(std::string_view line) {
  return std::none_of(line.begin(), line.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// What is known of one region.
struct Region {
  std::vector<float> depths, sigmas;
  std::array<std::size_t, kDepthClasses> counts{};
};

Region region_of(const DepthMaps& maps, const Window& window) {
  Region region;
  for (int y = window.y; y < window.y + window.n; ++y) {
    for (int x = window.x; x < window.x + window.n; ++x) {
      const std::size_t i = std::size_t{1} * y * maps.width_px + x;
      ++region.counts[static_cast<std::size_t>(maps.classes[i])];
      if (std::isnan(maps.position[i])) continue;
      region.depths.push_back(maps.position[i]);
      region.sigmas.push_back(maps.sigma[i]);
    }
  }
  return region;
}

}  // namespace

std::vector<Window> parse_regions(std::string_view text, const std::string& name) {
  std::vector<Window> regions;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.starts_with('#')) continue;
    const auto window = window_in(line);
    if (!window && regions.empty() && is_words(line)) continue;
    if (!window || window->n < 1) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} line {}: a region is x,y,n: left column, top row and side in "
                              "pixels",
                              name, number));
    }
    regions.push_back(*window);
  }
  if (regions.empty())
    throw Error(ErrorCode::bad_data, fmt::format("{} names no region, x,y,n a line", name));
  return regions;
}

void require_inside(const std::vector<Window>& regions, int width_px, int height_px) {
  for (const Window& region : regions) {
    const bool is_inside = region.x >= 0 && region.y >= 0 && region.n <= width_px - region.x &&
                           region.n <= height_px - region.y;
    if (is_inside) continue;
    throw Error(ErrorCode::out_of_bounds,
                fmt::format("the region {} lies over the edge of pictures of {} x {} px",
                            to_string(region), width_px, height_px));
  }
}

std::string regions_csv(const DepthResult& result, const std::vector<Window>& regions) {
  std::string csv = "x,y,n,position,sigma,verdict,known\n";
  for (const Window& window : regions) {
    const Region region = region_of(result.maps, window);
    const auto total = static_cast<double>(window.n) * window.n;
    const double known = static_cast<double>(region.depths.size()) / total;
    const auto most = std::max_element(region.counts.begin(), region.counts.end());
    const auto verdict = kAllDepthClasses[static_cast<std::size_t>(most - region.counts.begin())];
    csv += fmt::format("{},{},{},", window.x, window.y, window.n);
    csv += known < 0.5 ? std::string(",")
                       : fmt::format("{:.9g},{:.3g}", median(region.depths), median(region.sigmas));
    csv += fmt::format(",{},{:.3f}\n", to_string(verdict), known);
  }
  return csv;
}

}  // namespace fathom::cli
