// SPDX-License-Identifier: Apache-2.0
#include "engine/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>
#include <system_error>
#include <utility>

#include "engine/error.hpp"

namespace fathom {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const char* what, const fs::path& path, int error_number) {
  throw Error(ErrorCode::io, fmt::format("cannot {} {}: {}", what, path.string(),
                                         std::generic_category().message(error_number)));
}

/// An open descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  /// Closes now, because a network or quota file system may report a full disk only here.
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

/// Somebody writes into what the process was given; into another pipe perhaps nobody ever does.
bool names_descriptor(const fs::path& path) {
  const fs::path plain = path.lexically_normal(), folder = plain.parent_path();
  return plain == "/dev/stdin" || folder == "/dev/fd" || folder == "/proc/self/fd";
}

void require_end(const fs::path& path) {
  const std::string kind = special_kind(path);
  if ((kind != "pipe" && kind != "socket") || names_descriptor(path)) return;
  throw Error(ErrorCode::bad_data,
              fmt::format("{} is a {} and no file; it is not opened", path.string(), kind));
}

/// 0, or the errno of the first write that failed.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// Opens a new file beside the target, with the permissions that this process gives its files; -1
/// and errno where it cannot. `name` becomes its path.
int open_temporary(const fs::path& target, std::string& name) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    name = fmt::format("{}.{}-{}.tmp", target.string(), ::getpid(), attempt);
    const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

/// Makes an empty file of a name that is free, and tells it.
fs::path reserve(const fs::path& head, std::string_view tail) {
  std::random_device random;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const fs::path path = fmt::format("{}-{:08x}{}", head.string(), random(), tail);
    const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.get() >= 0) return path;
    if (errno != EEXIST) fail("write", path, errno);
  }
  fail("write", head, EEXIST);
}

void make_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) fail("make the folder", folder, problem.value());
}

void write_in_place(const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) fail("write", path, errno);
  if (const int problem = write_all(file.get(), bytes)) fail("write", path, problem);
}

}  // namespace

std::string special_kind(const fs::path& path) {
  std::error_code ignored;
  const fs::file_type type = fs::status(path, ignored).type();
  if (type == fs::file_type::fifo) return "pipe";
  if (type == fs::file_type::socket) return "socket";
  if (type == fs::file_type::block || type == fs::file_type::character) return "device";
  return {};
}

std::string read_file(const fs::path& path, std::uintmax_t limit_bytes) {
  std::error_code status;
  if (fs::is_directory(path, status)) fail("read", path, EISDIR);
  require_end(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) fail("read", path, errno != 0 ? errno : ENOENT);
  std::string bytes;
  char block[1 << 16];
  while (file.read(block, sizeof block), file.gcount() > 0) {
    bytes.append(block, static_cast<std::size_t>(file.gcount()));
    if (bytes.size() > limit_bytes) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} is larger than {} bytes; is it the right file?", path.string(),
                              limit_bytes));
    }
  }
  if (file.bad()) fail("read", path, EIO);
  return bytes;
}

void write_file(const fs::path& path, std::string_view bytes) {
  std::error_code ignored;
  const fs::path target = fs::is_symlink(path, ignored) ? fs::canonical(path, ignored) : path;
  if (target.empty()) fail("write", path, ENOENT);
  if (fs::is_directory(target, ignored)) fail("write", path, EISDIR);
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) {
    return write_in_place(target, bytes);
  }
  if (target.has_parent_path()) make_folder(target.parent_path());
  std::string temporary;
  Descriptor file(open_temporary(target, temporary));
  if (file.get() < 0) fail("write", path, errno);
  int problem = write_all(file.get(), bytes);
  if (problem == 0 && ::fsync(file.get()) != 0 && errno != EINVAL) problem = errno;
  struct stat old {};
  if (problem == 0 && ::stat(target.c_str(), &old) == 0 &&
      ::fchmod(file.get(), old.st_mode & 07777) != 0) {
    problem = errno;  // a private file stays private
  }
  if (!file.close() && problem == 0) problem = errno;
  if (problem == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) problem = errno;
  if (problem != 0) {
    ::unlink(temporary.c_str());
    fail("write", path, problem);
  }
}

fs::path write_new_file(const fs::path& head, std::string_view tail, std::string_view bytes) {
  if (head.has_parent_path()) make_folder(head.parent_path());
  const fs::path path = reserve(head, tail);
  try {
    write_file(path, bytes);
  } catch (...) {
    ::unlink(path.c_str());
    throw;
  }
  return path;
}

}  // namespace fathom
