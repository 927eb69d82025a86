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

/// An unset shell variable in quotes must not mean "not given".
void require_no_empty_argument(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (*argv[i] == '\0') {
      throw Error(
          ErrorCode::bad_argument,
          fmt::format("argument {} is empty; leave it out, with its option, or fill it in", i));
    }
  }
}

/// CLI11 takes a mistyped verb for an extra argument and says that one is missing.
void require_known_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || *argv[1] == '-') return;
  std::string verbs;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_name() == argv[1]) return;
    verbs += " " + verb->get_name();
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no verb \"{}\"; there are{}; try fathom --help", argv[1], verbs));
}

/// What was wrong with the command line, in one line.
std::string problem_of(const CLI::ParseError& error) {
  std::string what = error.what();
  what = what.substr(0, what.find('\n'));
  // CLI11 says "Could not convert: --from = abc" of an option that takes a number.
  const std::string start = "Could not convert: ";
  if (!what.starts_with(start)) return what;
  what.erase(0, start.size());
  if (const auto equals = what.find(" = "); equals != std::string::npos)
    what.replace(equals, 3, " ");
  return what + ": write a number";
}

int run(int argc, char** argv) {
  require_no_empty_argument(argc, argv);
  CLI::App app("Fathom measures focus, and from focus, distance.", "fathom");
  app.set_version_flag("--version", "fathom " FATHOM_VERSION);
  app.footer(
      "fathom VERB --help tells more of each.\n\nExample:\n"
      "  fathom focus --rig sim:target=seedling,distance=1800 --plot -");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  int status = kDone;
  for (auto* const add : {add_devices, add_bench, add_score, add_spectrum, add_optics, add_sweep,
                          add_focus, add_calibrate, add_range, add_capture, add_rerun, add_rigs,
                          add_compare_searches, add_reproduce}) {
    add(app, status);
  }
  require_known_verb(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    const int done = app.exit(help);
    flush_lines();
    return done;
  } catch (const CLI::ParseError& error) {
    note(problem_of(error) + "; try fathom --help, or fathom VERB --help");
    return kWrongUsage;
  }
  return status;
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
