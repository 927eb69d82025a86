// SPDX-License-Identifier: Apache-2.0
// How long work of a thread ends early: somebody who may throw is asked between its parts.
#pragma once

#include <functional>

namespace fathom {

/// While it lives, the long loops of this module call `look` now and then in this thread. What it
/// throws ends them, and whatever was being made is then good for nothing but to be destroyed.
class Interruptible {
 public:
  explicit Interruptible(std::function<void()> look);
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible();

 private:
  std::function<void()> look_;
  const std::function<void()>* before_;
};

namespace depth {

/// Calls what the Interruptible of this thread has, if there is one. Throws what that does.
void look_for_interruption();

}  // namespace depth
}  // namespace fathom
