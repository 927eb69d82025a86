// SPDX-License-Identifier: Apache-2.0
#include "hal/whereabouts.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/json.hpp"

namespace fathom {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-lens-position";
constexpr int kVersion = 1;
constexpr std::uintmax_t kLargestFile = 1 << 16;

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

/// A rename lasts over a power cut only once its folder is on the disk too.
void flush_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int problem = fd < 0 ? errno : ::fsync(fd) != 0 ? errno : 0;
  if (fd >= 0) ::close(fd);
  if (problem == 0 || problem == EINVAL) return;  // some file systems cannot, and need not
  throw Error(ErrorCode::io,
              fmt::format("cannot flush the folder {}: {}", folder.string(), reason_of(problem)));
}

/// The process that wrote its number into a lock, for messages.
std::string holder_of(int lock) {
  char text[32] = {};
  const ssize_t length = ::pread(lock, text, sizeof text - 1, 0);
  const long number = length > 0 ? std::strtol(text, nullptr, 10) : 0;
  return number > 0 ? fmt::format("process {}", number) : std::string("another program");
}

Json headed(const Owner& owner) {
  return {{"format", kFormat}, {"version", kVersion}, {"motor", owner.motor}};
}

void write(const fs::path& path, const Json& json) {
  // A name that is no UTF-8 is written with marks in it, and then never recognised: safe.
  write_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Nothing for a position that is no whole number of the travel.
std::optional<Standing> standing_from(const Json& json, const Owner& owner) {
  if (!json.at("position").is_number_integer()) return std::nullopt;
  const auto position = json["position"].get<double>();  // an integer of any size has one
  if (position < owner.lowest || position > owner.highest) return std::nullopt;
  const bool has_same_play = json.at("backlash") == owner.backlash;
  return Standing{static_cast<int>(position), json.at("approached").get<bool>() && has_same_play};
}

}  // namespace

Whereabouts::Whereabouts(fs::path path, Owner owner)
    : path_(std::move(path)), owner_(std::move(owner)) {
  lock();
  try {
    read();
  } catch (...) {  // a constructor that throws has no destructor
    ::close(lock_);
    throw;
  }
}

Whereabouts::~Whereabouts() {
  if (lock_ >= 0) ::close(lock_);
}

void Whereabouts::lock() {
  const std::string name = path_.string() + ".lock";
  std::error_code problem;
  if (path_.has_parent_path()) fs::create_directories(path_.parent_path(), problem);
  lock_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  // Another user's lock can be held without writing to it.
  if (lock_ < 0 && errno == EACCES) lock_ = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  const int error = lock_ < 0 ? errno : ::flock(lock_, LOCK_EX | LOCK_NB) != 0 ? errno : 0;
  if (error == 0) {
    const std::string number = fmt::format("{:<20}\n", ::getpid());
    // Only a courtesy to whoever finds it locked.
    [[maybe_unused]] const ssize_t written = ::pwrite(lock_, number.data(), number.size(), 0);
    return;
  }
  const std::string holder = lock_ < 0 ? "" : holder_of(lock_);
  if (lock_ >= 0) ::close(lock_);
  if (error == EWOULDBLOCK) {
    throw Error(ErrorCode::unavailable,
                fmt::format("the motor on {} is in use by {}, which holds {}; end it first",
                            owner_.motor, holder, name));
  }
  throw Error(ErrorCode::io,
              fmt::format("cannot lock {}: {}; the lens's position is kept beside it, in a file "
                          "that state = PATH can put elsewhere",
                          name, reason_of(error)));
}

void Whereabouts::read() {
  std::error_code ignored;
  if (!fs::exists(path_, ignored)) {
    reason_ = fmt::format("nobody has told yet, there is no {}", path_.string());
    return;
  }
  const std::string text = read_file(path_, kLargestFile);
  try {
    const Json json = parse_json(text);
    if (json.at("format") != kFormat || json.at("version") != kVersion) {
      reason_ = fmt::format("{} is of another program", path_.string());
    } else if (json.at("motor") != owner_.motor) {
      reason_ = fmt::format("{} was written for another motor or travel: {}", path_.string(),
                            json.at("motor").get<std::string>());
    } else if (json.contains("doing")) {
      reason_ = fmt::format("a program was cut off while {} ({})",
                            json.at("doing").get<std::string>(), path_.string());
    } else {
      standing_ = standing_from(json, owner_);
    }
  } catch (const Json::exception&) {
  } catch (const Error&) {
  }
  if (!standing_ && reason_.empty()) reason_ = fmt::format("{} is damaged", path_.string());
}

void Whereabouts::leave(const std::string& doing) {
  Json json = headed(owner_);
  json["doing"] = doing;
  write(path_, json);
  flush_folder_of(path_);  // arrive() need not: what it replaces is safe to believe
  standing_.reset();
  reason_ = fmt::format("it was cut off while {}", doing);
}

void Whereabouts::arrive(const Standing& standing) {
  standing_ = standing;
  Json json = headed(owner_);
  json["position"] = standing.position;
  json["approached"] = standing.is_approached;
  json["backlash"] = owner_.backlash;
  write(path_, json);
}

fs::path default_state_path(const std::string& lines_name) {
  const auto absolute = [](const char* variable) {
    const char* const value = std::getenv(variable);
    // A relative folder would be another one from every place, and the motor is the same.
    return value != nullptr && *value == '/' ? fs::path(value) : fs::path();
  };
  fs::path folder = absolute("XDG_STATE_HOME");
  if (folder.empty() && !absolute("HOME").empty()) folder = absolute("HOME") / ".local" / "state";
  if (folder.empty()) {
    throw Error(ErrorCode::unavailable,
                fmt::format("no place to keep the position of the motor on {}: neither "
                            "XDG_STATE_HOME nor HOME is an absolute path; name a file with "
                            "state = PATH",
                            lines_name));
  }
  std::string file;
  for (const char c : lines_name) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_plain || c == '_') {
      file += c;
    } else if (!file.empty() && file.back() != '-') {
      file += '-';
    }
  }
  while (file.ends_with('-')) file.pop_back();
  return folder / "fathom" / "lenses" / (file + ".json");
}

}  // namespace fathom
