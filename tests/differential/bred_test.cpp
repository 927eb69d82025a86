// SPDX-License-Identifier: Apache-2.0
// A picture that was bred for the error of its score: what no random drawing comes to.
#include <gtest/gtest.h>

#include "backends/backends.hpp"
#include "tests/differential/judge.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::differential {
namespace {

// Black, but for faint columns and a bright one where the taper is small; one of the pixels that a
// kernel may take for the typical grey level is bright. Single precision was 1.18 tolerances off.
const std::vector<std::uint8_t> kColumns = {
    // clang-format off
    0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 0, 37,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 5, 0, 9,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 58,
    0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 6, 0, 0,
    1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1, 62,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 1,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 3, 0, 45,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 20,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 26,
    0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 45,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 1, 5, 0, 3,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 61,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 5, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 37,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 0, 9,
    0, 0, 0, 0, 0, 0, 255, 0, 1, 1, 0, 0, 0, 5, 0, 33
    // clang-format on
};

TEST(Bred, PictureIsScoredWithinTheTolerance) {
  const Frame frame(16, 16, kColumns);
  const Window window{0, 0, 16};
  for (const char* metric : {"fft:16:hann:power", "fft:16:hann"}) {
    const MetricSpec spec = MetricSpec::parse(metric);
    // `reference` stands last in the table of backends.
    const double expected = all_backends().back()->open(0, {})->plan(spec, 1)->score(frame, window);
    for (const Examinee& examinee : all_examinees([](auto&&) {})) {
      if (!examinee.device->unsupported(spec).empty()) continue;
      const double got = examinee.device->plan(spec, 1)->score(frame, window);
      EXPECT_TRUE(test::score_matches(got, expected, spec, test::score_tolerance(spec)))
          << examinee.label << " " << metric;
    }
  }
}

}  // namespace
}  // namespace fathom::differential
