// SPDX-License-Identifier: Apache-2.0
// The one error type of the library.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace fathom {

/// What kind of thing went wrong; the message says which, where and what to do about it.
enum class ErrorCode {
  bad_argument,   ///< The caller asked for something that has no meaning (a window side of 65).
  out_of_bounds,  ///< Well formed, but outside of what this picture, lens or calibration covers.
  bad_data,       ///< A file or stream is damaged, truncated or of another format.
  io,             ///< The operating system refused to read or write.
  unavailable,    ///< A backend, device or program that is not there.
  unsupported,    ///< A device that cannot do what was asked, and says why.
  device_lost,    ///< A device stopped answering; a new one may work.
  out_of_memory,  ///< Says how much was wanted.
  timeout,        ///< A device did not answer within the time that it was given.
  cancelled,      ///< The user asked to stop.
};

/// Stable lower-case name of a code, e.g. "bad_argument".
const char* to_string(ErrorCode code) noexcept;

/// Thrown at open, plan and input/output; routine outcomes (a timeout of a grab, an unsupported
/// metric, no focus found) are values instead. The message is one line without a trailing period,
/// fit to be shown after "fathom: ".
class Error : public std::runtime_error {
 public:
  /// Control characters become \\xNN: a message often quotes a name or a text that somebody else
  /// wrote, and must neither break the line nor reach the terminal as a command.
  Error(ErrorCode code, std::string_view message);
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace fathom
