// SPDX-License-Identifier: Apache-2.0
// How true maps of depth are, beside those of others, on scenes of known depth; how sure they are; how
// fast, and how much memory they take.
//
//   fathom_depth_bench [--seed N] [--backend NAME] [--speed]
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "backends/backends.hpp"
#include "bench/depth/peers.hpp"
#include "bench/depth/scenes.hpp"
#include "depth/mapper.hpp"

namespace fathom {
namespace {

struct Request {
  unsigned seed = 1;
  std::string backend = "cpu";
  bool is_speed = false;
};

OpenDevice opener(const std::string& backend) {
  return [backend](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), backend, spec, windows);
  };
}

DepthMaps map_of(std::span<const Frame> frames, const std::string& backend) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < frames.size(); ++i) positions.push_back(static_cast<double>(i));
  DepthMapper mapper(opener(backend), frames[0].width_px(), frames[0].height_px(), positions);
  for (std::size_t i = 0; i < frames.size(); ++i) mapper.add(i, frames[i]);
  return mapper.finish();
}

/// Root mean square error on the pixels that the map answers.
double error_of(std::span<const float> depth, std::span<const float> truth, const DepthMaps& maps) {
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (maps.classes[i] != DepthClass::known) continue;
    squares += std::pow(depth[i] - truth[i], 2);
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// Root mean square of error over sigma.
double error_over_sigma(const DepthMaps& maps, std::span<const float> truth) {
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (maps.classes[i] != DepthClass::known) continue;
    squares += std::pow((maps.position[i] - truth[i]) / maps.sigma[i], 2);
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// Ratio of the map's error to that of the best of the others.
double compare(scenes::Texture texture, scenes::Shape shape, double noise, const Request& request) {
  const scenes::Scene scene = scenes::make(texture, shape, {.noise = noise, .seed = request.seed});
  const DepthMaps maps = map_of(scene.frames, request.backend);
  const double ours = error_of(maps.position, scene.depth, maps);
  const double laplacian9 =
      error_of(peers::sum_of_modified_laplacian(scene.frames, 9), scene.depth, maps);
  const double laplacian21 =
      error_of(peers::sum_of_modified_laplacian(scene.frames, 21), scene.depth, maps);
  const double rings = error_of(peers::ring_difference_filter(scene.frames), scene.depth, maps);
  const double ratio = ours / std::min({laplacian9, laplacian21, rings});
  const auto known = std::ranges::count(maps.classes, DepthClass::known);
  fmt::print("{:7} {:6} {:5g}  {:7.3f}  {:7.3f} {:7.3f} {:7.3f}  {:6.2f} {:8.1f} {:12.2f}\n",
             to_string(texture), to_string(shape), noise, ours, laplacian9, laplacian21, rings,
             ratio, 100.0 * static_cast<double>(known) / static_cast<double>(scene.depth.size()),
             error_over_sigma(maps, scene.depth));
  return ratio;
}

void compare_all(const Request& request) {
  fmt::print(
      "                        error, frames: of others          best's\n"
      "texture shape  noise  Fathom   SML 9    SML 21     RDF   ratio  % known  error/sigma\n");
  double logs = 0, worst = 0;
  int count = 0;
  for (const scenes::Texture texture : scenes::kTextures) {
    for (const scenes::Shape shape : scenes::kShapes) {
      for (const double noise : {1.0, 4.0, 6.0}) {
        const double ratio = compare(texture, shape, noise, request);
        logs += std::log(ratio);
        worst = std::max(worst, ratio);
        ++count;
      }
    }
  }
  fmt::print("geometric mean of the ratios {:.2f}, worst {:.2f}\n", std::exp(logs / count), worst);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Frames of any size: tiles of a scene.
Frame tiled(const Frame& tile, int width, int height) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      pixels.push_back(
          static_cast<std::uint8_t>(tile.at(x % tile.width_px(), y % tile.height_px())));
    }
  }
  return Frame(width, height, std::move(pixels));
}

void time_one(int width, int height, int frames, const Request& request) {
  const scenes::Scene scene =
      scenes::make(scenes::Texture::pink, scenes::Shape::waves,
                   {.frames = frames, .px_per_frame = 40.0 / frames, .seed = request.seed});
  std::vector<double> positions;
  for (int i = 0; i < frames; ++i) positions.push_back(i);
  const double before_mb = peak_mb();
  DepthMapper mapper(opener(request.backend), width, height, positions);
  double adding = 0;
  for (int i = 0; i < frames; ++i) {
    const Frame frame = tiled(scene.frames[i], width, height);
    const auto start = std::chrono::steady_clock::now();
    mapper.add(i, frame);
    adding += seconds_since(start);
  }
  const auto start = std::chrono::steady_clock::now();
  const DepthMaps maps = mapper.finish();
  const double finishing = seconds_since(start);
  const double megapixels = 1e-6 * width * height;
  fmt::print(
      "{:5.1f} MP x {:3}: frames {:6.2f} s, map {:6.2f} s, {:5.0f} MP/s of input, {:5.0f} MB "
      "more at most\n",
      megapixels, frames, adding, finishing, megapixels * frames / (adding + finishing),
      peak_mb() - before_mb);
}

/// The smallest first: the peak of memory only grows.
void time_all(const Request& request) {
  for (const auto& [width, height, frames] :
       {std::array{1024, 768, 20}, {2048, 1536, 20}, {2048, 1536, 80}, {4096, 3072, 20}}) {
    time_one(width, height, frames, request);
  }
}

Request read(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--speed") {
      request.is_speed = true;
    } else if (word == "--seed" && i + 1 < argc) {
      request.seed = static_cast<unsigned>(std::strtoul(argv[++i], nullptr, 10));
    } else if (word == "--backend" && i + 1 < argc) {
      request.backend = argv[++i];
    } else {
      fmt::print(stderr, "usage: fathom_depth_bench [--seed N] [--backend NAME] [--speed]\n");
      std::exit(2);
    }
  }
  return request;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  const fathom::Request request = fathom::read(argc, argv);
  if (request.is_speed) {
    fathom::time_all(request);
  } else {
    fathom::compare_all(request);
  }
}
