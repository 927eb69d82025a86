// SPDX-License-Identifier: Apache-2.0
// How long one window takes.
#pragma once

#include <span>

#include "engine/backend.hpp"
#include "tools/fathom/samples.hpp"

namespace fathom::cli {

/// Times scoring windows.size() / batch different calls of `batch` windows, over and over, after a
/// warm-up. windows.size() must be a multiple of batch. Throws as Plan::score, and Error(cancelled)
/// after Ctrl-C.
WindowTime time_windows(Plan& plan, const Frame& frame, std::span<const Window> windows,
                        std::size_t batch);

}  // namespace fathom::cli
