// SPDX-License-Identifier: Apache-2.0
// Times metrics on devices, one case after the other.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "engine/selection.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/window_time.hpp"

namespace fathom::cli {

/// A number of a case that is left to the machine.
inline constexpr int kDecideLater = 0;

/// One row to be.
struct BenchCase {
  std::string choice;  ///< What select_device takes.
  std::string series;  ///< The metric as it was given: its sizes tell of each other's speed.
  MetricSpec spec;
  bool may_skip = false;  ///< Whether a size that takes too long is left out.
  int threads = kDecideLater;
  int batch = kDecideLater;  ///< kDecideLater: full_batch(), less where that would take too long.
};

struct BenchRow {
  std::string backend;
  DeviceInfo device;
  MetricSpec spec;
  int threads = 0;  ///< Device::threads.
  int batch = 0;
  WindowTime time;

  /// Whether the calling thread computed all of it, so that it never had to wait for anyone: not
  /// for a GPU, not for other threads.
  bool is_one_thread() const {
    return device.kind == DeviceKind::cpu && (threads == 1 || batch == 1);
  }
};

class Benchmark {
 public:
  /// depth: bits of the frame's pixels, 8 or 16.
  explicit Benchmark(int depth);

  const Frame& frame() const { return frame_; }

  /// Throws Error(bad_argument) if the choice of a device, a number of threads or FATHOM_THREADS
  /// makes no sense: measure() would say so too, but only after the rows before that case.
  static void require_valid(std::span<const BenchCase> cases);

  /// The case's row. None for one that is too slow, or that no device is there for or takes,
  /// with a note; and for one that comes to the same as a case before. Throws as Device::plan and
  /// time_windows.
  std::optional<BenchRow> measure(const BenchCase& wanted);

 private:
  /// The first row of the last size of a series.
  struct Experience {
    int n = 0;
    double window_us = 0;
  };

  std::optional<BenchRow> measure(const BenchCase& wanted, const Selection& selection, int batch);
  double expected_us(const BenchCase& wanted) const;
  bool too_slow(const BenchCase& wanted);
  int affordable_batch(const BenchCase& wanted) const;
  void learn(const BenchCase& of, double window_us);
  void note_once(const std::string& text);

  Frame frame_;
  std::map<std::string, Experience> experience_;  // by choice and series
  std::set<std::string> measured_, noted_;
  const OnWork patience_ = patient_words();
};

}  // namespace fathom::cli
