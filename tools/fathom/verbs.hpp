// SPDX-License-Identifier: Apache-2.0
// One function per verb: adds the subcommand and, when it is given, runs it and sets the exit
// status.
#pragma once

#include <CLI/CLI.hpp>

namespace fathom::cli {

/// What the program tells the shell.
enum ExitStatus { kDone = 0, kError = 1, kWrongUsage = 2, kNoFocus = 3 };

void add_devices(CLI::App& app, int& status);
void add_bench(CLI::App& app, int& status);
void add_score(CLI::App& app, int& status);
void add_spectrum(CLI::App& app, int& status);
void add_optics(CLI::App& app, int& status);
void add_sweep(CLI::App& app, int& status);
void add_focus(CLI::App& app, int& status);
void add_calibrate(CLI::App& app, int& status);
void add_range(CLI::App& app, int& status);
void add_capture(CLI::App& app, int& status);
void add_rerun(CLI::App& app, int& status);
void add_compare_searches(CLI::App& app, int& status);
void add_rigs(CLI::App& app, int& status);
void add_reproduce(CLI::App& app, int& status);

}  // namespace fathom::cli
