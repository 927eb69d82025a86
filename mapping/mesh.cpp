// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

namespace fathom::mapping {
namespace {

constexpr double kMostVertices = 500'000;

struct Vertex {
  float x, y, z, sigma;
  std::array<std::uint8_t, 3> colour;
  std::uint8_t depth_class;
};
using Triangle = std::array<std::int32_t, 3>;

struct Surface {
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
};

std::array<std::uint8_t, 3> colour_at(const Sharp& sharp, std::size_t pixel, int x, int y) {
  const auto byte = [](std::uint32_t value, bool is_wide) {
    return static_cast<std::uint8_t>(is_wide ? value >> 8 : value);
  };
  const Colours& colours = sharp.colours;
  const bool is_wide = sharp.grey.depth() == Depth::bits16;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t value = colours.empty() ? sharp.grey.at(x, y)
                                : is_wide       ? colours.bits16[3 * pixel + c]
                                                : colours.bits8[3 * pixel + c];
    rgb[c] = byte(value, is_wide);
  }
  return rgb;
}

class SurfaceMaker {
 public:
  SurfaceMaker(const DepthResult& result, const MeshScale& scale)
      : result_(result), maps_(result.maps), scale_(scale) {
    const DepthSummary summary = summary_of(maps_);
    // What two neighbours may differ by on one surface: a hundredth of all depth, or some sigmas.
    cliff_ =
        static_cast<float>(std::max(0.02 * (summary.high - summary.low), 6 * summary.median_sigma));
  }

  Surface make() {
    columns_ = (maps_.width_px + scale_.step - 1) / scale_.step;
    rows_ = (maps_.height_px + scale_.step - 1) / scale_.step;
    numbers_.assign(std::size_t{1} * columns_ * rows_, -1);
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) add_vertex(column, row);
    }
    for (int row = 0; row + 1 < rows_; ++row) {
      for (int column = 0; column + 1 < columns_; ++column) {
        const std::int32_t a = number(column, row), b = number(column + 1, row),
                           c = number(column, row + 1), d = number(column + 1, row + 1);
        add_triangle(a, c, b);
        add_triangle(b, c, d);
      }
    }
    return std::move(surface_);
  }

 private:
  std::int32_t number(int column, int row) const {
    return numbers_[std::size_t{1} * row * columns_ + column];
  }

  void add_vertex(int column, int row) {
    const int x = column * scale_.step, y = row * scale_.step;
    const std::size_t pixel = std::size_t{1} * y * maps_.width_px + x;
    const float depth = maps_.position[pixel];
    if (std::isnan(depth)) return;
    const auto cx = static_cast<float>(x - 0.5 * (maps_.width_px - 1));
    const auto cy = static_cast<float>(0.5 * (maps_.height_px - 1) - y);
    const float per_px = scale_.px_angle > 0 ? static_cast<float>(scale_.px_angle) * depth : 1.0F;
    numbers_[std::size_t{1} * row * columns_ + column] =
        static_cast<std::int32_t>(surface_.vertices.size());
    surface_.vertices.push_back({.x = cx * per_px,
                                 .y = cy * per_px,
                                 .z = result_.is_metric() ? -depth : depth,
                                 .sigma = maps_.sigma[pixel],
                                 .colour = colour_at(result_.sharp, pixel, x, y),
                                 .depth_class = static_cast<std::uint8_t>(maps_.classes[pixel])});
  }

  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    if (a < 0 || b < 0 || c < 0) return;
    const float za = surface_.vertices[a].z, zb = surface_.vertices[b].z,
                zc = surface_.vertices[c].z;
    if (std::max({za, zb, zc}) - std::min({za, zb, zc}) > cliff_) return;
    surface_.triangles.push_back({a, b, c});
  }

  const DepthResult& result_;
  const DepthMaps& maps_;
  MeshScale scale_;
  float cliff_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::int32_t> numbers_;
  Surface surface_;
};

template <class Number>
void append(std::string& bytes, Number number) {
  auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

}  // namespace

MeshScale mesh_scale(const DepthResult& result) {
  const auto pixels = static_cast<double>(result.pixels());
  return {.px_angle = 0,
          .step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostVertices))))};
}

std::string ply_of(const DepthResult& result, const MeshScale& scale) {
  const Surface surface = SurfaceMaker(result, scale).make();
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment depth in {}, x and y in {}\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float sigma\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar class\nelement face {}\nproperty list uchar int vertex_indices\n"
      "end_header\n",
      result.unit, scale.px_angle > 0 ? "mm" : "pixels", surface.vertices.size(),
      surface.triangles.size());
  for (const Vertex& vertex : surface.vertices) {
    for (const float number : {vertex.x, vertex.y, vertex.z, vertex.sigma}) append(bytes, number);
    for (const std::uint8_t part : vertex.colour) append(bytes, part);
    append(bytes, vertex.depth_class);
  }
  for (const Triangle& triangle : surface.triangles) {
    append(bytes, std::uint8_t{3});
    for (const std::int32_t corner : triangle) append(bytes, corner);
  }
  return bytes;
}

std::string obj_of(const DepthResult& result, const MeshScale& scale) {
  const Surface surface = SurfaceMaker(result, scale).make();
  std::string text = fmt::format("# depth in {}, x and y in {}\n", result.unit,
                                 scale.px_angle > 0 ? "mm" : "pixels");
  for (const Vertex& vertex : surface.vertices) {
    fmt::format_to(std::back_inserter(text), "v {:g} {:g} {:g} {:.3f} {:.3f} {:.3f}\n", vertex.x,
                   vertex.y, vertex.z, vertex.colour[0] / 255.0, vertex.colour[1] / 255.0,
                   vertex.colour[2] / 255.0);
  }
  for (const Triangle& triangle : surface.triangles) {
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", triangle[0] + 1, triangle[1] + 1,
                   triangle[2] + 1);
  }
  return text;
}

}  // namespace fathom::mapping
