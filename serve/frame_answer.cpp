// SPDX-License-Identifier: Apache-2.0
#include "serve/frame_answer.hpp"

#include <fmt/format.h>

namespace fathom::serve {
void set_frame_headers(httplib::Response& response, const Exposure& exposure,
                       std::optional<double> position) {
  response.set_header("X-Fathom-Stamp-Ns", std::to_string(exposure.start_ns));
  response.set_header("X-Fathom-End-Ns", std::to_string(exposure.end_ns));
  if (position) response.set_header("X-Fathom-Position", fmt::format("{:.17g}", *position));
}

}  // namespace fathom::serve
