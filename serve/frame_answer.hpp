// SPDX-License-Identifier: Apache-2.0
// What an answer with a frame says of it.
#pragma once

#include <httplib.h>

#include <optional>

#include "engine/frame.hpp"

namespace fathom::serve {

/// When it was exposed, on the rig's clock, and where the lens stood.
void set_frame_headers(httplib::Response& response, const Exposure& exposure,
                       std::optional<double> position);

}  // namespace fathom::serve
