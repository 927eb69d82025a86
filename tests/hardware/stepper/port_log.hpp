// SPDX-License-Identifier: Apache-2.0
// What reached the parallel port, as the emulated machine notes it.
#pragma once

#include <cstdint>
#include <vector>

namespace fathom::test {

/// One write to the data lines.
struct PortWrite {
  double time_s;  ///< On the clock of the machine outside.
  std::uint8_t data;
};

/// The log so far, and what is added to it.
class PortLog {
 public:
  /// Begins at the end. Without a log is_there() is false.
  PortLog();
  bool is_there() const { return is_there_; }
  /// The writes to the data lines since this was made.
  std::vector<PortWrite> writes() const;

 private:
  bool is_there_ = false;
  std::int64_t begin_ = 0;
};

}  // namespace fathom::test
