// SPDX-License-Identifier: Apache-2.0
// Maps of stacks whose depth is known at every pixel.
#include "depth/mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "backends/backends.hpp"
#include "bench/depth/scenes.hpp"
#include "depth/interruption.hpp"
#include "depth/placed.hpp"
#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using scenes::Shape;
using scenes::Texture;

Selection open_cpu(const MetricSpec& spec, std::size_t windows) {
  return select_device(all_backends(), "cpu", spec, windows);
}

scenes::Options small() {
  return {.width_px = 192, .height_px = 160, .frames = 15, .px_per_frame = 2.4, .seed = 7};
}

std::vector<double> numbers_of(std::size_t count, double first = 0, double step = 1) {
  std::vector<double> positions(count);
  for (std::size_t i = 0; i < count; ++i) positions[i] = first + step * static_cast<double>(i);
  return positions;
}

DepthMaps map_of(const scenes::Scene& scene, const DepthOptions& options = {}) {
  DepthMapper mapper(open_cpu, scene.frames[0].width_px(), scene.frames[0].height_px(),
                     numbers_of(scene.frames.size()), options);
  for (std::size_t i = 0; i < scene.frames.size(); ++i) mapper.add(i, scene.frames[i]);
  return mapper.finish();
}

double part_of(const DepthMaps& maps, DepthClass kind) {
  return static_cast<double>(std::ranges::count(maps.classes, kind)) /
         static_cast<double>(maps.classes.size());
}

struct Errors {
  double rms = 0;
  double over_sigma = 0;  ///< Root mean square of error over sigma.
};

Errors errors_of(const DepthMaps& maps, const std::vector<float>& truth) {
  Errors errors;
  double count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (maps.classes[i] != DepthClass::known) continue;
    const double error = maps.position[i] - truth[i];
    errors.rms += error * error;
    errors.over_sigma += std::pow(error / maps.sigma[i], 2);
    ++count;
  }
  return {std::sqrt(errors.rms / count), std::sqrt(errors.over_sigma / count)};
}

TEST(DepthMapper, FindsASlopeInEveryTexture) {
  for (const Texture texture : scenes::kTextures) {
    SCOPED_TRACE(to_string(texture));
    const scenes::Scene scene = scenes::make(texture, Shape::slope, small());
    const DepthMaps maps = map_of(scene);
    EXPECT_GT(part_of(maps, DepthClass::known), 0.97);
    const Errors errors = errors_of(maps, scene.depth);
    EXPECT_LT(errors.rms, texture == Texture::faint ? 0.25 : 0.12);
    EXPECT_GT(errors.over_sigma, 0.15);
    EXPECT_LT(errors.over_sigma, 1.8);
  }
}

TEST(DepthMapper, KeepsACliffAndLeavesOutWhatItsWindowsMix) {
  const scenes::Scene scene = scenes::make(Texture::white, Shape::step, small());
  const DepthMaps maps = map_of(scene);
  EXPECT_GT(part_of(maps, DepthClass::known), 0.85);
  EXPECT_GT(part_of(maps, DepthClass::two_depths), 0.02);
  EXPECT_EQ(part_of(maps, DepthClass::no_texture), 0);
  for (std::size_t i = 0; i < scene.depth.size(); ++i) {
    if (maps.classes[i] == DepthClass::known) {
      ASSERT_LT(std::abs(maps.position[i] - scene.depth[i]), 1) << "pixel " << i;
    }
  }
}

/// A bright texture's stair: three treads, each so many frames above the one on its left.
scenes::Scene stair(float rise) {
  scenes::Options options = small();
  options.px_per_frame = 0.8;
  return scenes::make(
      Texture::white,
      [=](double u, double) { return 5 + rise * static_cast<float>(static_cast<int>(3 * u)); },
      options);
}

TEST(DepthMapper, AnswersNothingOnCliffsThatAreLowerThanADepthOfFocus) {
  for (const float rise : {1.5f, 2.0f, 3.0f}) {
    SCOPED_TRACE(rise);
    const scenes::Scene scene = stair(rise);
    const DepthMaps maps = map_of(scene);
    EXPECT_GT(part_of(maps, DepthClass::known), 0.75);
    EXPECT_GT(part_of(maps, DepthClass::two_depths), 0.1);
    const Errors errors = errors_of(maps, scene.depth);
    EXPECT_LT(errors.rms, 0.12);
    EXPECT_LT(errors.over_sigma, 1.6);
  }
}

TEST(DepthMapper, AnswersNothingBetweenItsSpecksAndACliff) {
  for (const unsigned seed : {1u, 4u}) {
    SCOPED_TRACE(seed);
    const scenes::Scene scene = scenes::make(Texture::sparse, Shape::step, {.seed = seed});
    const DepthMaps maps = map_of(scene);
    EXPECT_GT(part_of(maps, DepthClass::known), 0.9);
    const Errors errors = errors_of(maps, scene.depth);
    EXPECT_LT(errors.rms, 0.2);
    EXPECT_GT(errors.over_sigma, 0.4);
    EXPECT_LT(errors.over_sigma, 1.6);
  }
}

TEST(DepthMapper, IsAsSureOfSteepSlopesBetweenSpecksAsItMayBe) {
  const scenes::Scene scene = scenes::make(Texture::sparse, Shape::waves, {.seed = 1});
  const DepthMaps maps = map_of(scene);
  EXPECT_GT(part_of(maps, DepthClass::known), 0.93);
  const Errors errors = errors_of(maps, scene.depth);
  EXPECT_GT(errors.over_sigma, 0.5);
  EXPECT_LT(errors.over_sigma, 1.6);
}

TEST(DepthMapper, TellsNothingOfNoise) {
  scenes::Options options = small();
  options.noise = 60;  // A standard deviation of 100 grey levels; the texture has 3.
  const DepthMaps maps = map_of(scenes::make(Texture::faint, Shape::slope, options));
  EXPECT_LT(part_of(maps, DepthClass::known), 0.03);
  for (std::size_t i = 0; i < maps.classes.size(); ++i) {
    const bool is_known = maps.classes[i] == DepthClass::known;
    ASSERT_EQ(std::isnan(maps.position[i]), !is_known);
    ASSERT_EQ(std::isnan(maps.sigma[i]), !is_known);
    ASSERT_EQ(std::isnan(maps.confidence[i]), !is_known);
  }
}

TEST(DepthMapper, TellsNothingOfAFlatPicture) {
  DepthMapper mapper(open_cpu, 64, 48, numbers_of(5));
  for (std::size_t i = 0; i < 5; ++i) {
    mapper.add(i, Frame(64, 48, std::vector<std::uint8_t>(64 * 48, 90)));
  }
  EXPECT_EQ(part_of(mapper.finish(), DepthClass::no_texture), 1);
}

TEST(DepthMapper, SaysWhereTheTravelEndsBeforeTheFocus) {
  const scenes::Scene scene = scenes::make(Texture::white, Shape::slope, small());
  // The first nine frames: the right half of the picture comes into focus after them.
  DepthMapper mapper(open_cpu, 192, 160, numbers_of(9));
  for (std::size_t i = 0; i < 9; ++i) mapper.add(i, scene.frames[i]);
  const DepthMaps maps = mapper.finish();
  const std::size_t row = std::size_t{80} * 192;
  EXPECT_EQ(maps.classes[row + 40], DepthClass::known);
  EXPECT_EQ(maps.classes[row + 150], DepthClass::at_end);
}

TEST(DepthMapper, TakesPositionsInAnyOrderAndUnit) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  const DepthMaps plain = map_of(scene);
  const std::size_t count = scene.frames.size();
  std::vector<double> positions = numbers_of(count, 500, -20);
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i * 4 % count;  // 4 and 15 share no factor
  std::vector<double> shuffled;
  for (const std::size_t frame : order) shuffled.push_back(positions[frame]);
  DepthMapper mapper(open_cpu, 192, 160, shuffled);
  for (std::size_t i = 0; i < count; ++i) mapper.add(i, scene.frames[order[i]]);
  const DepthMaps maps = mapper.finish();
  for (std::size_t i = 0; i < maps.classes.size(); i += 97) {
    if (plain.classes[i] != DepthClass::known || maps.classes[i] != DepthClass::known) continue;
    EXPECT_NEAR(maps.position[i], 500 - 20 * plain.position[i], 2);
    EXPECT_NEAR(maps.sigma[i], 20 * plain.sigma[i], 5 * plain.sigma[i]);
  }
  EXPECT_NEAR(mapper.blur().px_per_unit, 2.4 / 20, 0.4 / 20);
}

TEST(DepthMapper, DoesNotMindLightThatChanges) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  DepthMapper mapper(open_cpu, 192, 160, numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    std::vector<std::uint16_t> pixels;
    const double light = 60 * (1 + 0.3 * std::sin(2.0 * static_cast<double>(i)));
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 192; ++x) {
        pixels.push_back(static_cast<std::uint16_t>(light * scene.frames[i].at(x, y)));
      }
    }
    mapper.add(i, Frame(192, 160, std::move(pixels)));
  }
  const DepthMaps maps = mapper.finish();
  EXPECT_GT(part_of(maps, DepthClass::known), 0.97);
  EXPECT_LT(errors_of(maps, scene.depth).rms, 0.15);
}

/// What the reference picture shows at (x, y) stands at (x + dx, y + dy).
Frame shifted(const Frame& frame, int dx, int dy) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      pixels.push_back(
          static_cast<std::uint8_t>(frame.at(std::clamp(x - dx, 0, frame.width_px() - 1),
                                             std::clamp(y - dy, 0, frame.height_px() - 1))));
    }
  }
  return Frame(frame.width_px(), frame.height_px(), std::move(pixels));
}

TEST(DepthMapper, FollowsAPictureThatDrifts) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  DepthMapper mapper(open_cpu, 192, 160, numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const int dx = 2 * static_cast<int>(i), dy = -static_cast<int>(i);
    mapper.add(i, shifted(scene.frames[i], dx, dy),
               {.dx_px = static_cast<double>(dx), .dy_px = static_cast<double>(dy)});
  }
  const DepthMaps maps = mapper.finish();
  EXPECT_GT(part_of(maps, DepthClass::known), 0.75);
  EXPECT_LT(errors_of(maps, scene.depth).rms, 0.15);
  // The last column leaves the picture with the seventh frame but one.
  EXPECT_EQ(maps.classes[std::size_t{80} * 192 + 190], DepthClass::outside);
}

/// Means of 2 x 2 px, in sixteenths of a grey level.
Frame halved(const Frame& frame) {
  const int width = frame.width_px() / 2, height = frame.height_px() / 2;
  std::vector<std::uint16_t> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto sum = frame.at(2 * x, 2 * y) + frame.at(2 * x + 1, 2 * y) +
                       frame.at(2 * x, 2 * y + 1) + frame.at(2 * x + 1, 2 * y + 1);
      pixels.push_back(static_cast<std::uint16_t>(4 * sum));
    }
  }
  return Frame(width, height, std::move(pixels));
}

/// A map of the frames at half their size, where the last is larger than the first by a part.
DepthMaps map_growing(const scenes::Scene& scene, double part) {
  const auto last = static_cast<double>(scene.frames.size() - 1);
  DepthMapper mapper(open_cpu, 192, 160, numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const double scale = 1 + part * static_cast<double>(i) / last;
    const Frame grown = depth::placed(scene.frames[i], {}, {.scale = 1 / scale}).grey;
    mapper.add(i, halved(grown), {.scale = scale});
  }
  return mapper.finish();
}

TEST(DepthMapper, TellsTheSameOfAPictureThatGrows) {
  // Pictures are made larger at twice their size: what that does to fine detail is no part of the
  // question.
  scenes::Options options = small();
  options.width_px *= 2;
  options.height_px *= 2;
  options.px_per_frame *= 2;
  // Specks tell most: a window that is half a pixel off weighs them otherwise.
  const scenes::Scene scene = scenes::make(Texture::sparse, Shape::slope, options);
  const DepthMaps still = map_growing(scene, 0), maps = map_growing(scene, 0.03);
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < maps.position.size(); ++i) {
    if (maps.classes[i] != DepthClass::known || still.classes[i] != DepthClass::known) continue;
    squares += std::pow(maps.position[i] - still.position[i], 2);
    ++count;
  }
  EXPECT_GT(count, 0.85 * 192 * 160);
  EXPECT_LT(std::sqrt(squares / count), 0.1);  // frames
}

/// A map of a stack whose pictures move, so that windows fall between pixels.
DepthMaps map_on(const OpenDevice& open, const scenes::Scene& scene) {
  DepthMapper mapper(open, 96, 64, numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(scene.frames.size());
    mapper.add(i, scene.frames[i], {.scale = 1 + 0.01 * part, .dx_px = part});
  }
  return mapper.finish();
}

TEST(DepthMapper, IsTheSameOnOtherBackends) {
  scenes::Options options = small();
  options.width_px = 96;
  options.height_px = 64;
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, options);
  const DepthMaps maps = map_on(open_cpu, scene);
  for (const char* name : {"reference", "vulkan", "opencl"}) {
    SCOPED_TRACE(name);
    DepthMaps same;
    try {
      same = map_on(
          [&](const MetricSpec& spec, std::size_t windows) {
            return select_device(all_backends(), name, spec, windows);
          },
          scene);
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::unavailable) << error.what();
      std::cerr << "left out: " << error.what() << "\n";
      continue;
    }
    EXPECT_EQ(maps.classes, same.classes);
    for (std::size_t i = 0; i < maps.position.size(); ++i) {
      if (maps.classes[i] == DepthClass::known) {
        ASSERT_NEAR(maps.position[i], same.position[i], 0.01);
      }
    }
  }
}

TEST(DepthMapper, TakesTheWindowsAndTheBlurThatItIsTold) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  const DepthMaps maps = map_of(
      scene,
      {.sides = {32, 16}, .stride = 8, .blur = BlurModel{.px_per_unit = 2.4, .rest_px = 0.5}});
  EXPECT_GT(part_of(maps, DepthClass::known), 0.97);
  EXPECT_LT(errors_of(maps, scene.depth).rms, 0.2);
}

TEST(DepthMapper, CountsOnlyFramesThatWereAdded) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  DepthMapper mapper(open_cpu, 192, 160, numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    if (i != 4) mapper.add(i, scene.frames[i]);
  }
  EXPECT_LT(errors_of(mapper.finish(), scene.depth).rms, 0.2);
  DepthMapper interrupted(open_cpu, 192, 160, numbers_of(scene.frames.size()));
  interrupted.add(0, scene.frames[0]);
  test::expect_error(ErrorCode::bad_argument, [&] { interrupted.finish(); },
                     {"3 different positions"});
}

TEST(DepthMapper, RefusesWhatIsNoStack) {
  const auto make = [](int width, int height, std::vector<double> positions,
                       const DepthOptions& options = {}) {
    DepthMapper(open_cpu, width, height, positions, options);
  };
  test::expect_error(ErrorCode::bad_argument, [&] { make(64, 64, {1, 2, 1, 2}); }, {"not 2"});
  test::expect_error(ErrorCode::bad_argument, [&] { make(64, 64, {1, 2, NAN}); }, {"not a number"});
  test::expect_error(ErrorCode::bad_argument, [&] { make(64, 31, {1, 2, 3}); }, {"too small"});
  test::expect_error(ErrorCode::bad_argument,
                     [&] {
                       make(64, 64, {1, 2, 3}, {.sides = {24}});
                     },
                     {"windows of 24 px"});
  test::expect_error(ErrorCode::bad_argument,
                     [&] {
                       make(64, 64, {1, 2, 3}, {.stride = -1});
                     },
                     {"-1 px apart"});
  test::expect_error(ErrorCode::bad_argument,
                     [&] {
                       make(64, 64, {1, 2, 3}, {.sides = {64}});
                     },
                     {"no room"});
  DepthMapper mapper(open_cpu, 64, 48, numbers_of(4));
  const Frame other(48, 64, std::vector<std::uint8_t>(64 * 48));
  const Frame right(64, 48, std::vector<std::uint8_t>(64 * 48));
  test::expect_error(ErrorCode::bad_argument, [&] { mapper.add(0, other); }, {"48 x 64"});
  test::expect_error(ErrorCode::bad_argument, [&] { mapper.add(4, right); }, {"picture 5 of 4"});
  for (std::size_t i = 0; i < 3; ++i) mapper.add(i, right);
  test::expect_error(ErrorCode::bad_argument, [&] { mapper.finish(&other); }, {"guide"});
}

/// Each step of a map is asked, so none takes its user's time for good.
TEST(DepthMapper, EndsWhereSomebodyInterrupts) {
  const scenes::Scene scene = scenes::make(Texture::pink, Shape::slope, small());
  DepthMapper mapper(open_cpu, scene.frames[0].width_px(), scene.frames[0].height_px(),
                     numbers_of(scene.frames.size()));
  for (std::size_t i = 0; i < scene.frames.size(); ++i) mapper.add(i, scene.frames[i]);
  const Interruptible interruptible([] { throw std::runtime_error("enough"); });
  EXPECT_THROW(mapper.add(0, scene.frames[0]), std::runtime_error);
  EXPECT_THROW(mapper.finish(), std::runtime_error);
}

}  // namespace
}  // namespace fathom
