// SPDX-License-Identifier: Apache-2.0
// Saves what a verb measures, whatever happens to it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "session/run_keeper.hpp"

namespace fathom::cli {

/// The keeper of what this verb measures on this rig.
RunKeeper start_run(const std::string& verb, Rig& rig);

/// Where a run goes when no -o names a file: $XDG_STATE_HOME/fathom/runs or
/// ~/.local/state/fathom/runs, named by time and verb.
std::filesystem::path default_run_path(const std::string& verb);

/// Asked before anything is measured. Throws Error(bad_argument) where an output is also an input
/// or another output, and Error(io) for an output that could not be written. Empty names are passed
/// over.
void require_separate(const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs);

/// Runs `body`, then saves the run file and says where; if the body throws, saves what was measured
/// with the reason and throws on. `output` empty means the default place, where failing to write
/// only warns; a named file that cannot be written is an error, but only after the body has printed
/// its result.
void with_run_file(RunFile& file, const std::string& output, bool json,
                   const std::function<void()>& body);

/// Remembers the command line for run files.
void remember_command(int argc, const char* const* argv);

}  // namespace fathom::cli
