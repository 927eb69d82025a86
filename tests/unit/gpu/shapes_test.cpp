// SPDX-License-Identifier: Apache-2.0
// How kernels and calls are cut, over every device that could be.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <set>

#include "backends/gpu/batch.hpp"
#include "backends/gpu/shape.hpp"
#include "backends/gpu/wait_limit.hpp"
#include "tests/support/frames.hpp"

namespace fathom::gpu {
namespace {

std::vector<Limits> devices() {
  std::vector<Limits> devices;
  for (const std::uint32_t shared : {16384U, 32768U, 49152U, 65536U, 101376U, 232448U}) {
    for (const std::uint32_t threads : {128U, 256U, 512U, 1024U, 1536U}) {
      for (const std::uint32_t subgroup : {1U, 4U, 8U, 32U, 64U, 128U}) {
        for (const int points : {16, 64}) {
          Limits limits;
          limits.shared_bytes = shared;
          limits.threads = threads;
          limits.subgroup = subgroup;
          limits.points = points;
          devices.push_back(limits);
        }
      }
    }
  }
  return devices;
}

TEST(Shapes, FitEveryDeviceThatVulkanAllows) {
  for (const Limits& limits : devices()) {
    for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
      for (const Transform transform : {Transform::fft, Transform::walsh_paley}) {
        for (const Depth depth : {Depth::bits8, Depth::bits16}) {
          const MetricSpec spec = MetricSpec::standard(transform, n);
          EXPECT_EQ(too_small_for(spec, limits), "");
          const auto shape = fast_shape(spec, depth, limits);
          ASSERT_TRUE(shape);
          const int split = n / shape->points;
          // What kernels/window.glsl and its users take for granted.
          EXPECT_EQ(shape->points * split, n);
          EXPECT_GT(shape->points, split);
          EXPECT_LE(split, shape->lines);
          EXPECT_EQ(n / 2 % shape->lines, 0);
          EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(shape->teams)));
          EXPECT_EQ(shape->threads, shape->teams * shape->lines * split);
          EXPECT_LE(static_cast<unsigned>(shape->threads), limits.threads);
          EXPECT_LE(static_cast<unsigned>(4 * n * (shape->lines + (shape->is_padded ? 1 : 0)) *
                                          shape->teams),
                    limits.shared_bytes);
          EXPECT_EQ(shape->scratch_bytes == 0, shape->lines == n / 2);
          EXPECT_TRUE(shape->lines == n / 2 || shape->teams == 1);
          EXPECT_TRUE(n > 64 || shape->scratch_bytes == 0) << "N = " << n << " is not fused";
        }
      }
    }
  }
}

/// Numbers of a pool with which a team sums rings, from the constants of fft.cl and walsh.comp.
int summed_words(const MetricSpec& spec, int threads) {
  return spec.transform == Transform::fft ? 2 * (spec.n + 1) + (spec.rings + 3) * threads
                                          : (spec.rings + 1) * threads + 3 * spec.rings;
}

TEST(Shapes, RingsFitEveryDeviceThatVulkanAllows) {
  for (const Limits& limits : devices()) {
    for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
      for (const char* transform : {"fft", "walsh-sequency"}) {
        for (const int rings : {2, std::min(32, n / 2)}) {
          const auto spec = MetricSpec::parse(fmt::format("{}:{}:rings={}", transform, n, rings));
          EXPECT_EQ(too_small_for(spec, limits), "");
          for (const Depth depth : {Depth::bits8, Depth::bits16}) {
            const auto shape = fast_shape(spec, depth, limits);
            ASSERT_TRUE(shape);
            const int team = shape->threads / shape->teams;
            EXPECT_LE(static_cast<unsigned>(shape->threads), limits.threads);
            EXPECT_LE(static_cast<unsigned>(4 * summed_words(spec, team) * shape->teams),
                      limits.shared_bytes);
            EXPECT_LE(static_cast<unsigned>(4 * n * (shape->lines + (shape->is_padded ? 1 : 0)) *
                                            shape->teams),
                      limits.shared_bytes);
          }
          const auto exact = exact_shape(spec, limits);
          ASSERT_TRUE(exact);
          EXPECT_LE(static_cast<unsigned>(8 * (rings + 2) * exact->threads), limits.shared_bytes);
        }
      }
    }
  }
}

TEST(Shapes, RingsOf64StayOnChipWhereThereIsRoom) {
  Limits limits;
  limits.shared_bytes = 49152;
  limits.threads = 1024;
  for (const char* text : {"fft:64:hann:power:rings=16", "walsh-sequency:64:rings=16"}) {
    const MetricSpec rings = MetricSpec::parse(text);
    EXPECT_EQ(fast_shape(rings, Depth::bits8, limits),
              fast_shape(rings.plain(), Depth::bits8, limits))
        << text;
  }
}

// What kernels cannot do must be declined, however small the device.
TEST(Shapes, KeepToWhatKernelsCan) {
  for (const std::uint32_t threads : {1U, 8U, 12U, 32U, 64U, 128U, 1024U, 4096U}) {
    for (const std::uint32_t shared : {256U, 1024U, 2048U, 4096U, 8192U, 32768U, 1048576U}) {
      for (const int points : {16, 64}) {
        Limits limits;
        limits.threads = threads;
        limits.shared_bytes = shared;
        limits.points = points;
        for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
          for (const char* transform : {"fft:", "walsh-paley:"}) {
            const auto spec = MetricSpec::parse(transform + std::to_string(n));
            const auto shape = fast_shape(spec, Depth::bits16, limits);
            if (!shape) continue;
            EXPECT_LE(shape->points, 64);
            EXPECT_GE(n * (shape->lines + (shape->is_padded ? 1 : 0)), 2 * (n + 1));
            EXPECT_LE(static_cast<unsigned>(shape->threads), threads);
            EXPECT_TRUE(shape->planes == 1 || shape->lines < n / 2)
                << "planes meet in scratch memory";
          }
        }
      }
    }
  }
}

// A processor: one thread, vectors as wide as it likes and half a window allows.
TEST(Shapes, FitEveryProcessor) {
  for (const int lanes : {4, 8, 16}) {
    for (const std::uint32_t shared : {32768U, 262144U, 1048576U}) {
      Limits limits;
      limits.lanes = lanes;
      limits.shared_bytes = shared;
      for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
        const auto shape =
            fast_shape(MetricSpec::parse("fft:" + std::to_string(n)), Depth::bits8, limits);
        ASSERT_TRUE(shape);
        EXPECT_EQ(shape->threads, 1);
        EXPECT_EQ(shape->points, n);
        EXPECT_EQ(shape->lanes, std::min(lanes, n / 2));
        EXPECT_EQ(shape->lines, shape->lanes);
        const std::uint64_t on_chip = 4U * n * (n + shape->lanes) + 4U * n * shape->lanes;
        EXPECT_EQ(shape->scratch_bytes == 0, on_chip <= shared) << n;
      }
    }
  }
}

TEST(Shapes, ScratchMemoryStaysInAProcessorsCaches) {
  Limits limits;
  limits.processors = 2;
  const MetricSpec spec = MetricSpec::parse("fft:64:hann:band=0-0.5");
  const std::uint32_t on_gpu = workgroups_of(*exact_shape(spec, limits), limits, 100'000);
  limits.lanes = 16;
  EXPECT_EQ(workgroups_of(*exact_shape(spec, limits), limits, 100'000), 8U);
  EXPECT_EQ(workgroups_of(*exact_shape(spec, limits), limits, 3), 3U);
  EXPECT_GT(on_gpu, 1000U);
}

TEST(Shapes, OneThreadHoldsAColumnOf64WhereRegistersAreMany) {
  Limits limits;
  limits.shared_bytes = 49152;
  limits.threads = 1024;
  const auto shape = fast_shape(MetricSpec::parse("fft:64"), Depth::bits8, limits);
  EXPECT_EQ(shape->points, 64);
  EXPECT_EQ(shape->threads, 32);
  EXPECT_TRUE(shape->is_padded);
  EXPECT_EQ(fast_shape(MetricSpec::parse("fft:128"), Depth::bits8, limits)->scratch_bytes, 0U);
}

TEST(Shapes, ATinyDeviceDeclinesAndSaysWhy) {
  Limits limits;
  limits.shared_bytes = 512;
  EXPECT_NE(too_small_for(MetricSpec::parse("fft:64"), limits).find("512 bytes of shared memory"),
            std::string::npos);
}

TEST(Shapes, ADeviceOfFewBuffersDeclinesAndSaysWhy) {
  Limits limits;
  limits.storage_buffers = 3;
  EXPECT_NE(too_small_for(MetricSpec::parse("fft:8"), limits).find("3 buffers, and 4 are"),
            std::string::npos);
}

TEST(WaitLimits, GrowWithTheBatchAndObeyTheUser) {
  EXPECT_DOUBLE_EQ(WaitLimit(DeviceKind::gpu).seconds(0), 60);
  EXPECT_DOUBLE_EQ(WaitLimit(DeviceKind::gpu).seconds(1'000'000), 1060);
  EXPECT_GT(WaitLimit(DeviceKind::software).seconds(1000), 2000);
  setenv("FATHOM_GPU_TIMEOUT", "2.5", 1);
  EXPECT_DOUBLE_EQ(WaitLimit(DeviceKind::software).seconds(1000), 2.5);
  for (const char* nonsense : {"0", "-1", "soon", "1 s", "inf", "nan"}) {
    setenv("FATHOM_GPU_TIMEOUT", nonsense, 1);
    EXPECT_THROW(WaitLimit(DeviceKind::gpu), Error) << nonsense;
  }
  unsetenv("FATHOM_GPU_TIMEOUT");
}

Rectangle around(const std::vector<Window>& windows, const std::vector<std::uint32_t>& ids) {
  Rectangle part;
  for (const std::uint32_t id : ids) part.include(windows[id]);
  return part;
}

TEST(Batches, HoldEveryWindowOnceAndFit) {
  test::SplitMix64 noise(1);
  std::vector<Window> windows;
  for (int i = 0; i < 500; ++i) {
    windows.push_back({static_cast<int>(noise.below(900)), static_cast<int>(noise.below(700)), 32});
  }
  for (const std::size_t room : {1'000'000U, 100'000U, 40'000U, 5'000U, 10U}) {
    for (const std::size_t most : {1U, 7U, 1000U}) {
      const auto batches = cut(windows, Depth::bits16, most, room);
      std::set<std::uint32_t> seen;
      for (const Batch& batch : batches) {
        EXPECT_LE(batch.ids.size(), most);
        EXPECT_EQ(batch.part, around(windows, batch.ids));
        EXPECT_TRUE(batch.ids.size() == 1 || batch.part.bytes(Depth::bits16) <= room);
        for (const std::uint32_t id : batch.ids) EXPECT_TRUE(seen.insert(id).second);
      }
      EXPECT_EQ(seen.size(), windows.size());
    }
  }
}

// Windows that jump all over a frame of twice the room must not cost an upload each.
TEST(Batches, UploadFewPixelsTwice) {
  test::SplitMix64 noise(2);
  std::vector<Window> windows;
  for (int i = 0; i < 5000; ++i) {
    windows.push_back({static_cast<int>(noise.below(968)), static_cast<int>(noise.below(968)), 32});
  }
  const auto batches = cut(windows, Depth::bits8, 100'000, 500'000);
  EXPECT_LE(batches.size(), 3U);
}

TEST(Batches, AFrameThatFitsKeepsTheOrder) {
  const std::vector<Window> windows = {{5, 90, 8}, {0, 0, 8}, {7, 30, 8}};
  const auto batches = cut(windows, Depth::bits8, 100, 1 << 20);
  ASSERT_EQ(batches.size(), 1U);
  EXPECT_EQ(batches[0].ids, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(Rectangles, CopyPixelsToWholeWords) {
  const Frame frame = test::make_frame("random", 16, 40, 30, 9);
  Rectangle part;
  part.include({3, 4, 8});
  part.include({8, 7, 8});
  EXPECT_EQ(part.stride_bytes(Depth::bits16), 28U);  // 13 pixels
  std::vector<std::byte> packed(part.bytes(Depth::bits16));
  part.copy(frame, packed.data());
  const Window window{8, 7, 8};
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      std::uint16_t pixel;
      std::memcpy(&pixel,
                  packed.data() + part.origin(window, Depth::bits16) + y * 28 + x * sizeof pixel,
                  sizeof pixel);
      ASSERT_EQ(pixel, frame.at(8 + x, 7 + y));
    }
  }
}

}  // namespace
}  // namespace fathom::gpu
