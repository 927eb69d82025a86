// SPDX-License-Identifier: Apache-2.0
// The fathom command: verbs in, one line and an exit status out.
#include <new>

#include "engine/error.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace {

using namespace fathom;
using namespace fathom::cli;

int exit_status_of(const Error& error) {
  return error.code() == ErrorCode::bad_argument ? kWrongUsage : kError;
}

int run(int argc, char** argv) {
  CommandLine line("Fathom measures focus, and from focus, distance.", "fathom " FATHOM_VERSION,
                   "fathom VERB --help tells more of each.\n\nExample:\n"
                   "  fathom focus --rig sim:target=seedling,distance=1800 --plot -");
  Verb program = line.program();
  for (auto* const add : {add_devices, add_bench, add_score, add_spectrum, add_optics, add_sweep,
                          add_focus, add_calibrate, add_range, add_capture, add_rerun, add_rigs,
                          add_compare_searches, add_reproduce}) {
    add(program);
  }
  return line.run(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  remember_command(argc, argv);
  catch_signals();
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    note(error.what());
    return exit_status_of(error);
  } catch (const std::bad_alloc&) {
    note("out of memory");
  } catch (const std::exception& error) {
    note(error.what());
  }
  return kError;
}
