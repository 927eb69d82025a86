// SPDX-License-Identifier: Apache-2.0
// Options that several verbs share, said once.
#pragma once

#include <optional>
#include <string>

#include "focus/focus.hpp"
#include "session/rig.hpp"
#include "tools/fathom/command_line.hpp"

namespace fathom::cli {

/// --window, --metric, --backend, --threads: what is computed, of what, and where.
struct MetricArguments {
  std::string window;
  std::string metric = "fft";
  std::string backend;
  DeviceOptions device;

  /// with_rings: whether --metric may name rings=K here.
  void add_to(Verb& verb, bool with_rings = false);
  std::optional<Window> chosen_window() const;
};

/// --rig, with what the drivers of this build say of themselves. Call it after verb.set_footer().
void add_rig_option(Verb& verb, std::string& rig, bool required);

/// Throws Error(bad_argument) for what --average does not take.
int checked_average(int average);

/// Throws Error(bad_argument) for what --step does not take.
std::optional<double> checked_step(std::optional<double> step);

/// --rig and what a rig is measured with, and where results go.
struct RigArguments {
  std::string rig;
  MetricArguments metric;
  int average = 1;
  bool json = false;
  std::string output;  ///< -o; its meaning is the verb's.

  /// Returns the option -o.
  Option add_to(Verb& verb, const std::string& output_help, bool rig_required = true);
  RigOptions options() const;
};

/// --search, --peak, --bracket, --tolerance, --from, --to.
struct SearchArguments {
  std::string search = "auto";
  std::string peak = "fit";
  std::string bracket;
  std::optional<double> tolerance, from, to;

  /// with_range: whether --from and --to mean lens positions here (not in calibrate).
  void add_to(Verb& verb, bool with_range = true);
  FocusRequest request() const;
};

/// The axes of a focus curve of this rig.
std::string position_label(const LensInfo& lens);
std::string score_label(const MetricSpec& spec);

}  // namespace fathom::cli
