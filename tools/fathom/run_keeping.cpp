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
#include "focus/track.hpp"
#include "session/saturation.hpp"
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

bool has_measurements(const RunFile& record) {
  for (const Run& run : record.runs) {
    if (!run.measurements.empty()) return true;
  }
  return false;
}

void say_saved(const std::filesystem::path& path, bool json) {
  const std::string line = fmt::format("record saved to {}", path.string());
  if (json) {
    note(line);
  } else {
    print_line(line);
  }
}

void save_by_default(const RunFile& record, bool json) {
  const std::filesystem::path path = default_record_path(record.setup.verb);
  try {
    write_file(path, record.json());
    say_saved(path, json);
  } catch (const Error& error) {
    note(fmt::format("the record is lost: {}; name a file with -o", error.what()));
  }
}

void save(const RunFile& record, const std::string& output, bool json) {
  if (output.empty()) return save_by_default(record, json);
  try {
    write_file(output, record.json());
  } catch (const Error&) {
    save_by_default(record, json);
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

RunFile start_record(const std::string& verb, Rig& rig) {
  RunFile record;
  record.setup = {verb,
                  command_line(),
                  utc_time("{:%Y-%m-%dT%H:%M:%SZ}"),
                  rig.options().rig,
                  rig.camera().description(),
                  rig.lens().info(),
                  rig.spec(),
                  rig.window(),
                  rig.selection().backend,
                  rig.selection().reason,
                  rig.options().shot.average};
  return record;
}

std::filesystem::path default_record_path(const std::string& verb) {
  namespace fs = std::filesystem;
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder = state != nullptr && *state != '\0' ? fs::path(state)
                    : home != nullptr && *home != '\0' ? fs::path(home) / ".local" / "state"
                                                       : fs::path(".");
  // The process number keeps two runs in one second apart.
  return folder / "fathom" / "records" /
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

void with_record(RunFile& record, const std::string& output, bool json,
                 const std::function<void()>& body) {
  try {
    body();
  } catch (const std::exception& error) {
    record.error = error.what();
    if (has_measurements(record)) {
      try {
        save(record, output, json);
      } catch (const Error& second) {
        note(second.what());
      }
    }
    throw;
  }
  save(record, output, json);
}

void note_inexact_positions(const Lens& lens, const std::vector<double>& wanted) {
  constexpr int kSaid = 3;
  int inexact = 0;
  for (const double position : wanted) {
    const double nearest = lens.nearest(position);
    if (nearest == position || ++inexact > kSaid) continue;
    note(fmt::format("there is no lens position {}; the nearest, {} {}, is used", position, nearest,
                     lens.info().unit));
  }
  if (inexact > kSaid) note(fmt::format("and so for {} more positions", inexact - kSaid));
}

namespace {

Objective logged_objective(Rig& rig, Run& run,
                           const std::function<void(const Evaluation&)>& on_evaluation) {
  Objective objective = rig.objective(
      [&run](const Measurement& measurement) { run.measurements.push_back(measurement); });
  objective.on_evaluation = on_evaluation;
  return objective;
}

void warn_of_saturation(const Run& run) {
  const std::string warning = saturation_warning(run.measurements, run.focus->position());
  if (!warning.empty()) note(warning);
}

/// A measurement that lost frames is as good as any, for none of them was scored; but a cable or a
/// bus may be at fault.
void warn_of_lost_frames(const FrameCounts& before, const FrameCounts& after) {
  const auto dropped = after.dropped - before.dropped, corrupt = after.corrupt - before.corrupt;
  if (dropped + corrupt == 0) return;
  note(
      fmt::format("the camera lost {} frames, and {} came damaged, beside {} good ones; none of "
                  "them was scored",
                  dropped, corrupt, after.delivered - before.delivered));
}

}  // namespace

Focus track_on_rig(Rig& rig, const Run& before, Run& run,
                   const std::function<void(const Evaluation&)>& on_evaluation) {
  run.limits = before.limits;
  run.repeat_scatter = before.repeat_scatter;
  run.tracks = true;
  run.focus = track_focus(logged_objective(rig, run, on_evaluation), *run.limits, rig.spec(),
                          run.repeat_scatter, *before.focus);
  warn_of_saturation(run);
  return *run.focus;
}

Focus search_on_rig(Rig& rig, const FocusRequest& request, Run& run,
                    const std::function<void(const Evaluation&)>& on_evaluation) {
  FocusRequest here = request;
  if (!here.start) here.start = rig.lens().position();
  const FocusLimits limits = resolve_limits(here, rig.lens().info());
  run.limits = limits;
  std::vector<double> wanted = {limits.from, limits.to};
  if (limits.bracket) wanted.insert(wanted.begin() + 1, limits.bracket->inner);
  note_inexact_positions(rig.lens(), wanted);
  const Objective objective = logged_objective(rig, run, on_evaluation);
  const bool climbs = limits.search == SearchMethod::hill;
  const FrameCounts before = rig.camera().counts();
  run.repeat_scatter = rig.repeat_scatter(climbs ? limits.start : limits.from, kRepeatFrames);
  run.focus = search_focus(objective, limits, rig.spec(), run.repeat_scatter);
  warn_of_saturation(run);
  warn_of_lost_frames(before, rig.camera().counts());
  return *run.focus;
}

}  // namespace fathom::cli
