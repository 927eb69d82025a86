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
  std::string window = {};
  std::string metric = "fft";
  std::string backend = {};
  DeviceOptions device = {};

  /// with_rings: whether --metric may name rings=K here.
  /// window_more: what more --window takes here.
  void add_to(Verb& verb, bool with_rings = false, const std::string& window_more = {});
  std::optional<Window> chosen_window() const;
};

/// --rig, which `fathom help rigs` tells of.
void add_rig_option(Verb& verb, std::string& rig, bool required);

/// Throws Error(bad_argument) for what --average does not take.
int checked_average(int average);

/// Throws Error(bad_argument) for what --step does not take.
std::optional<double> checked_step(std::optional<double> step);

/// --rig and what a rig is measured with, and where results go.
struct RigArguments {
  std::string rig;
  MetricArguments metric = {.metric = kSearchMetric};
  int average = 1;
  bool json = false;
  std::string output;  ///< -o; its meaning is the verb's.

  /// Returns the option -o. window_more: what more --window takes here.
  Option add_to(Verb& verb, const std::string& output_help, bool rig_required = true,
                const std::string& window_more = {});
  RigOptions options() const;
};

/// --search, --peak, --bracket, --tolerance, --from, --to.
struct SearchArguments {
  std::string search = "auto";
  std::string peak = "fit";
  std::string bracket;
  std::optional<double> tolerance, from, to;
  std::optional<int> frames;
  bool is_moving = false, is_halting = false;
  std::optional<double> blur_px, aperture, wavelength_nm, pixel_um;

  /// with_range: whether --from and --to mean lens positions here (not in calibrate).
  void add_to(Verb& verb, bool with_range = true);
  FocusRequest request() const;
};

/// The axes of a focus curve of this rig.
std::string position_label(const LensInfo& lens);
std::string score_label(const MetricSpec& spec);

}  // namespace fathom::cli
