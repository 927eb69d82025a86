// SPDX-License-Identifier: Apache-2.0
// Cables are pulled while `fathom focus` runs, at moments that fixed seeds choose. The program must
// end, say what is gone, leave nothing moving that it can still stop, and believe nothing wrong: no
// score that its place does not have, no focus that is none, no place where the lens is not.
//
//   FATHOM_PULLS=200 pulls_test                         so many, in place of ten
//   FATHOM_FIRST_PULL=153 FATHOM_PULLS=1 pulls_test     one that failed, again
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include "hal/clock.hpp"
#include "program.hpp"
#include "pulled_desks.hpp"

namespace fathom::test {
namespace {

constexpr int kUsualPulls = 10;
/// Far beyond all timeouts together, on a busy machine too: what takes longer hangs.
constexpr const char* kOrElse = "timeout --signal=KILL 300";

int number_from(const char* variable, int fallback) {
  const char* const wished = std::getenv(variable);
  return wished == nullptr ? fallback : std::max(0, std::atoi(wished));
}

/// What an undisturbed run came to.
struct Undisturbed {
  std::map<double, double> scores;
  int pictures = 0;
  std::int64_t took_ns = 0;
};

/// When a cable is pulled: after a picture has been begun, and a part of the time that one takes. A
/// machine may be slower at one time than at another; the moment is the same.
struct Moment {
  int picture = 0;
  double part = 0;
};

struct Counts {
  int pulled = 0, ended_before = 0, scores_compared = 0;
  double slowest_s = 0;  ///< From the pull to the program's end.
};

class Pulls : public Program {
 protected:
  /// With the lens's blur told: it would be learned, and the next search would go another way.
  static std::string focus_command(const PulledDesk& desk) {
    constexpr double kBlurOfStep_px = 0.08;
    return "focus --rig " + desk.rig() + " --json -o run.json --blur " +
           std::to_string(kBlurOfStep_px / desk.step());
  }

  const Undisturbed& undisturbed(Cable cable) {
    const auto known = undisturbed_.find(cable);
    if (known != undisturbed_.end()) return known->second;
    const auto desk = make_desk(cable, path(""));
    Undisturbed run;
    const std::int64_t begin_ns = monotonic_now_ns();
    const Outcome outcome = fathom(focus_command(*desk), kOrElse);
    run.took_ns = monotonic_now_ns() - begin_ns;
    EXPECT_EQ(outcome.status, 0) << name_of(cable) << ": " << outcome.err;
    expect_focus(*desk, outcome);
    run.scores = scores_of(outcome);
    run.pictures = desk->pictures();
    EXPECT_GT(run.scores.size(), 5u) << name_of(cable);
    return undisturbed_[cable] = run;
  }

  static std::map<double, double> scores_of(const Outcome& outcome) {
    std::map<double, double> scores;
    for (const auto& line : outcome.lines()) {
      if (line.contains("loop")) scores[line.at("position")] = line.at("score");
    }
    return scores;
  }

  static void expect_focus(const PulledDesk& desk, const Outcome& outcome) {
    const auto lines = outcome.lines();
    ASSERT_FALSE(lines.empty());
    ASSERT_EQ(lines.back().value("result", ""), "focused");
    EXPECT_NEAR(lines.back().at("position").get<double>(), desk.focus(), 3 * desk.step());
  }

  void expect_same_scores(Cable cable, const Outcome& outcome) {
    const auto& expected = undisturbed(cable).scores;
    for (const auto& [position, score] : scores_of(outcome)) {
      const auto found = expected.find(position);
      if (found == expected.end()) continue;
      EXPECT_NEAR(score, found->second, 1e-6 * found->second) << "at " << position;
      ++counts_[cable].scores_compared;
    }
  }

  Moment moment(Cable cable, int seed) {
    std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
    const int picture = std::uniform_int_distribution<>(0, undisturbed(cable).pictures - 1)(random);
    return {picture, std::uniform_real_distribution<>(0, 1)(random)};
  }

  void pull(Cable cable, const Moment& moment) {
    const Undisturbed& usual = undisturbed(cable);
    const auto wait_ns = static_cast<std::int64_t>(
        moment.part * static_cast<double>(usual.took_ns) / usual.pictures);
    const auto desk = make_desk(cable, path(""));
    const std::string rig_name = desk->name();
    std::int64_t pulled_ns = 0;
    std::atomic<bool> has_ended = false;
    std::thread puller([&] {
      while (desk->pictures() < moment.picture && !has_ended)
        sleep_until_ns(monotonic_now_ns() + 1'000'000);
      sleep_until_ns(monotonic_now_ns() + wait_ns);
      pulled_ns = monotonic_now_ns();
      desk->pull();
    });
    const Outcome outcome = fathom(focus_command(*desk), kOrElse);
    has_ended = true;
    const std::int64_t ended_ns = monotonic_now_ns();
    puller.join();
    Counts& counts = counts_[cable];
    ++counts.pulled;
    expect_same_scores(cable, outcome);
    EXPECT_EQ(desk->wrong_belief(), "");
    if (outcome.status == 0) {
      ++counts.ended_before;
      return expect_focus(*desk, outcome);
    }
    EXPECT_LT(pulled_ns, ended_ns) << "it failed before anything was pulled: " << outcome.err;
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_NE(outcome.err.find(rig_name), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out.find("\"result\""), std::string::npos) << outcome.out;
    counts.slowest_s = std::max(counts.slowest_s, static_cast<double>(ended_ns - pulled_ns) * 1e-9);
  }

  void say_counts() const {
    for (const auto& [cable, counts] : counts_) {
      std::printf(
          "%s: pulled %d times, %d of them after the focus was found; %d scores compared; "
          "the program ended %.1f s after the pull at most\n",
          name_of(cable), counts.pulled, counts.ended_before, counts.scores_compared,
          counts.slowest_s);
    }
  }

  std::map<Cable, Undisturbed> undisturbed_;
  std::map<Cable, Counts> counts_;
};

TEST_F(Pulls, AtAnyMomentEndInAReasonAndInNothingWrong) {
  const int first = number_from("FATHOM_FIRST_PULL", 0);
  const int end = first + number_from("FATHOM_PULLS", kUsualPulls);
  for (int i = first; i < end && !HasFailure(); ++i) {
    const Cable cable = kCables[static_cast<std::size_t>(i) % kCables.size()];
    const Moment when = moment(cable, i);
    SCOPED_TRACE(std::string(name_of(cable)) + ", pull " + std::to_string(i) + ", " +
                 std::to_string(when.part) + " of a picture's time after picture " +
                 std::to_string(when.picture));
    pull(cable, when);
  }
  say_counts();
}

}  // namespace
}  // namespace fathom::test
