// SPDX-License-Identifier: Apache-2.0
// Keeps a run's record, whatever happens to the run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "session/rig.hpp"
#include "session/run_file.hpp"

namespace fathom::cli {

/// The record that a run of this rig starts with.
RunFile start_record(const std::string& verb, Rig& rig);

/// Where a record goes when no -o names a file: $XDG_STATE_HOME/fathom/records or
/// ~/.local/state/fathom/records, named by time and verb.
std::filesystem::path default_record_path(const std::string& verb);

/// Asked before anything is measured. Throws Error(bad_argument) where an output is also an input
/// or another output, and Error(io) for an output that could not be written. Empty names are passed
/// over.
void require_separate(const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs);

/// Runs `body`, then saves the record and says where; if the body throws, saves what was measured
/// with the reason and throws on. `output` empty means the default place, where failing to write
/// only warns; a named file that cannot be written is an error, but only after the body has printed
/// its result.
void with_record(RunFile& record, const std::string& output, bool json,
                 const std::function<void()>& body);

/// Remembers the command line for records.
void remember_command(int argc, const char* const* argv);

/// Says on stderr which of the positions that a user asked for the lens takes elsewhere.
void note_inexact_positions(const Lens& lens, const std::vector<double>& wanted);

/// One search on a rig, every measurement told to the record and to `on_evaluation`. The lens ends
/// where the last evaluation left it.
Focus search_on_rig(Rig& rig, const FocusRequest& request, Run& run,
                    const std::function<void(const Evaluation&)>& on_evaluation);

/// The same, from where `before` has found the focus.
Focus track_on_rig(Rig& rig, const Run& before, Run& run,
                   const std::function<void(const Evaluation&)>& on_evaluation);

}  // namespace fathom::cli
