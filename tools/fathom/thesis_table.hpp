// SPDX-License-Identifier: Apache-2.0
// The thesis' times (T18) against this machine's.
#pragma once

#include <string>

namespace fathom::cli {

/// Times one 64 x 64 score by FFT and by Walsh, one window a call, and the computing of one whole
/// distance on the simulated rig, and prints them beside the thesis': a table, or JSON lines.
/// backend: what select_device takes. Throws as select_device and Rig.
void print_thesis_table(const std::string& backend, bool json);

}  // namespace fathom::cli
