// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/run_keeping.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

std::string& command_line() {
  static std::string text;
  return text;
}

std::string utc_time(const char* format) {
  return fmt::format(fmt::runtime(format), fmt::gmtime(std::chrono::system_clock::now()));
}

std::string shell_quoted(std::string_view word) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=:,./+";
  if (!word.empty() && word.find_first_not_of(plain) == std::string_view::npos)
    return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

bool has_measurements(const RunFile& file) {
  for (const Run& run : file.runs) {
    if (!run.measurements.empty()) return true;
  }
  return false;
}

void say_saved(const std::filesystem::path& path, bool json) {
  const std::string line = fmt::format("run saved to {}", path.string());
  if (json) {
    note(line);
  } else {
    print_line(line);
  }
}

void save_by_default(const RunFile& file, bool json) {
  const std::filesystem::path path = default_run_path(file.setup.verb);
  try {
    write_file(path, file.json());
    say_saved(path, json);
  } catch (const Error& error) {
    note(fmt::format("the run is lost: {}; name a file with -o", error.what()));
  }
}

void save(const RunFile& file, const std::string& output, bool json) {
  if (output.empty()) return save_by_default(file, json);
  try {
    write_file(output, file.json());
  } catch (const Error&) {
    save_by_default(file, json);
    throw;
  }
  say_saved(output, json);
}

/// Whether two names mean one file, also where it does not exist yet.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) ==
         std::filesystem::weakly_canonical(b, ignored);
}

void require_writable(const std::string& output) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path place = fs::absolute(output, ignored);
  if (fs::is_directory(place, ignored) || output.ends_with('/')) {
    throw Error(ErrorCode::io, fmt::format("{} is a folder; name a file", output));
  }
  while (!fs::exists(place, ignored) && place.has_relative_path()) place = place.parent_path();
  if (::access(place.c_str(), W_OK) == 0) return;
  throw Error(ErrorCode::io,
              fmt::format("cannot write {}: {}", output, std::generic_category().message(errno)));
}

}  // namespace

void remember_command(int argc, const char* const* argv) {
  std::string& text = command_line();
  text = "fathom";
  for (int i = 1; i < argc; ++i) text += " " + shell_quoted(argv[i]);
}

RunKeeper start_run(const std::string& verb, Rig& rig) {
  RunSetup setup = setup_of(rig);
  setup.verb = verb;
  setup.command = command_line();
  setup.created = utc_time("{:%Y-%m-%dT%H:%M:%SZ}");
  return RunKeeper(std::move(setup));
}

std::filesystem::path default_run_path(const std::string& verb) {
  namespace fs = std::filesystem;
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder = state != nullptr && *state != '\0' ? fs::path(state)
                    : home != nullptr && *home != '\0' ? fs::path(home) / ".local" / "state"
                                                       : fs::path(".");
  // The process number keeps two runs in one second apart.
  return folder / "fathom" / "runs" /
         fmt::format("{}-{}-{}.json", utc_time("{:%Y-%m-%dT%H-%M-%S}"), verb, ::getpid());
}

void require_separate(const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty() || outputs[i] == "-") continue;
    std::vector<std::string> others(outputs.begin(), outputs.begin() + i);
    others.insert(others.end(), inputs.begin(), inputs.end());
    for (const std::string& other : others) {
      if (other.empty() || !same_file(outputs[i], other)) continue;
      throw Error(ErrorCode::bad_argument,
                  fmt::format("writing {} would destroy {}; name another file", outputs[i], other));
    }
    require_writable(outputs[i]);
  }
}

void with_run_file(RunFile& file, const std::string& output, bool json,
                   const std::function<void()>& body) {
  try {
    body();
  } catch (const std::exception& error) {
    file.error = error.what();
    if (has_measurements(file)) {
      try {
        save(file, output, json);
      } catch (const Error& second) {
        note(second.what());
      }
    }
    throw;
  }
  save(file, output, json);
}

}  // namespace fathom::cli
