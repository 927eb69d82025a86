// SPDX-License-Identifier: Apache-2.0
// Saves what a verb measures, whatever happens to it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "session/run_keeper.hpp"
#include "session/run_store.hpp"

namespace fathom::cli {

/// The keeper of what this verb measures on this rig.
RunKeeper start_run(const std::string& verb, Rig& rig);

/// The file or the folder that a rig text plays; empty for a live rig.
std::string played_by(const std::string& rig);

/// Asked before anything is measured. Throws Error(bad_argument) where an output is also an input, a
/// file of the recording that an input plays, or another output, and Error(io) for an output that could not be written. Empty names are passed
/// over.
void require_separate(const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs);

/// Runs `measure`, then `tell`, which prints what that came to, then saves the run file and says
/// where. If `measure` throws, what was measured is saved with the reason; if `tell` does, the run
/// is whole and saved as such; either is thrown on. `output` empty means $XDG_STATE_HOME/fathom/runs
/// or ~/.local/state/fathom/runs and a name of time and verb that nobody else has; where that cannot
/// be written there is only a warning. A named file that cannot be written is an error, but only
/// after the result was told.
void with_run_file(RunFile& file, const std::string& output, bool json,
                   const std::function<void()>& measure, const std::function<void()>& tell);

/// Remembers the command line for run files.
void remember_command(int argc, const char* const* argv);

}  // namespace fathom::cli
