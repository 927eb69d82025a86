// SPDX-License-Identifier: Apache-2.0
// One function per verb: adds the verb to the program. Where it is given, it runs and
// returns the exit status.
#pragma once

#include "tools/fathom/command_line.hpp"

namespace fathom::cli {

/// What the program tells the shell.
enum ExitStatus { kDone = 0, kError = 1, kWrongUsage = 2, kNoFocus = 3 };

void add_depth(Verb& program);
void add_devices(Verb& program);
void add_bench(Verb& program);
void add_score(Verb& program);
void add_merge(Verb& program);
void add_spectrum(Verb& program);
void add_optics(Verb& program);
void add_sweep(Verb& program);
void add_focus(Verb& program);
void add_calibrate(Verb& program);
void add_range(Verb& program);
void add_capture(Verb& program);
void add_rerun(Verb& program);
void add_compare_searches(Verb& program);
void add_compare_metrics(Verb& program);
void add_help(Verb& program);
void add_rigs(Verb& program);
void add_runs(Verb& program);
void add_serve(Verb& program);
void add_snap(Verb& program);
void add_reproduce(Verb& program);

}  // namespace fathom::cli
