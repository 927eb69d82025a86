// SPDX-License-Identifier: Apache-2.0
// Keeps what a session measures, as it comes: whatever ends a run, what was measured is not lost.
#pragma once

#include <optional>

#include "observer.hpp"
#include "run_file.hpp"
#include "spectrum_keeper.hpp"

namespace fathom {

/// What a run file says of the rig. The verb, the command line and the date are the caller's.
RunSetup setup_of(Rig& rig);

/// Writes every run into `file`, the first to the last.
class RunKeeper final : public Observer {
 public:
  explicit RunKeeper(RunSetup setup) : sharpest_(setup.window) { file.setup = std::move(setup); }

  /// From now on targets stand at this distance.
  void target_at(double distance_mm) { target_mm_ = distance_mm; }

  void began(const Run& run, std::size_t positions) override;
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override;
  void evaluated(const Measurement& measurement) override;
  void found(const Focus& focus) override;

  RunFile file;

 private:
  std::optional<double> target_mm_;
  SpectrumKeeper sharpest_;
};

}  // namespace fathom
