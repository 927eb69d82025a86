// SPDX-License-Identifier: Apache-2.0
// The fathom command: verbs in, one line and an exit status out.
#include <new>
#include <system_error>

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
                   "fathom VERB --help tells more of each, fathom help TOPIC of rigs, metrics and "
                   "searches.\n\nExample:\n"
                   "  fathom focus --rig sim:target=seedling,distance=1800 --plot -\n\n"
                   "Exit status: 0 done, 1 error, 2 wrong usage, 3 no focus found.");
  Verb program = line.program();
  for (auto* const add : {add_devices,
                          add_bench,
                          add_score,
                          add_merge,
                          add_spectrum,
                          add_optics,
                          add_sweep,
                          add_depth,
                          add_focus,
                          add_calibrate,
                          add_range,
                          add_capture,
                          add_rerun,
                          add_runs,
                          add_snap,
                          add_rigs,
                          add_serve,
                          add_compare_searches,
                          add_compare_metrics,
                          add_reproduce,
                          add_help}) {
    add(program);
  }
  return line.run(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  remember_command(argc, argv);
  catch_signals();
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    note(error.what());
    return exit_status_of(error);
  } catch (const std::bad_alloc&) {
    note("out of memory");
  } catch (const std::system_error& error) {
    const bool is_threads = error.code() == std::errc::resource_unavailable_try_again;
    note(is_threads ? "this process may not start the threads that it needs (ulimit -u)"
                    : error.what());
  } catch (const std::exception& error) {
    note(error.what());
  }
  return kError;
}
