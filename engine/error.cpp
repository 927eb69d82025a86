// SPDX-License-Identifier: Apache-2.0
#include "engine/error.hpp"

#include "engine/printable.hpp"

namespace fathom {

Error::Error(ErrorCode code, std::string_view message)
    : std::runtime_error(printable(message)), code_(code) {}

const char* to_string(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::bad_argument:
      return "bad_argument";
    case ErrorCode::out_of_bounds:
      return "out_of_bounds";
    case ErrorCode::bad_data:
      return "bad_data";
    case ErrorCode::io:
      return "io";
    case ErrorCode::unavailable:
      return "unavailable";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::device_lost:
      return "device_lost";
    case ErrorCode::out_of_memory:
      return "out_of_memory";
    case ErrorCode::timeout:
      return "timeout";
    case ErrorCode::cancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace fathom
