// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/run_keeping.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

std::string& command_line() {
  static std::string text;
  return text;
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

std::string saved_at(const std::filesystem::path& path) {
  return "run saved to " + printable(path.string());
}

void say_saved(const std::filesystem::path& path, bool json) {
  if (path.empty()) return;
  if (json) return note(saved_at(path));
  try {
    print_line(saved_at(path));
  } catch (const OutputError& error) {
    throw OutputError(fmt::format("{}; {}", error.what(), saved_at(path)));
  }
}

/// Where a run goes that no -o names.
std::filesystem::path default_run_folder() {
  std::filesystem::path folder = state_folder();
  if (folder.empty()) {
    note(
        "neither HOME nor XDG_STATE_HOME names a folder, so the run goes into the working folder; "
        "name a file with -o");
    folder = "fathom";
  }
  return folder / "runs";
}

/// Where the run is now; empty: nowhere, which is said.
std::filesystem::path keep_by_default(const RunFile& file) {
  try {
    return keep_run(default_run_folder(), file);
  } catch (const Error& error) {
    note(fmt::format("the run is lost: {}; name a file with -o", error.what()));
    return {};
  }
}

/// As keep_by_default. Throws Error(io) for a file that was named and cannot be written, after the
/// run has been kept elsewhere.
std::filesystem::path keep(const RunFile& file, const std::string& output, bool json) {
  if (output.empty()) return keep_by_default(file);
  try {
    write_file(output, file.json());
    return output;
  } catch (const Error&) {
    say_saved(keep_by_default(file), json);
    throw;
  }
}

/// Keeps what a run came to before `problem` ended it, and throws that on. Where nobody reads, one
/// line tells of both.
[[noreturn]] void keep_and_throw(const RunFile& file, const std::string& output, bool json,
                                 const std::exception_ptr& problem) {
  std::filesystem::path place;
  try {
    if (has_measurements(file)) place = keep(file, output, json);
  } catch (const Error& second) {
    note(second.what());
  }
  try {
    std::rethrow_exception(problem);
  } catch (const OutputError& error) {
    if (place.empty()) throw;
    throw OutputError(fmt::format("{}; {}", error.what(), saved_at(place)));
  } catch (...) {
    say_saved(place, json);
    throw;
  }
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
  setup.created = utc_now();
  return RunKeeper(std::move(setup));
}

std::string played_by(const std::string& rig) {
  constexpr std::string_view kReplay = "replay:";
  if (!rig.starts_with(kReplay)) return "";
  return rig.substr(kReplay.size(), rig.find(',') - kReplay.size());
}

namespace {

/// Whether a file is there already, in the folder that a rig text plays, or is that recording itself.
bool is_of_recording(const std::string& output, const std::string& rig) {
  const std::string played = played_by(rig);
  if (played.empty() || !std::filesystem::is_regular_file(output)) return false;
  const auto folder = std::filesystem::absolute(output).parent_path().string();
  return same_file(output, played) || same_file(folder, played);
}

}  // namespace

void require_separate(const std::vector<std::string>& inputs,
                      const std::vector<std::string>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty() || outputs[i] == "-") continue;
    std::vector<std::string> others(outputs.begin(), outputs.begin() + i);
    others.insert(others.end(), inputs.begin(), inputs.end());
    for (const std::string& other : others) {
      if (other.empty() || !(same_file(outputs[i], other) || is_of_recording(outputs[i], other)))
        continue;
      throw Error(ErrorCode::bad_argument,
                  fmt::format("writing {} would destroy {}; name another file", outputs[i], other));
    }
    require_writable(outputs[i]);
  }
}

void with_run_file(RunFile& file, const std::string& output, bool json,
                   const std::function<void()>& measure, const std::function<void()>& tell) {
  try {
    measure();
  } catch (const std::exception& error) {
    file.error = error.what();
    keep_and_throw(file, output, json, std::current_exception());
  }
  try {
    flush_lines();  // what was printed on the way may have been lost
    tell();
  } catch (const std::exception&) {
    keep_and_throw(file, output, json, std::current_exception());
  }
  say_saved(keep(file, output, json), json);
}

}  // namespace fathom::cli
