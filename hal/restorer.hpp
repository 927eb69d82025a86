// SPDX-License-Identifier: Apache-2.0
// What a driver found is put back when it is done.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "../engine/error.hpp"

namespace fathom {

/// Does what puts things back, the last first. What a device refuses, it keeps; one that is gone, or
/// does not answer, is asked nothing more.
class Restorer {
 public:
  Restorer() = default;
  Restorer(const Restorer&) = delete;
  Restorer& operator=(const Restorer&) = delete;
  ~Restorer() {
    for (auto undo = undo_.rbegin(); undo != undo_.rend(); ++undo) {
      try {
        (*undo)();
      } catch (const Error& error) {
        const ErrorCode code = error.code();
        if (code == ErrorCode::device_lost || code == ErrorCode::timeout) return;
      } catch (...) {  // no destructor throws
      }
    }
  }

  void at_end(std::function<void()> undo) { undo_.push_back(std::move(undo)); }

 private:
  std::vector<std::function<void()>> undo_;
};

}  // namespace fathom
