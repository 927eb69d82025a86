// SPDX-License-Identifier: Apache-2.0
// Ways to find the focus in a stack of pictures that was taken already.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/scorer.hpp"
#include "focus/curve.hpp"
#include "focus/peak.hpp"
#include "tools/fathom/window_stack.hpp"

namespace fathom {

/// What a method made of a stack. Positions in the lens's unit.
struct StackAnswer {
  bool stands_out = false;  ///< Whether there is a peak that noise alone would not make,
  bool is_at_end = false;   ///< and whether it is at an end of the stack, so that no focus is seen.
  Peak peak;                ///< The highest.
  FocusCurve curve;         ///< Empty where a method has no score for each picture.
  int maxima = 0;           ///< Hills of the curve that are more than noise.
  double low = 0;           ///< Where the highest hill begins
  double high = 0;          ///< and ends: a search from here on finds it.
  double contrast = 0;      ///< The highest score over that far from focus.
  double second_hill = 0;   ///< Height of the second hill over that of the highest; 0 without one.
};

/// A name, and what it answers. noise: deviation of the pixels' noise, grey levels. An estimator
/// that has no curve, but looks at several pictures at once, is one of these too: it gives the peak
/// and its ends.
struct FocusMethod {
  std::string name;
  std::function<StackAnswer(const WindowStack& stack, double noise)> find;
};

/// A score for every picture, in the order of the stack.
using StackScores = std::function<std::vector<double>(const WindowStack&)>;

/// A scorer of the windows of stacks. Throws as select_device.
Scorer stack_scorer(const MetricSpec& spec, const std::string& backend,
                    const DeviceOptions& options);

/// Its numbers of every picture's window, picture by picture. Throws as Scorer::score.
std::vector<double> numbers_of(Scorer& scorer, const WindowStack& stack);

/// The peak of a curve of scores, in one light. How far a score scatters is measured, by noise that
/// is added to the picture with the lowest one. light_exponent: by which power of the light scores
/// grow (focus/light.hpp).
FocusMethod method_by_scores(std::string name, StackScores scores, double light_exponent);

/// The metrics that are compared where nobody names any, for windows without a side of their own:
/// the engine's, laplacian-variance, tenengrad, and the fit of the law of defocus.
std::vector<std::string> usual_methods();

/// name: a metric's text without or with N = n, "laplacian-variance", "tenengrad" or "spectral".
/// backend: as select_device takes it. Throws as MetricSpec::parse, select_device and
/// spectral_method, Error(bad_argument) for a metric with another N or with several numbers.
FocusMethod named_method(const std::string& name, int n, const std::string& backend,
                         const DeviceOptions& options);

}  // namespace fathom
