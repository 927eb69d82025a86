// SPDX-License-Identifier: Apache-2.0
// The focus of a stack of pictures by the law of defocus, beside the metrics.
#pragma once

#include <string>

#include "tools/fathom/focus_methods.hpp"

namespace fathom {

/// The name that named_method() knows it by.
inline constexpr const char* kSpectralMethod = "spectral";

/// Fits blur and focus to the ring powers of windows of side n. The first stack that tells how the
/// lens blurs tells it for those that follow: noise is added to the pictures of one lens. Throws as
/// select_device, and Error(bad_argument) for windows too small to have rings.
FocusMethod spectral_method(int n, const std::string& backend, const DeviceOptions& options);

}  // namespace fathom
