// SPDX-License-Identifier: Apache-2.0
#include "session/run_store.hpp"

#include <fmt/chrono.h>

#include <chrono>
#include <cstdlib>

#include "engine/file.hpp"

namespace fathom {
namespace {

std::string utc_time(const char* format) {
  return fmt::format(fmt::runtime(format), fmt::gmtime(std::chrono::system_clock::now()));
}

/// A folder that a variable names; relative ones are to be ignored (XDG).
std::filesystem::path folder_in(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value == '/' ? value : "";
}

}  // namespace

std::filesystem::path state_folder() {
  const std::filesystem::path state = folder_in("XDG_STATE_HOME");
  if (!state.empty()) return state / "fathom";
  const std::filesystem::path home = folder_in("HOME");
  return home.empty() ? home : home / ".local" / "state" / "fathom";
}

std::string utc_now() { return utc_time("{:%Y-%m-%dT%H:%M:%SZ}"); }
std::string utc_for_name() { return utc_time("{:%Y-%m-%dT%H-%M-%S}"); }

std::filesystem::path keep_run(const std::filesystem::path& folder, const RunFile& file) {
  return write_new_file(folder / (utc_for_name() + "-" + file.setup.verb), ".json", file.json());
}

bool is_newer_run(const std::filesystem::path& a, const std::filesystem::path& b) {
  constexpr std::size_t kTime = 19;  // of utc_for_name()
  const std::string of_a = a.filename().string().substr(0, kTime);
  const std::string of_b = b.filename().string().substr(0, kTime);
  if (of_a != of_b) return of_a > of_b;
  std::error_code none;
  return std::filesystem::last_write_time(a, none) > std::filesystem::last_write_time(b, none);
}

}  // namespace fathom
