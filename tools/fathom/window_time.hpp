// SPDX-License-Identifier: Apache-2.0
// How long one window takes.
#pragma once

#include <span>

#include "engine/backend.hpp"

namespace fathom::cli {

/// Wall-clock time for one window over repeated measurements, us.
struct WindowTime {
  double median_us = 0;
  double min_us = 0;
  double max_us = 0;
};

/// Times scoring windows.size() / batch different calls of `batch` windows, over and over, after a
/// warm-up. windows.size() must be a multiple of batch. Throws as Plan::score, and Error(cancelled)
/// after Ctrl-C.
WindowTime time_windows(Plan& plan, const Frame& frame, std::span<const Window> windows,
                        std::size_t batch);

}  // namespace fathom::cli
