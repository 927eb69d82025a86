// SPDX-License-Identifier: Apache-2.0
#include "tests/differential/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include "backends/backends.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::differential {
namespace {

using Scores = test::Guarded<double>;

/// Windows of a case that are scored one by one as well.
constexpr std::size_t kOneByOne = 8;
/// Nearer to the oracle than this, a score was not computed in single precision.
constexpr double kDouble = 1e-10;

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// One device's answers to a case.
struct Answer {
  std::string label;
  Scores scores;
  std::optional<Mismatch> fault;
};

class Examination {
 public:
  Examination(const Case& tested, Device& reference)
      : case_(tested),
        pixels_(tested.pixels()),
        frame_(pixels_, stride(tested), 0xA7, against(tested)),
        reference_(reference),
        values_(tested.spec.outputs()),
        tolerance_(tolerance_of(tested.spec)),
        grain_(test::quantisation(tested.spec)),
        grey_level_(test::one_grey_level(tested.spec)) {}

  void ask(const Examinee& examinee) {
    Answer answer{examinee.label, Scores(case_.windows.size() * values_), {}};
    try {
      const auto plan = examinee.device->plan(case_.spec, case_.windows.size());
      plan->score(frame_.frame(), case_.windows, answer.scores.span());
      if (!answer.scores.intact()) fault(answer, 0, "wrote outside its scores");
      require_repeats(*plan, answer);
    } catch (const std::exception& error) {
      fault(answer, 0, std::string("threw: ") + error.what());
    }
    answers_.push_back(std::move(answer));
  }

  /// Devices with each other, all windows; exact ones to the last bit, others as far as two errors
  /// of the tolerance reach. Whose fault it is, only the oracle knows: it looks at these first.
  void compare_devices() {
    suspicion_.assign(case_.windows.size(), 0);
    for (std::size_t a = 0; a < answers_.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) compare(answers_[a], answers_[b]);
    }
  }

  /// The oracle scores windows until its time is up; tallied where there is one for the label.
  void compare_with_oracle(double milliseconds, std::map<std::string, Tally>* tallies) {
    const auto plan = reference_.plan(case_.spec, 1);
    std::vector<std::size_t> order(case_.windows.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return suspicion_[a] > suspicion_[b]; });
    // After the suspects, some that nobody suspects.
    if (order.size() > 8)
      std::rotate(order.begin() + 4, order.begin() + order.size() / 2, order.end());
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::chrono::duration<double, std::milli> spent =
          std::chrono::steady_clock::now() - start;
      if (k >= 2 && spent.count() > milliseconds) break;
      std::vector<double> expected(values_);
      plan->score(frame_.frame(), {&case_.windows[order[k]], 1}, expected);
      for (std::size_t j = 0; j < values_; ++j)
        judge(order[k], order[k] * values_ + j, expected[j], tallies);
    }
  }

  std::vector<Mismatch> mismatches() const {
    std::vector<Mismatch> found;
    for (const Answer& answer : answers_) {
      if (answer.fault) found.push_back(*answer.fault);
    }
    // Devices that disagree by more than both may be off, and the oracle blames neither: say so.
    if (found.empty() && disagreement_) found.push_back(*disagreement_);
    return found;
  }

 private:
  static std::size_t stride(const Case& tested) {
    return static_cast<std::size_t>(tested.crop.width) * (tested.bits / 8) + tested.gap;
  }
  static test::GuardedFrame::Against against(const Case& tested) {
    return tested.seed % 2 == 0 ? test::GuardedFrame::Against::end
                                : test::GuardedFrame::Against::start;
  }

  static void fault(Answer& answer, std::size_t window, std::string what) {
    if (!answer.fault) answer.fault = {answer.label, window, std::move(what)};
  }

  void require_repeats(Plan& plan, Answer& answer) {
    Scores again(case_.windows.size() * values_);
    plan.score(frame_.frame(), case_.windows, again.span());
    for (std::size_t i = 0; i < again.size(); ++i) {
      if (!same(again[i], answer.scores[i])) {
        return fault(answer, i / values_,
                     fmt::format("{} the first time, {} the second", answer.scores[i], again[i]));
      }
    }
    const std::size_t step = std::max<std::size_t>(1, case_.windows.size() / kOneByOne);
    std::vector<double> alone(values_);
    for (std::size_t i = 0; i < case_.windows.size(); i += step) {
      plan.score(frame_.frame(), {&case_.windows[i], 1}, alone);
      for (std::size_t j = 0; j < values_; ++j) {
        const double together = answer.scores[i * values_ + j];
        if (same(alone[j], together)) continue;
        return fault(answer, i, fmt::format("{} in the batch, {} alone", together, alone[j]));
      }
    }
  }

  void compare(Answer& a, Answer& b) {
    if (a.fault || b.fault) return;
    for (std::size_t i = 0; i < a.scores.size(); ++i) {
      const test::Target target = target_of(b.scores[i], 0);
      const double error = std::abs(a.scores[i] - target.score) / target.scale;
      double& suspicion = suspicion_[i / values_];
      suspicion = std::isfinite(error) ? std::max(suspicion, error) : HUGE_VAL;
      const bool agree = tolerance_ == 0 ? bool(test::bit_equal(a.scores[i], b.scores[i]))
                                         : error <= 2 * tolerance_;
      // A band's errors follow the whole moment, which the oracle alone tells.
      if (agree || disagreement_ || (case_.spec.band && !is_rings())) continue;
      disagreement_ = {a.label, i / values_,
                       fmt::format("{} but {} by {}", a.scores[i], b.scores[i], b.label)};
    }
  }

  bool is_rings() const { return case_.spec.measure == Measure::rings; }

  static double tolerance_of(const MetricSpec& spec) {
    if (spec.is_exact()) return 0;
    return spec.measure == Measure::rings ? test::kRingTolerance : test::score_tolerance(spec);
  }

  /// least: what a moment's error is relative to where the moment is smaller.
  test::Target target_of(double expected, double least) const {
    test::Target target(expected, grey_level_, least);
    if (is_rings()) {
      target.score = expected;
      target.scale = std::abs(expected) + grain_;
    }
    return target;
  }

  double whole_score(std::size_t window, const MetricSpec& whole) {
    if (!whole_) whole_ = reference_.plan(whole, 1);
    return whole_->score(frame_.frame(), case_.windows[window]);
  }

  /// place: of the window's value in the scores.
  void judge(std::size_t i, std::size_t place, double expected,
             std::map<std::string, Tally>* tallies) {
    const double least = tolerance_ == 0 || is_rings()
                             ? 0
                             : test::least_scale(case_.spec, [&](const MetricSpec& whole) {
                                 return whole_score(i, whole);
                               });
    const test::Target target = target_of(expected, least);
    for (Answer& answer : answers_) {
      const double got = answer.scores[place];
      const bool matches = tolerance_ == 0
                               ? bool(test::bit_equal(got, expected))
                               : bool(test::within(got, target.score, tolerance_ * target.scale));
      if (!matches) {
        const double error = std::abs(got - target.score) / (target.scale * tolerance_);
        fault(answer, i,
              fmt::format("{:.17g}, the reference {:.17g}: {}", got, expected,
                          tolerance_ == 0 ? "exact scores are equal to the last bit"
                                          : fmt::format("{:.3f} tolerances off", error)));
      }
      if (tallies != nullptr && tolerance_ > 0) {
        tally(i, std::abs(got - target.score) / target.scale, (*tallies)[answer.label]);
      }
    }
  }

  void tally(std::size_t i, double error, Tally& tally) const {
    ++tally.judged;
    if (error < kDouble) ++tally.as_good_double;
    if (error / tolerance_ <= tally.worst) return;
    tally.worst = error / tolerance_;
    Case alone = case_;
    alone.windows = {case_.windows[i]};
    tally.worst_case = alone.text();
  }

  const Case& case_;
  test::Pixels pixels_;
  test::GuardedFrame frame_;
  Device& reference_;
  std::size_t values_;  ///< Of a window.
  double tolerance_, grain_, grey_level_;
  std::unique_ptr<Plan> whole_;  ///< The oracle's, without the band.
  std::vector<Answer> answers_;
  std::vector<double> suspicion_;  ///< [window] largest relative difference of two devices.
  std::optional<Mismatch> disagreement_;
};

std::shared_ptr<Device> open_reference() {
  for (const Backend* backend : all_backends()) {
    if (backend->name() == std::string("reference")) return backend->open(0, {});
  }
  throw std::runtime_error("this build has no reference backend to compare with");
}

}  // namespace

std::vector<Examinee> all_examinees(const std::function<void(const std::string&)>& tell) {
  std::vector<Examinee> found;
  for (const Backend* backend : all_backends()) {
    if (backend->name() == std::string("reference")) continue;
    const std::size_t count = std::max<std::size_t>(1, backend->devices().size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string label = fmt::format("{}:{}", backend->name(), i);
      try {
        found.push_back({label, backend->open(i, {})});
      } catch (const std::exception& error) {
        tell(fmt::format("{} is NOT TESTED: {}", label, error.what()));
      }
    }
  }
  return found;
}

Judge::Judge(std::vector<Examinee> examinees, double reference_ms)
    : examinees_(std::move(examinees)), reference_(open_reference()), reference_ms_(reference_ms) {}

std::vector<Mismatch> Judge::examine(const Case& tested) {
  Examination examination(tested, *reference_);
  for (const Examinee& examinee : examinees_) {
    Tally& tally = tallies_[examinee.label];
    const std::string reason = examinee.device->unsupported(tested.spec);
    if (!reason.empty()) {
      tally.declined[reason].insert(tested.spec.text());
      continue;
    }
    ++tally.cases;
    tally.windows += tested.windows.size();
    examination.ask(examinee);
  }
  examination.compare_devices();
  examination.compare_with_oracle(reference_ms_, &tallies_);
  return examination.mismatches();
}

std::vector<Mismatch> Judge::examine_alone(const Case& tested, const std::string& label) {
  Examination examination(tested, *reference_);
  for (const Examinee& examinee : examinees_) {
    if (examinee.label != label || !examinee.device->unsupported(tested.spec).empty()) continue;
    examination.ask(examinee);
  }
  examination.compare_devices();
  examination.compare_with_oracle(HUGE_VAL, nullptr);
  return examination.mismatches();
}

}  // namespace fathom::differential
