// SPDX-License-Identifier: Apache-2.0
// How a user's wish to stop reaches whatever is taking long.
#pragma once

#include <functional>

namespace fathom {

/// How often the user has asked to stop so far, by Ctrl-C for instance. Asked between the parts of
/// anything that takes long; cheap, and callable from any thread.
///
/// A count and not a flag, so that a run that was stopped can still put its lens back: what ends a
/// move is a request that came after the move began. The first Ctrl-C ends the measurement, the
/// second one the way back.
using StopRequests = std::function<int()>;

/// Nobody asks.
inline int never_stop() { return 0; }

/// Tells whether a request has come since it was made.
class StopWatch {
 public:
  /// `requests` must outlive this.
  explicit StopWatch(const StopRequests& requests) : requests_(requests), before_(requests()) {}
  bool stopped() const { return requests_() != before_; }

 private:
  const StopRequests& requests_;
  int before_;
};

}  // namespace fathom
