// SPDX-License-Identifier: Apache-2.0
// A door for what one thread may use at a time.
#pragma once

#include <atomic>

namespace fathom {

/// A second thread that comes in while the first is inside is refused; it does not wait, because it
/// would be wrong there afterwards too. Costs some nanoseconds.
class OneThread {
 public:
  /// The time that a thread is inside: from its construction to its end.
  class Inside {
   public:
    /// Throws Error(bad_argument).
    explicit Inside(OneThread& door) : door_(door) {
      if (door.is_taken_.exchange(true, std::memory_order_acquire)) refuse();
    }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
    ~Inside() { door_.is_taken_.store(false, std::memory_order_release); }

   private:
    [[noreturn]] static void refuse();
    OneThread& door_;
  };

 private:
  std::atomic<bool> is_taken_ = false;
};

}  // namespace fathom
