// SPDX-License-Identifier: Apache-2.0
#include "session/capture_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "pictures/picture.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, int error_number) {
  throw Error(ErrorCode::io, fmt::format("cannot capture into {}: {}", folder.string(),
                                         std::generic_category().message(error_number)));
}

}  // namespace

CaptureFolder::CaptureFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code problem;
  if (fs::exists(folder_, problem) && !fs::is_directory(folder_, problem)) require_empty();
  is_new_ = fs::create_directories(folder_, problem);
  if (problem) fail(folder_, problem.value());
  try {
    lock();
    require_empty();
    write_manifest();
  } catch (...) {  // a constructor that throws has no destructor
    if (is_new_) ::rmdir(folder_.c_str());
    if (lock_ >= 0) ::close(lock_);
    throw;
  }
}

CaptureFolder::~CaptureFolder() {
  if (manifest_.entries.empty()) {
    ::unlink((folder_ / kManifestName).c_str());
    if (is_new_) ::rmdir(folder_.c_str());
  }
  ::close(lock_);
}

void CaptureFolder::require_empty() const {
  std::error_code problem;
  if (fs::is_directory(folder_, problem) && fs::is_empty(folder_, problem)) return;
  if (problem) fail(folder_, problem.value());
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("{} exists and is not an empty folder; name a new one", folder_.string()));
}

/// A file system without such locks has the manifest, which the second of two captures finds.
void CaptureFolder::lock() {
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail(folder_, errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw Error(ErrorCode::unavailable,
              fmt::format("another capture writes into {}; name a new folder", folder_.string()));
}

void CaptureFolder::write_manifest() const {
  write_file(folder_ / kManifestName, manifest_text(manifest_));
}

void CaptureFolder::describe(const std::string& unit, double coarse_spacing) {
  manifest_.unit = unit;
  if (coarse_spacing > 0) manifest_.coarse_spacing = coarse_spacing;  // 0: nobody knows
  write_manifest();
}

void CaptureFolder::add(const Frame& picture, double position) {
  const std::string file = fmt::format("frame_{:05}.png", manifest_.entries.size());
  write_picture(folder_ / file, picture);
  manifest_.entries.push_back({file, position});
  try {
    write_manifest();
  } catch (...) {
    manifest_.entries.pop_back();
    ::unlink((folder_ / file).c_str());  // nobody would know where it was taken
    throw;
  }
}

}  // namespace fathom
