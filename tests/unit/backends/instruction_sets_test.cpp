// SPDX-License-Identifier: Apache-2.0
// The same metric in every instruction set that this processor has. What only the processor can
// decide, which sets ran, is printed and recorded.
#include "backends/cpu/kernel.hpp"

#include <bit>
#include <cstdio>
#include <set>

#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which sets there are.
#include <hwy/targets.h>

#include "engine/error.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom {
namespace {

TEST(InstructionSets, AreNamedOnceEachBestFirst) {
  const auto sets = cpu::instruction_sets();
  const auto infos = test::cpu().devices();
  ASSERT_EQ(infos.size(), sets.size());
  const std::vector<std::string> best_first = {"AVX-512", "AVX2", "SSE4", "NEON"};
  auto place = best_first.begin();
  std::string names;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    EXPECT_EQ(infos[i].name, sets[i].name);
    EXPECT_EQ(infos[i].details, sets[i].details);
    EXPECT_FALSE(infos[i].details.empty());
    EXPECT_EQ(infos[i].kind, DeviceKind::cpu);
    place = std::find(place, best_first.end(), infos[i].name);  // none twice, none out of order
    ASSERT_NE(place++, best_first.end()) << infos[i].name;
    names += (names.empty() ? "" : ", ") + infos[i].name;
  }
  std::printf("[ SETS     ] %s\n", names.empty() ? "none" : names.c_str());
  RecordProperty("instruction_sets", names);
}

// Highway asks the processor by code of its own. On ARM it asks for the cryptography extension too,
// which is not needed here (targets.hpp).
TEST(InstructionSets, AreThoseOfTheProcessor) {
#if defined(__x86_64__)
  const auto supported = hwy::SupportedTargets();
#else
  const auto supported = HWY_ENABLED_BASELINE;
#endif
  std::vector<std::string> expected, found;
#define FATHOM_EXPECT(space, bit, name, details) \
  if (supported & (bit)) expected.push_back(name);
  FATHOM_CPU_TARGETS(FATHOM_EXPECT)
#undef FATHOM_EXPECT
  for (const DeviceInfo& info : test::cpu().devices()) found.push_back(info.name);
  EXPECT_EQ(found, expected);
}

TEST(InstructionSets, OneMoreThanThereAreDoesNotOpen) {
  const std::size_t count = test::cpu().devices().size();
  test::expect_error(ErrorCode::unavailable, [&] { test::open_cpu(count, 1); });
}

/// Windows that drive sums of a Walsh transform to their limits: one coefficient that holds all,
/// and, the greatest sum of magnitudes that there is, all coefficients alike.
test::Pixels extreme_pixels(const std::string& kind, int bits, int n, test::SplitMix64& noise) {
  test::Pixels pixels = test::make_pixels("zero", bits, n, n, 0);
  const unsigned row = noise.below(n), column = noise.below(n), inverse = noise.below(2);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const unsigned signs =
          kind == "one coefficient" ? (row & y) ^ (column & x) : (x & y) ^ (row & y) ^ (column & x);
      const bool bright = (std::popcount(signs) + inverse) % 2 == 0;
      if (bright) pixels.at(x, y) = static_cast<std::uint16_t>(pixels.largest());
    }
  }
  return pixels;
}

MetricSpec random_walsh(int n, test::SplitMix64& noise) {
  MetricSpec spec;
  spec.n = n;
  spec.taper = Taper::none();
  const Transform orders[] = {Transform::walsh_sequency, Transform::walsh_paley,
                              Transform::walsh_hadamard};
  // Sequency twice as often: it alone has bands.
  spec.transform = orders[noise.below(4) % 3];
  if (spec.transform == Transform::walsh_sequency && noise.below(2) == 0) {
    const double low = noise.below(40) / 100.0;
    // At least one coefficient's distance of the smallest window wide: an empty band is refused.
    spec.band = Band{low, low + 0.0625 + noise.below(30) / 100.0};
  }
  spec.validate();
  return spec;
}

TEST(InstructionSets, GiveTheReferenceWalshScoresToTheLastBit) {
  const auto reference = test::backend_called("reference").open(0, {});
  std::vector<std::unique_ptr<Device>> devices;
  for (std::size_t i = 0; i < test::cpu().devices().size(); ++i) {
    devices.push_back(test::open_cpu(i, 1));
  }
  test::SplitMix64 noise(20240607);
  std::size_t compared = 0, not_zero = 0;
  for (const auto& [n, pictures] :
       {std::pair(8, 400), {16, 200}, {32, 80}, {64, 40}, {128, 12}, {256, 6}, {512, 2}}) {
    for (int picture = 0; picture < pictures; ++picture) {
      const MetricSpec spec = random_walsh(n, noise);
      const int bits = picture % 2 == 0 ? 8 : 16;
      const std::string kinds[] = {"random", "all coefficients", "natural", "one coefficient"};
      const std::string& kind = kinds[picture / 2 % 4];
      const bool is_extreme = kind.ends_with("coefficient") || kind.ends_with("coefficients");
      const int margin = is_extreme ? 0 : static_cast<int>(noise.below(20));
      const test::Pixels pixels =
          is_extreme ? extreme_pixels(kind, bits, n, noise)
                     : test::make_pixels(kind, bits, n + margin, n + margin, noise.next());
      const Frame frame = test::to_frame(pixels);
      const Window window{margin / 2, margin / 3, n};
      const double expected = reference->plan(spec, 1)->score(frame, window);
      not_zero += expected > 0;
      for (const auto& device : devices) {
        test::Guarded<double> score(1);
        device->plan(spec, 1)->score(frame, {&window, 1}, score.span());
        EXPECT_TRUE(score.intact());
        ASSERT_TRUE(test::bit_equal(score[0], expected))
            << device->info().name << ", " << spec.text() << ", " << bits << " bits of " << kind
            << ", picture " << picture;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, devices.size() * 740);
  EXPECT_GT(not_zero, 500U) << "mostly zeros were compared";
}

}  // namespace
}  // namespace fathom
