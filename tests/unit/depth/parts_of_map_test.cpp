// SPDX-License-Identifier: Apache-2.0
// What a map is made of, each by itself.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "depth/correlate.hpp"
#include "depth/halve.hpp"
#include "depth/interruption.hpp"
#include "depth/levels.hpp"
#include "depth/nodes.hpp"
#include "depth/parallel.hpp"
#include "depth/ring_store.hpp"

namespace fathom::depth {
namespace {

TEST(RingStore, KeepsPowersToSixPercentAndForgets) {
  RingStore store(4, 2);
  EXPECT_FALSE(store.has(0));
  for (double power = 1e-5; power < 50; power *= 1.37) {
    const std::vector<double> powers{7 * power, 0, 70 * power, 1e-9};
    store.put(0, 0, powers, 7);
    std::vector<float> back(4);
    store.take(0, 0, back);
    EXPECT_NEAR(back[0] / power, 1, 0.0626);
    EXPECT_EQ(back[1], 0);
    EXPECT_NEAR(back[2] / (10 * power), 1, 0.0626);
    EXPECT_EQ(back[3], 0);
  }
  EXPECT_TRUE(store.has(0));
  EXPECT_FALSE(store.has(1));
  store.forget(0, 1, 2);
  std::vector<float> back(4);
  store.take(0, 0, back);
  EXPECT_FALSE(std::isnan(back[0]));
  EXPECT_TRUE(std::isnan(back[1]) && std::isnan(back[2]));
}

TEST(Halve, AveragesOneThreeThreeOneAndKeepsFractions) {
  // 5 x 4: the last column is dropped.
  const std::vector<std::uint8_t> pixels{10, 20, 30, 40, 99, 10, 20, 30, 40, 99,
                                         10, 20, 30, 40, 99, 10, 20, 30, 40, 99};
  std::vector<std::uint16_t> buffer;
  const Frame half = halve(Frame(5, 4, pixels), buffer, 1);
  ASSERT_EQ(half.width_px(), 2);
  ASSERT_EQ(half.height_px(), 2);
  EXPECT_EQ(half.at(0, 1), kFineness * (10 + 3 * 10 + 3 * 20 + 30) / 8);
  EXPECT_EQ(half.at(1, 0), kFineness * (20 + 3 * 30 + 3 * 40 + 99) / 8);
  const std::vector<std::uint16_t> deep{65535, 65535, 65535, 65535};
  std::vector<std::uint16_t> deep_buffer;
  EXPECT_EQ(halve(Frame(2, 2, deep), deep_buffer, 2).at(0, 0), 65535u);
}

TEST(Levels, LeaveTheSmallestOutWhereFramesAreMany) {
  const auto few = plan_levels(4000, 3000, 20, {});
  ASSERT_EQ(few.size(), 4u);
  EXPECT_EQ(few[0].side_px(), 8);
  EXPECT_EQ(few[3].side_px(), 64);
  const auto many = plan_levels(4000, 3000, 200, {});
  EXPECT_EQ(many[0].side_px(), 16);
  double bytes = 0;
  for (const Level& level : many) bytes += 200.0 * kRings * static_cast<double>(level.nodes());
  EXPECT_LT(bytes, 100e6 + 20.0 * 4000 * 3000);
}

TEST(Correlate, IsTheSumOfProductsSquaredWhereItIsAboveZero) {
  constexpr int kFrames = 5, kFoci = 5 * kFociMultiple;  // Blocks of four registers, and a rest.
  std::vector<float> powers, law, explained(kFoci, 1), likeness(kFoci, 1);
  for (int z = 0; z < kFrames; ++z) {
    powers.push_back(std::sin(1.0f + static_cast<float>(z)));
    for (int p = 0; p < kFoci; ++p) law.push_back(std::cos(0.3f * static_cast<float>(z * p)));
  }
  const RingAndLaw ring{powers.data(), law.data(), kFrames, kFoci};
  add_explained(ring, 2, explained.data());
  add_likeness(ring, 0.05f, 3, likeness.data());
  for (int p = 0; p < kFoci; ++p) {
    double sum = 0;
    for (int z = 0; z < kFrames; ++z) sum += powers[z] * law[z * kFoci + p];
    const double square = std::pow(std::max(sum, 0.0), 2);
    EXPECT_NEAR(explained[p], 1 + 2 * square, 1e-4);
    EXPECT_NEAR(likeness[p], 1 - 3 * std::log(1 - 0.05 * square), 1e-4);
  }
}

std::vector<float> profile_of(double place, double height, double second = 0) {
  std::vector<float> profile;
  for (int p = 0; p < 64; ++p) {
    profile.push_back(static_cast<float>(height * std::exp(-std::pow((p - place) / 5, 2)) +
                                         second * std::exp(-std::pow((p - 50) / 5.0, 2))));
  }
  return profile;
}

TEST(Peaks, TellPlaceSigmaAndHowSureItIs) {
  const Peak sure = peak_of(profile_of(20.3, 100));
  EXPECT_EQ(sure.kind, DepthClass::known);
  EXPECT_NEAR(sure.place, 20.3, 0.03);
  EXPECT_GT(sure.confidence, 0.99f);
  const Peak faint = peak_of(profile_of(20.3, 25));
  EXPECT_NEAR(faint.sigma / sure.sigma, 2, 0.01);
  const Peak torn = peak_of(profile_of(20.3, 100, 99.9));
  EXPECT_LT(torn.confidence, 0.6f);
  EXPECT_EQ(peak_of(profile_of(-3, 100)).kind, DepthClass::at_end);
  EXPECT_EQ(peak_of(profile_of(20.3, 1)).kind, DepthClass::no_texture);
  EXPECT_EQ(peak_of(std::vector<float>(64)).kind, DepthClass::no_texture);
}

TEST(Parallel, DoesEveryPartOnceAndThrowsOn) {
  std::vector<std::atomic<int>> done(1000);
  share_out(done.size(), 7, 3, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++done[i];
  });
  for (const auto& times : done) EXPECT_EQ(times, 1);
  EXPECT_THROW(
      share_out(10, 1, 2, [](std::size_t, std::size_t) { throw std::runtime_error("no"); }),
      std::runtime_error);
}

TEST(Parallel, EndsWhereSomebodyInterrupts) {
  std::atomic<int> done = 0;
  const auto count = [&](std::size_t, std::size_t) { ++done; };
  {
    const Interruptible interruptible([&done] {
      if (done > 5) throw std::runtime_error("enough");
    });
    EXPECT_THROW(share_out(1000, 1, 1, count), std::runtime_error);
    EXPECT_EQ(done, 6);
  }
  share_out(1000, 1, 1, count);  // nobody is asked any more
  EXPECT_EQ(done, 1006);
}

}  // namespace
}  // namespace fathom::depth
