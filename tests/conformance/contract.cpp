// SPDX-License-Identifier: Apache-2.0
// What engine/backend.hpp promises besides numbers: tickets, refusals, and that plans leave each
// other alone.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "engine/error.hpp"
#include "tests/conformance/suite.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

using test::bit_equal;
using test::expect_error;
using test::Guarded;

class Contract : public Conformance {};
FATHOM_EVERY_DEVICE(Contract);

const std::vector<std::string> kSpecs = {"fft:16:hann", "fft:32:none:power", "walsh-sequency:16",
                                         "walsh-paley:32:hann"};

/// A batch of its own frame, windows and scores.
struct Batch {
  Batch(const Case& tested, int number)
      : frame(test::make_frame(tested.content, tested.bits, 2 * tested.spec.n + number, 70,
                               tested.seed + number)),
        windows(window_grid(frame.width_px(), frame.height_px(), {0, 0, tested.spec.n}, 7)),
        scores(windows.size()) {}

  void expect_scores(Plan& plan) {
    EXPECT_TRUE(scores.intact());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      ASSERT_GT(scores[i], 0);
      ASSERT_TRUE(bit_equal(scores[i], plan.score(frame, windows[i]))) << "window " << i;
    }
  }

  Frame frame;
  std::vector<Window> windows;
  Guarded<double> scores;
};

std::vector<Batch> batches(const Case& tested, int count) {
  std::vector<Batch> made;
  for (int i = 0; i < count; ++i) made.emplace_back(tested, i);
  return made;
}

TEST_P(Contract, BatchesInFlightMayBeWaitedForInAnyOrder) {
  each(cases(kSpecs, {"random8", "natural16"}), 200, [&](const Case& tested, Plan& plan) {
    auto flights = batches(tested, 5);
    std::vector<Plan::Ticket> tickets;
    for (Batch& flight : flights) {
      tickets.push_back(plan.submit(flight.frame, flight.windows, flight.scores.span()));
    }
    for (const int i : {3, 0, 4, 2, 1}) plan.wait(tickets[i]);
    for (const auto& ticket : tickets) plan.wait(ticket);  // again: at once
    for (Batch& flight : flights) flight.expect_scores(plan);
  });
}

TEST_P(Contract, AnythingMayHappenBetweenSubmitAndWait) {
  each(cases(kSpecs, {"random8"}), 200, [&](const Case& tested, Plan& plan) {
    auto flights = batches(tested, 2);
    const auto first = plan.submit(flights[0].frame, flights[0].windows, flights[0].scores.span());
    Guarded<std::complex<double>> spectrum(static_cast<std::size_t>(tested.spec.n) * tested.spec.n);
    plan.spectrum(flights[1].frame, flights[1].windows[0], spectrum.span());
    plan.score(flights[1].frame, flights[1].windows, flights[1].scores.span());
    expect_error(ErrorCode::out_of_bounds, [&] {
      plan.score(flights[0].frame, {-1, 0, tested.spec.n});
    });
    const auto empty = plan.submit(flights[0].frame, {}, {});
    plan.wait(empty);
    plan.wait(first);
    for (Batch& flight : flights) flight.expect_scores(plan);
  });
}

// Unwinding from an error must not let a device write into what is already gone.
TEST_P(Contract, APlanMayEndWithBatchesInFlight) {
  each(cases(kSpecs, {"random8"}), 1, [&](const Case& tested, Plan&) {
    auto flights = batches(tested, 3);
    {
      const auto brief = plan(tested.spec, 200);
      for (Batch& flight : flights) {
        brief->submit(flight.frame, flight.windows, flight.scores.span());
      }
    }
    for (Batch& flight : flights) EXPECT_TRUE(flight.scores.intact());
  });
}

TEST_P(Contract, PlansOfOneDeviceDoNotDisturbEachOther) {
  each(cases(kSpecs, {"random8"}), 200, [&](const Case& tested, Plan& plan) {
    MetricSpec other_spec = MetricSpec::parse("walsh-sequency:8");
    if (!device().unsupported(other_spec).empty()) other_spec = tested.spec;
    const auto other = this->plan(other_spec, 200);
    Batch mine(tested, 0), others({other_spec, "natural", 16, 3}, 1);
    const auto a = plan.submit(mine.frame, mine.windows, mine.scores.span());
    const auto b = other->submit(others.frame, others.windows, others.scores.span());
    plan.wait(a);
    other->wait(b);
    mine.expect_scores(plan);
    others.expect_scores(*other);
  });
}

TEST_P(Contract, PlansOfOneDeviceServeAThreadEach) {
  each(cases(kSpecs, {"random8"}), 200, [&](const Case& tested, Plan&) {
    auto work = batches(tested, 2);
    std::vector<std::unique_ptr<Plan>> plans;
    for (int i = 0; i < 2; ++i) plans.push_back(plan(tested.spec, 200));
    std::vector<std::thread> threads;
    for (int i = 0; i < 2; ++i) {
      threads.emplace_back([&, i] {
        for (int round = 0; round < 3; ++round) {
          plans[i]->score(work[i].frame, work[i].windows, work[i].scores.span());
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (int i = 0; i < 2; ++i) work[i].expect_scores(*plans[i]);
  });
}

TEST_P(Contract, CapacityIsWhatWasAskedForAndOneMoreIsRefused) {
  each(cases(kSpecs, {"random8"}), 7, [&](const Case& tested, Plan& plan) {
    EXPECT_EQ(plan.capacity(), 7U);
    EXPECT_EQ(plan.spec(), tested.spec);
    const Frame frame = tested.frame();
    const std::vector<Window> windows(8, Window{0, 0, tested.spec.n});
    Guarded<double> scores(8);
    expect_error(ErrorCode::bad_argument, [&] { plan.score(frame, windows, scores.span()); },
                 {"8", "7"});
    for (const double score : scores.span())
      EXPECT_TRUE(std::isnan(score)) << "refused, yet written";
    plan.score(frame, std::span(windows).first(7), scores.span().first(7));
    for (std::size_t i = 0; i < 7; ++i) EXPECT_GT(scores[i], 0);
    EXPECT_TRUE(std::isnan(scores[7]) && scores.intact());
  });
}

TEST_P(Contract, AnEmptyBatchIsDone) {
  each(cases(kSpecs, {"random8"}), 3, [&](const Case& tested, Plan& plan) {
    const Frame frame = tested.frame();
    plan.score(frame, {}, {});
    plan.wait(plan.submit(frame, {}, {}));
    EXPECT_GT(plan.score(frame, {0, 0, tested.spec.n}), 0);
  });
}

TEST_P(Contract, BadRequestsAreRefusedAndHarmNothing) {
  each(cases(kSpecs, {"random8"}), 4, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const Frame frame = tested.frame(3 * n, 2 * n);
    const Window good{1, 1, n};
    const double before = plan.score(frame, good);
    Guarded<double> scores(2);
    const auto refuse = [&](ErrorCode code, const Frame& picture, const Window& window) {
      const std::vector<Window> windows = {good, window};
      expect_error(code, [&] { plan.score(picture, windows, scores.span()); });
    };
    for (const auto& [x, y] : {std::pair(2 * n + 1, 0),
                               {0, n + 1},
                               {-1, 0},
                               {0, -1},
                               {2147483647, 0},
                               {0, -2147483647 - 1}}) {
      refuse(ErrorCode::out_of_bounds, frame, {x, y, n});
    }
    refuse(ErrorCode::bad_argument, frame, {0, 0, n / 2});
    refuse(ErrorCode::bad_argument, frame, {0, 0, 0});
    refuse(ErrorCode::bad_argument, frame, {0, 0, n + 1});
    refuse(ErrorCode::bad_argument, Frame(), good);
    const std::vector<Window> one = {good};
    expect_error(ErrorCode::bad_argument, [&] { plan.score(frame, one, scores.span()); });
    expect_error(ErrorCode::bad_argument, [&] { plan.score(frame, one, {}); });
    expect_error(ErrorCode::bad_argument, [&] { plan.wait({0}); });
    expect_error(ErrorCode::bad_argument, [&] { plan.wait({1000000}); });
    for (const double score : scores.span())
      EXPECT_TRUE(std::isnan(score)) << "refused, yet written";
    EXPECT_TRUE(scores.intact());
    EXPECT_TRUE(bit_equal(plan.score(frame, good), before)) << "the plan no longer works";
  });
}

TEST_P(Contract, BadSpectraAreRefused) {
  each(cases(kSpecs, {"random8"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const Frame frame = tested.frame();
    Guarded<std::complex<double>> room(static_cast<std::size_t>(n) * n);
    const auto refuse = [&](ErrorCode code, const Frame& picture, const Window& window,
                            std::size_t size) {
      expect_error(code, [&] { plan.spectrum(picture, window, room.span().first(size)); });
    };
    refuse(ErrorCode::out_of_bounds, frame, {1, 0, n}, room.size());
    refuse(ErrorCode::bad_argument, frame, {0, 0, n / 2}, room.size());
    refuse(ErrorCode::bad_argument, frame, {0, 0, n}, room.size() - 1);
    refuse(ErrorCode::bad_argument, frame, {0, 0, n}, 0);
    refuse(ErrorCode::bad_argument, Frame(), {0, 0, n}, room.size());
    EXPECT_TRUE(std::isnan(room[0].real()) && room.intact());
  });
}

/// What the call came to in a child of this process: its answer, or 100 for none.
int in_child(const std::function<int()>& call) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);  // a device that waits for threads of the parent waits for ever
    ::_exit(call());
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : 100;
}

// In the child the CPU computes on, and a GPU says that it is the parent's; neither waits for ever.
TEST_P(Contract, AChildOfAForkHangsNowhere) {
  const MetricSpec spec = MetricSpec::parse("walsh-sequency:16");
  if (!device().unsupported(spec).empty()) GTEST_SKIP() << "declined";
  const Case tested{spec, "random", 8, 5};
  Batch batch(tested, 1);
  auto plan = this->plan(spec, 200);
  plan->score(batch.frame, batch.windows, batch.scores.span());
  const std::span<const double> first = batch.scores.span();
  const std::vector<double> scores(first.begin(), first.end());
  constexpr int kSame = 1, kOther = 2, kRefused = 3, kElse = 4;
  const int came_to = in_child([&] {
    try {
      std::vector<double> again(scores.size());
      plan->score(batch.frame, batch.windows, again);
      return again == scores ? kSame : kOther;
    } catch (const Error& error) {
      plan.reset();
      return error.code() == ErrorCode::device_lost ? kRefused : kElse;
    }
  });
  EXPECT_EQ(came_to, GetParam().backend->is_for_gpus() ? kRefused : kSame);
  batch.expect_scores(*plan);
}

TEST_P(Contract, TwoThreadsOnOnePlanGetRightNumbersOrARefusal) {
  const MetricSpec spec = MetricSpec::parse("walsh-sequency:16");
  if (!device().unsupported(spec).empty()) GTEST_SKIP() << "declined";
  Batch batch({spec, "random", 8, 5}, 1);
  const auto plan = this->plan(spec, 200);
  plan->score(batch.frame, batch.windows, batch.scores.span());
  const std::span<const double> first = batch.scores.span();
  const std::vector<double> scores(first.begin(), first.end());
  std::atomic<int> wrong = 0;
  const auto use = [&] {
    std::vector<double> again(scores.size());
    for (int round = 0; round < 50; ++round) {
      try {
        plan->score(batch.frame, batch.windows, again);
        wrong += again != scores;
      } catch (const Error& error) {
        wrong += error.code() != ErrorCode::bad_argument;
      }
    }
  };
  std::thread other(use);
  use();
  other.join();
  EXPECT_EQ(wrong, 0);
  batch.expect_scores(*plan);
}

TEST_P(Contract, BadPlansAreRefused) {
  const MetricSpec good = MetricSpec::parse("fft:64");
  if (device().unsupported(good).empty()) {
    expect_error(ErrorCode::bad_argument, [&] { plan(good, 0); });
  }
  MetricSpec odd = good, wild = good, band = good, paley = MetricSpec::parse("walsh-paley:64");
  odd.n = 65;
  wild.taper.cosine_fraction = std::nan("");
  band.band = Band{0.5, 0.1};
  paley.band = Band{0, 0.25};
  for (const MetricSpec& spec : {odd, wild, band, paley}) {
    expect_error(ErrorCode::bad_argument, [&] { plan(spec, 1); });
  }
}

/// Every metric that the project demands: each transform, side, taper and option.
std::vector<std::string> demanded_specs() {
  std::vector<std::string> specs;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    for (const char* transform : {"fft", "walsh-paley", "walsh-sequency", "walsh-hadamard"}) {
      const bool has_band =
          transform != std::string("walsh-paley") && transform != std::string("walsh-hadamard");
      for (const char* taper : {"none", "hann", "tukey=0.25"}) {
        for (const char* options : {"", ":power", ":band=0-0.25", ":power:band=0-0.25"}) {
          if (std::string(options).find("band") != std::string::npos && !has_band) continue;
          specs.push_back(std::string(transform) + ":" + std::to_string(n) + ":" + taper + options);
        }
      }
    }
  }
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    for (const char* options : {"", ":power", ":band=0-0.25", ":entropy", ":entropy:band=0-0.25"})
      specs.push_back("dct:" + std::to_string(n) + options);
  }
  return specs;
}

// each() counts what is declined and the report at the end prints it.
TEST_P(Contract, DeclinesWithAReasonOrMakesAPlan) {
  const auto demanded = cases(demanded_specs(), {"random8"});
  for (const Case& tested : demanded) {
    const std::string reason = device().unsupported(tested.spec);
    if (reason.empty()) continue;
    expect_error(ErrorCode::unsupported, [&] { plan(tested.spec, 1); },
                 {reason.c_str(), tested.spec.text().c_str()});
  }
  each(demanded, 1, [](const Case& tested, Plan& plan) { EXPECT_EQ(plan.spec(), tested.spec); });
}

TEST_P(Contract, TheOpenedDeviceIsTheOneListed) {
  EXPECT_EQ(device().info().name, GetParam().info.name);
  EXPECT_EQ(device().info().kind, GetParam().info.kind);
  EXPECT_FALSE(device().info().name.empty());
}

}  // namespace
}  // namespace fathom::conformance
