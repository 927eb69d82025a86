// SPDX-License-Identifier: Apache-2.0
// fathom serve: the rig in a browser.
#include "serve/service.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "engine/clock.hpp"
#include "engine/error.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

using namespace serve;

struct Arguments {
  RigArguments rig;
  std::string search = "auto";
  int port = 8470;
  std::string bind = "127.0.0.1";
  std::string token;
  std::vector<std::string> names;
  std::string folder;
  bool is_read_only = false;
};

std::filesystem::path folder_of(const Arguments& arguments) {
  std::filesystem::path folder =
      arguments.folder.empty() ? state_folder() : std::filesystem::path(arguments.folder);
  if (folder.empty()) {
    throw Error(ErrorCode::unavailable,
                "neither HOME nor XDG_STATE_HOME names a folder for runs; name one with --folder");
  }
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (!std::filesystem::is_directory(folder))
    throw Error(ErrorCode::io, fmt::format("cannot make the folder {}", folder.string()));
  return folder;
}

bool is_loopback(const std::string& bind) {
  return bind == "localhost" || bind == "::1" || bind.starts_with("127.");
}

void tell(const Arguments& arguments, const Service& service, const std::filesystem::path& folder) {
  print_line(service.address());
  if (!is_loopback(arguments.bind)) {
    note(
        "everybody who can reach this computer may try this port, and what is sent is not "
        "encrypted: whoever reads along has pictures and token; use it in a network that you "
        "trust, or stay with 127.0.0.1 and an SSH tunnel");
  }
  note(fmt::format("runs, captures and calibrations go below {}", printable(folder.string())));
  note("Ctrl-C ends it; the lens is put back, and an open run is kept");
}

/// The environment keeps the token off the list of processes.
std::string token_of(const Arguments& arguments) {
  if (!arguments.token.empty()) return arguments.token;
  const char* const token = std::getenv("FATHOM_TOKEN");
  return token != nullptr ? token : "";
}

void require_port(int port) {
  constexpr int kHighest = 65535;
  if (port >= 0 && port <= kHighest) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("--port {}: a port is a number from 0 to {}", port, kHighest));
}

void wait_for_stop() {
  while (!stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

int run(const Arguments& arguments) {
  require_port(arguments.port);
  const std::filesystem::path folder = folder_of(arguments);
  Publisher publisher;
  Operator rig({.rig = arguments.rig.options(),
                .search = arguments.search,
                .folder = folder,
                .version = FATHOM_VERSION,
                .is_read_only = arguments.is_read_only},
               publisher);
  Api api(rig, publisher, folder, arguments.is_read_only, machine_clock());
  Service service({.bind = arguments.bind,
                   .port = arguments.port,
                   .token = token_of(arguments),
                   .names = arguments.names},
                  api);
  std::thread serving([&] { service.run(); });
  tell(arguments, service, folder);
  wait_for_stop();
  rig.finish();  // whoever watches sees the end of it
  publisher.events.close();
  publisher.pictures.close();
  service.stop();
  serving.join();
  return kDone;
}

}  // namespace

void add_serve(Verb& program) {
  Verb verb = program.add_verb("serve", "Show a rig in a browser, and drive it from there");
  verb.set_footer(
      "Examples:\n  fathom serve --rig sim:target=seedling,distance=1800\n"
      "  fathom serve --rig v4l2:/dev/video0 --port 8471 --folder pictures\n"
      "  fathom serve --rig rig.toml --bind 0.0.0.0 --read-only\n\n"
      "It prints an address with a token in it; whoever opens that may watch, and one at a time "
      "may "
      "drive.\nThe same can be asked for by programs (docs/http.md).");
  auto arguments = std::make_shared<Arguments>();
  add_rig_option(verb, arguments->rig.rig, true);
  arguments->rig.metric.add_to(verb);
  verb.add_option("--average", arguments->rig.average, "Frames averaged for one score")
      .shows_default();
  verb.add_option("--search", arguments->search, "How to search at first, as fathom focus takes it")
      .shows_default();
  verb.add_option("--port", arguments->port, "Port to listen at; 0: one that is free")
      .shows_default();
  verb.add_option("--bind", arguments->bind,
                  "Address to listen at: this computer alone unless you say another")
      .shows_default();
  verb.add_option("--token", arguments->token,
                  "What whoever asks must know (default: $FATHOM_TOKEN, else drawn at random)");
  verb.add_option("--name", arguments->names,
                  "Another name by which this computer may be asked for; may be repeated")
      .takes_one_at_a_time();
  verb.add_option("--folder", arguments->folder,
                  "Folder below which everything is kept (default: ~/.local/state/fathom)");
  verb.add_flag("--read-only", arguments->is_read_only, "Only show: nobody may drive");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
