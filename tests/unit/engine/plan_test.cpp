// SPDX-License-Identifier: Apache-2.0
// What every plan does before its backend is asked.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "engine/backend.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/frames.hpp"

namespace fathom {
namespace {

/// Stays in a call until it is let go.
class SlowPlan final : public Plan {
 public:
  SlowPlan() : Plan(MetricSpec::parse("fft:8"), 1) {}

  std::atomic<bool> is_inside = false, may_go = false;

 private:
  void stay() {
    is_inside = true;
    is_inside.notify_all();
    may_go.wait(false);
  }
  void do_submit(std::uint64_t, const Frame&, std::span<const Window>, std::span<double>) override {
    stay();
  }
  void do_wait(std::uint64_t) override {}
  void do_spectrum(const Frame&, const Window&, std::span<std::complex<double>>) override {}
};

TEST(Plan, ASecondThreadIsRefusedWhileTheFirstIsInside) {
  const Frame frame = test::make_frame("natural", 8, 16, 16, 1);
  SlowPlan plan;
  std::thread first([&] { plan.score(frame, {0, 0, 8}); });
  plan.is_inside.wait(false);
  std::vector<std::complex<double>> spectrum(64);
  const auto refused = [](auto&& call) {
    test::expect_error(ErrorCode::bad_argument, call, {"a plan for each thread"});
  };
  refused([&] { plan.score(frame, {0, 0, 8}); });
  refused([&] { plan.submit(frame, {}, {}); });
  refused([&] { plan.wait({1}); });
  refused([&] { plan.spectrum(frame, {0, 0, 8}, spectrum); });
  plan.may_go = true;
  plan.may_go.notify_all();
  first.join();
  plan.score(frame, {0, 0, 8});  // one thread after the other is no trouble
  EXPECT_THROW(plan.score(frame, {-1, 0, 8}), Error);
  plan.score(frame, {0, 0, 8});  // nor is one after an error
}

}  // namespace
}  // namespace fathom
