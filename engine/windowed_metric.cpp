// SPDX-License-Identifier: Apache-2.0
#include "engine/windowed_metric.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

WindowedMetric resolve_window(std::string_view metric, const std::optional<Window>& window,
                              int width_px, int height_px) {
  const MetricSpec spec = MetricSpec::parse(metric, window ? window->n : kDefaultWindowSide);
  if (!window) return {spec, centred_window(width_px, height_px, spec.n)};
  if (spec.n != window->n) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("metric {} is for {} x {} windows, but window {} has side {}; leave N out "
                    "of one of them",
                    spec.text(), spec.n, spec.n, to_string(*window), window->n));
  }
  require_fits(*window, width_px, height_px);
  return {spec, *window};
}

}  // namespace fathom
