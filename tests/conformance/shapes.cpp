// SPDX-License-Identifier: Apache-2.0
// Awkward shapes: a score depends on the window's pixels and on nothing around them, neither memory
// layout nor place nor batch, to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/conformance/suite.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

using test::bit_equal;
using test::Guarded;
using test::GuardedFrame;
using test::score_matches;

class Shapes : public Conformance {
 protected:
  /// Scores of a batch; fails if the plan wrote beside them.
  static std::vector<double> scores_of(Plan& plan, const Frame& frame,
                                       const std::vector<Window>& windows) {
    Guarded<double> scores(windows.size());
    plan.score(frame, windows, scores.span());
    EXPECT_TRUE(scores.intact()) << "score() wrote beyond its output";
    return {scores.span().begin(), scores.span().end()};
  }

  /// Typical and large metrics. The oracle has one way for all sizes, and takes seconds for large
  /// ones.
  static std::vector<std::string> specs_of_all_sizes() {
    std::vector<std::string> specs = typical_specs();
    if (GetParam().is_reference()) return specs;
    for (const std::string& spec : large_specs()) specs.push_back(spec);
    return specs;
  }

  static double score_of_copy(Plan& plan, const Frame& frame, const Window& window) {
    return plan.score(test::cropped(frame, window), {0, 0, window.n});
  }
};
FATHOM_EVERY_DEVICE(Shapes);

/// Windows at all four corners, along all four edges and in the middle.
std::vector<Window> windows_round_the_edge(const Frame& frame, int n) {
  std::vector<Window> windows;
  const int right = frame.width_px() - n, bottom = frame.height_px() - n;
  for (const int y : {0, bottom / 2, bottom}) {
    for (const int x : {0, right / 2, right}) windows.push_back({x, y, n});
  }
  return windows;
}

TEST_P(Shapes, WindowsAtEveryEdgeAndCorner) {
  each(cases(specs_of_all_sizes(), {"random8", "natural16"}), 9,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const Frame frame = tested.frame(2 * n + 5, n + 9);
         const auto windows = windows_round_the_edge(frame, n);
         const auto scores = scores_of(plan, frame, windows);
         const auto reference = oracle(tested.spec);
         for (std::size_t i = 0; i < windows.size(); ++i) {
           SCOPED_TRACE("window " + to_string(windows[i]));
           EXPECT_TRUE(bit_equal(scores[i], score_of_copy(plan, frame, windows[i])));
           // The corners and the middle; of large windows the last corner will do.
           if (i % 4 == 0 && (n <= 64 || i == 8)) {
             const double expected = reference->score(frame, windows[i]);
             ASSERT_GT(expected, 0);
             EXPECT_TRUE(score_matches(scores[i], expected, tested.spec, tolerance(tested.spec)));
           }
         }
       });
}

TEST_P(Shapes, AFrameOfJustOneWindow) {
  each(cases(specs_of_all_sizes(), {"natural8", "random16"}), 1,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const GuardedFrame exact(tested.pixels(n, n), n * (tested.bits / 8), 0);
         EXPECT_TRUE(bit_equal(plan.score(exact.frame(), {0, 0, n}),
                               score_of_copy(plan, exact.frame(), {0, 0, n})));
       });
}

// Rows any number of bytes apart, 16-bit rows on odd addresses, and whatever bytes between them;
// the picture ends, or begins, where the memory does.
TEST_P(Shapes, OddStridesAndUnalignedRows) {
  each(cases(specs_of_all_sizes(), {"random8", "random16"}), 9,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const test::Pixels pixels = tested.pixels(n + 3, n + 2);
         const Frame packed = test::to_frame(pixels);
         const auto windows = windows_round_the_edge(packed, n);
         const auto expected = scores_of(plan, packed, windows);
         const std::size_t row_bytes = packed.stride_bytes();
         for (const std::size_t gap : {0, 1, 3, 61}) {
           for (const std::uint8_t padding : {std::uint8_t{0x00}, std::uint8_t{0xff}}) {
             for (const auto against : {GuardedFrame::Against::end, GuardedFrame::Against::start}) {
               const GuardedFrame guarded(pixels, row_bytes + gap, padding, against);
               const auto scores = scores_of(plan, guarded.frame(), windows);
               for (std::size_t i = 0; i < windows.size(); ++i) {
                 ASSERT_TRUE(bit_equal(scores[i], expected[i]))
                     << gap << " bytes of " << int{padding} << " between rows, window "
                     << to_string(windows[i]);
               }
             }
           }
         }
       });
}

TEST_P(Shapes, SpectraOfUnalignedRows) {
  each(cases(specs_of_all_sizes(), {"random16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const GuardedFrame guarded(tested.pixels(n + 1, n + 1), 2 * (n + 1) + 1, 0xff);
    Guarded<std::complex<double>> got(static_cast<std::size_t>(n) * n), expected(got.size());
    plan.spectrum(guarded.frame(), {1, 1, n}, got.span());
    plan.spectrum(test::cropped(guarded.frame(), {1, 1, n}), {0, 0, n}, expected.span());
    EXPECT_TRUE(got.intact() && expected.intact());
    EXPECT_TRUE(test::spectrum_matches(got.span(), expected.span(), 0));
  });
}

/// A prime number of windows that overlap, some of them twice.
std::vector<Window> overlapping_windows(int count, int n, const Frame& frame) {
  std::vector<Window> windows;
  for (int i = 0; i < count; ++i) {
    windows.push_back(
        {(i * 7) % (frame.width_px() - n + 1), (i * 3) % (frame.height_px() - n + 1), n});
  }
  windows[count / 2] = windows[0];
  windows[count - 1] = windows[0];
  return windows;
}

TEST_P(Shapes, AScoreDoesNotDependOnItsBatch) {
  std::vector<std::string> specs = {"fft:8:hann",        "fft:16:none:power",
                                    "fft:32:hann",       "fft:64:hann",
                                    "walsh-paley:16",    "walsh-sequency:32:band=0-0.25",
                                    "walsh-sequency:64", "walsh-hadamard:8:hann"};
  if (!GetParam().is_reference()) {
    for (const std::string& spec : large_specs()) specs.push_back(spec);
  }
  each(cases(specs, {"random8", "natural16"}), 131, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n, count = n <= 32 ? 131 : 23;
    const Frame frame = tested.frame(n + 29, n + 21);
    auto windows = overlapping_windows(count, n, frame);
    const auto together = scores_of(plan, frame, windows);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      ASSERT_GT(together[i], 0) << "window " << i;
      ASSERT_TRUE(bit_equal(scores_of(plan, frame, {windows[i]})[0], together[i]))
          << "alone and in a batch of " << count << ", window " << i;
    }
    const std::vector<Window> part(windows.begin() + 1, windows.begin() + 18);
    const auto partly = scores_of(plan, frame, part);
    for (std::size_t i = 0; i < part.size(); ++i) {
      EXPECT_TRUE(bit_equal(partly[i], together[i + 1])) << "in a batch of 17, window " << i + 1;
    }
    std::reverse(windows.begin(), windows.end());
    auto backwards = scores_of(plan, frame, windows);
    std::reverse(backwards.begin(), backwards.end());
    EXPECT_EQ(backwards, together) << "in reverse order";
  });
}

// More windows than a GPU dispatches at once along one axis (65535 in Vulkan), and a prime.
TEST_P(Shapes, ABatchOver65535Windows) {
  constexpr int kCount = 65537;
  each(cases({"fft:8:hann", "walsh-sequency:8"}, {"random8"}), kCount,
       [&](const Case& tested, Plan& plan) {
         const Frame frame = tested.frame(24, 23);
         const auto places = window_grid(24, 23, {0, 0, 8}, 1);
         std::vector<Window> windows(kCount);
         for (std::size_t i = 0; i < kCount; ++i) windows[i] = places[i % places.size()];
         const auto scores = scores_of(plan, frame, windows);
         const auto expected = scores_of(plan, frame, places);
         for (std::size_t i = 0; i < kCount; ++i) {
           ASSERT_TRUE(bit_equal(scores[i], expected[i % places.size()])) << "window " << i;
         }
       });
}

TEST_P(Shapes, TheSameTwiceAndFromAnotherPlan) {
  each(cases(specs_of_all_sizes(), {"random8", "natural16"}), 9,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const Frame frame = tested.frame(n + 11, n + 7);
         const auto windows = windows_round_the_edge(frame, n);
         const auto first = scores_of(plan, frame, windows);
         const auto between =
             scores_of(plan, test::make_frame("binary", 8, n + 30, n, 5), {{30, 0, n}});
         EXPECT_GT(between[0], 0);
         const auto again = scores_of(plan, frame, windows);
         const auto other = scores_of(*this->plan(tested.spec, 1000), frame, windows);
         for (std::size_t i = 0; i < windows.size(); ++i) {
           EXPECT_TRUE(bit_equal(again[i], first[i])) << "run to run";
           EXPECT_TRUE(bit_equal(other[i], first[i])) << "plan to plan";
         }
       });
}

}  // namespace
}  // namespace fathom::conformance
