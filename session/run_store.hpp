// SPDX-License-Identifier: Apache-2.0
// Where runs and what is learned are kept between measurements.
#pragma once

#include <filesystem>
#include <string>

#include "run_file.hpp"

namespace fathom {

/// $XDG_STATE_HOME/fathom or ~/.local/state/fathom; empty where neither variable names a folder.
std::filesystem::path state_folder();

/// Now, ISO 8601, UTC.
std::string utc_now();
/// The same as part of a file's name: "2026-11-30T12-00-00".
std::string utc_for_name();

/// Writes a run into a file of its own, TIME-VERB-XXXX.json, and returns its path. The folder is
/// made if need be. Throws Error(io).
std::filesystem::path keep_run(const std::filesystem::path& folder, const RunFile& file);

/// Whether a run's file is newer than another. Names begin with their time, in seconds; of one second
/// the files know better.
bool is_newer_run(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace fathom
