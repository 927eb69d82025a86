// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/spectral_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>

#include "engine/error.hpp"
#include "focus/blur_fit.hpp"
#include "focus/focus.hpp"
#include "focus/spectral_search.hpp"
#include "session/ring_reader.hpp"

namespace fathom {
namespace {

/// So many parts of a stack are asked at most.
constexpr int kMostParts = 32;

class SpectralMethod {
 public:
  SpectralMethod(const MetricSpec& spec, const std::string& backend, const DeviceOptions& options)
      : scorer_(stack_scorer(spec, backend, options)) {}

  StackAnswer find(const WindowStack& stack) {
    const std::vector<Evaluation> evaluations = looked_at(stack);
    if (!blur_) {
      const auto fit = fit_blur(evaluations, {.focus = {}, .a_side = 1});
      if (!fit) return {};
      blur_ = fit->model;
    }
    return answer_of(best_fit(evaluations), evaluations);
  }

 private:
  std::vector<Evaluation> looked_at(const WindowStack& stack) {
    const std::vector<double> powers = numbers_of(scorer_, stack);
    std::vector<Evaluation> evaluations;
    for (std::size_t i = 0; i < stack.size(); ++i) {
      const auto rings = std::span(powers).subspan(i * scorer_.outputs(), scorer_.outputs());
      Evaluation one{.loop = static_cast<int>(i) + 1, .position = stack.positions()[i]};
      one.picture.light = stack.lights()[i];
      one.picture.rings.push_back({stack.n(), {rings.begin(), rings.end()}});
      evaluations.push_back(std::move(one));
    }
    std::ranges::stable_sort(evaluations, {}, &Evaluation::position);
    return evaluations;
  }

  /// The law holds near a focus: each part of the stack is asked, and the surest one answers.
  SpectralFit best_fit(const std::vector<Evaluation>& evaluations) const {
    FocusLimits limits;
    limits.from = limits.lowest = evaluations.front().position;
    limits.to = limits.highest = evaluations.back().position;
    limits.blur = blur_;
    const double part = blur_->units(scorer_.spec().n / 8.0);
    const int parts =
        std::clamp(static_cast<int>(std::ceil((limits.to - limits.from) / part)), 1, kMostParts);
    SpectralFit best;
    for (int i = 0; i < parts; ++i) {
      const double here = limits.from + (i + 0.5) * (limits.to - limits.from) / parts;
      const SpectralFit fit = fit_all(evaluations, here, limits);
      if (fit.pictures > 0 &&
          std::tuple(is_sure(fit), fit.evidence) > std::tuple(is_sure(best), best.evidence))
        best = fit;
    }
    return best;
  }

  static StackAnswer answer_of(const SpectralFit& fit, const std::vector<Evaluation>& evaluations) {
    StackAnswer answer;
    answer.low = evaluations.front().position;
    answer.high = evaluations.back().position;
    answer.stands_out = is_sure(fit);
    answer.is_at_end = fit.position <= answer.low || fit.position >= answer.high;
    answer.peak.position = fit.position;
    answer.peak.sigma = fit.sigma;
    answer.maxima = fit.pictures == 0 ? 0 : answer.stands_out ? 1 : 2;  // a sure fit has no rival
    return answer;
  }

  Scorer scorer_;
  std::optional<BlurModel> blur_;
};

}  // namespace

FocusMethod spectral_method(int n, const std::string& backend, const DeviceOptions& options) {
  if (rings_of_side(n) == 0) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} looks at rings of a spectrum, and windows of {} x {} have too few; "
                            "name a larger --window",
                            kSpectralMethod, n, n));
  }
  auto method = std::make_shared<SpectralMethod>(rings_metric(n), backend, options);
  return {kSpectralMethod,
          [method](const WindowStack& stack, double) { return method->find(stack); }};
}

}  // namespace fathom
