// SPDX-License-Identifier: Apache-2.0
// Recordings with several pictures at a position: their mean is scored, and they teach how far a
// score repeats.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/file.hpp"
#include "pictures/picture.hpp"
#include "session/session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom {
namespace {

constexpr int kSide = 16, kPositions = 4, kRepeats = 3;

class Repeats : public testing::Test {
 protected:
  Repeats() {
    std::string many = "file,position\n", single = "file,position\n";
    for (int p = 0; p < kPositions; ++p) {
      for (int k = 0; k < kRepeats; ++k) {
        const std::string name = fmt::format("{}_{}.png", p, k);
        write_picture(folder_ / "many" / name, picture(p));
        many += fmt::format("{},{}\n", name, p);
        single += fmt::format("../many/{},{}\n", name, p * kRepeats + k);
      }
    }
    write_file(folder_ / "many" / "manifest.csv", many);
    write_file(folder_ / "single" / "manifest.csv", single);
  }

  Frame picture(int position) {
    std::normal_distribution<double> noise(0, 3);
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double stripes = (i / 2 % 2 == 0 ? 1 : -1) * (20.0 + 10 * position);
      pixels.push_back(static_cast<std::uint8_t>(std::lround(120 + stripes + noise(random_))));
    }
    return Frame(kSide, kSide, std::move(pixels));
  }

  Rig rig(const char* name) {
    RigOptions options;
    options.rig = "replay:" + (folder_ / name).string();
    options.metric = "fft:16";
    options.backend = "reference";
    return Rig(options);
  }

  test::TemporaryFolder folder_;
  std::mt19937 random_{3};
};

TEST_F(Repeats, TheMeanOfAPositionIsScored) {
  Rig many = rig("many");
  FrameAverage mean;
  for (int k = 0; k < kRepeats; ++k)
    mean.add(read_picture(folder_ / "many" / fmt::format("2_{}.png", k)));
  EXPECT_EQ(many.measure(2).score, many.score(mean.mean()));
}

TEST_F(Repeats, TheirScatterIsThatOfMeansPooledOverPositions) {
  Rig single = rig("single");
  double squares = 0;
  for (int p = 0; p < kPositions; ++p) {
    double sum = 0, sum_of_squares = 0;
    for (int k = 0; k < kRepeats; ++k) {
      const double score = single.measure(p * kRepeats + k).sample().score;
      sum += score;
      sum_of_squares += score * score;
    }
    const double mean = sum / kRepeats;
    squares += (sum_of_squares - sum * mean) / (kRepeats - 1) / (mean * mean);
  }
  const double expected = std::sqrt(squares / kPositions / kRepeats);
  Observer nobody;
  Rig many = rig("many");
  const fathom::Run run = Session(many).focus({}, nobody);
  EXPECT_NEAR(run.repeat_scatter, expected, 1e-6 * expected);
  EXPECT_EQ(single.recorded_scatter(0, 100), 0) << "no position has two";
}

}  // namespace
}  // namespace fathom
