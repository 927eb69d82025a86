// SPDX-License-Identifier: Apache-2.0
// Which metric suits these pictures: all of them on one stack, by the criteria of Firestone et al.
// (Cytometry 12, 1991) and Sun et al. (Microscopy Research and Technique 65, 2004): accuracy, width,
// range, false maxima; and how much more noise each stands.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/fathom/focus_methods.hpp"

namespace fathom {

/// Fewer pictures have no curve to compare.
inline constexpr std::size_t kFewestPictures = 5;

/// One method's part.
struct MethodTally {
  std::string name;
  StackAnswer answer;
  double off = 0;       ///< Its peak less the consensus; only where there is one.
  bool agrees = false;  ///< Whether that is within the tolerance.
  /// The largest multiple of the pictures' noise that may be added before its answer leaves the
  /// consensus; 0: not even as much again, or not asked.
  double stands = 0;
  bool stands_all = false;  ///< Whether no more was tried.
  double scatter = 0;       ///< Root mean square of its answers' distance from the consensus then.
};

/// Why no metric is recommended.
enum class NoConsensus {
  no_peak,       ///< Every curve is flat, or no more than noise.
  at_end,        ///< The curves rise to an end of the stack.
  disagreement,  ///< The peaks lie in different places.
  out_of_order,  ///< The curves go up and down from picture to picture.
};

/// Why the recommended method, beside the others that stand as much noise.
enum class Advantage {
  only_one,       ///< No other agrees.
  most_noise,     ///< None stands as much.
  fewest_maxima,  ///< It has fewer local maxima than they.
  least_scatter,  ///< Its answers scatter least under that noise.
};

struct MetricComparison {
  double noise = 0;
  std::vector<MethodTally> methods;
  /// The median of the peaks that stand out; absent where there is none to agree on.
  std::optional<double> consensus;
  double tolerance = 0;  ///< How far an answer may lie from it.
  std::optional<NoConsensus> doubt;
  std::optional<std::size_t> recommended;  ///< Index of a method.
  Advantage advantage = Advantage::only_one;
  bool has_second_hill = false;  ///< Whether most curves have a second hill, half as high or more.
};

/// Told how much is done and how much there is.
using Told = std::function<void(std::size_t done, std::size_t total)>;

/// Compares the methods. Where they agree on a focus, multiples of the noise are added to the pixels,
/// with fixed seeds, until the answers leave it. noise: deviation of the pixels', above 0.
/// Throws Error(bad_argument) for fewer than kFewestPictures, and as the methods do.
MetricComparison compare_metrics(const std::vector<FocusMethod>& methods, const WindowStack& stack,
                                 double noise, const Told& told);

}  // namespace fathom
