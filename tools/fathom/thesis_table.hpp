// SPDX-License-Identifier: Apache-2.0
// The thesis' times (T18) against this machine's.
#pragma once

#include <string>
#include <vector>

namespace fathom::cli {

/// One of the thesis' times, s (two where it has a range), and the same work here.
struct ThesisTime {
  std::string what;
  double least_s = 0, most_s = 0;
  double here_s = 0;

  /// "55 s", "20 to 30 min"
  std::string thesis_text() const;
  /// Three digits and a unit.
  std::string here_text() const;
  /// How many times faster, the lesser ratio where the thesis has two.
  double times() const { return least_s / here_s; }
};

struct ThesisTimes {
  std::vector<ThesisTime> rows;
  std::size_t evaluations = 0;  ///< Of the search that was timed.
  double search_s = 0;          ///< Computing of that search, a median.
  std::string device;           ///< Backend and device that computed.
};

/// Measures them on the simulated rig. backend: what select_device takes. Throws as select_device
/// and Rig.
ThesisTimes measure_thesis_times(const std::string& backend);

/// Times one 64 x 64 score by FFT and by Walsh, one window a call, and the computing of one whole
/// distance on the simulated rig, and prints them beside the thesis': a table, or JSON lines.
/// backend: what select_device takes. Throws as select_device and Rig.
void print_thesis_table(const std::string& backend, bool json);

}  // namespace fathom::cli
