// SPDX-License-Identifier: Apache-2.0
#include "engine/cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom {
namespace {

constexpr std::uintmax_t kLargest = std::uintmax_t{256} << 20;

std::filesystem::path absolute_path_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr || value[0] != '/') return {};  // relative ones are to be ignored (XDG)
  return value;
}

/// The first line of a file: what the rest must be.
std::string heading(std::string_view key, std::string_view bytes) {
  return fmt::format("fathom cache 1 {:016x} {} {:016x}\n", hash_of(key), bytes.size(),
                     hash_of(bytes));
}

}  // namespace

std::uint64_t hash_of(std::string_view bytes, std::uint64_t seed) {
  for (const char byte : bytes) seed = (seed ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return seed;
}

std::filesystem::path cache_folder() {
  const char* const wished = std::getenv("FATHOM_CACHE");
  if (wished != nullptr && wished == std::string_view("none")) return {};
  if (const auto folder = absolute_path_in("FATHOM_CACHE"); !folder.empty()) return folder;
  if (const auto folder = absolute_path_in("XDG_CACHE_HOME"); !folder.empty()) {
    return folder / "fathom";
  }
  const auto home = absolute_path_in("HOME");
  return home.empty() ? home : home / ".cache" / "fathom";
}

std::optional<std::string> read_cached(std::string_view name, std::string_view key) {
  const auto folder = cache_folder();
  std::error_code problem;
  if (folder.empty() || !std::filesystem::is_regular_file(folder / name, problem)) return {};
  try {
    std::string file = read_file(folder / name, kLargest);
    const std::size_t end = file.find('\n') + 1;  // 0 if there is none
    const std::string_view bytes = std::string_view(file).substr(end);
    if (file.compare(0, end, heading(key, bytes)) != 0) return {};
    return file.substr(end);
  } catch (const Error&) {
    return {};
  }
}

bool write_cached(std::string_view name, std::string_view key, std::string_view bytes) {
  const auto folder = cache_folder();
  if (folder.empty() || bytes.size() > kLargest / 2) return false;
  try {
    write_file(folder / name, heading(key, bytes).append(bytes));
    return true;
  } catch (const Error&) {
    return false;
  }
}

CacheLock::CacheLock(std::string_view name) {
  const auto folder = cache_folder();
  if (folder.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const std::string path = folder / fmt::format("{}.lock", name);
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) return;
  constexpr std::chrono::milliseconds kPause(20), kLongest(60'000);
  for (auto waited = kPause; waited < kLongest; waited += kPause) {
    if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    std::this_thread::sleep_for(kPause);
  }
}

CacheLock::~CacheLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace fathom
