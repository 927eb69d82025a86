// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/system.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "hal/clock.hpp"

namespace fathom::v4l2 {
namespace {

namespace fs = std::filesystem;

class RealSystem final : public System {
 public:
  int open(const std::string& path) override {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return descriptor >= 0 ? descriptor : -errno;
  }

  void close(int descriptor) override { ::close(descriptor); }

  int ioctl(int descriptor, unsigned long request, void* argument) override {
    return ::ioctl(descriptor, request, argument) < 0 ? -errno : 0;
  }

  int poll(int descriptor, std::chrono::milliseconds timeout) override {
    pollfd wanted{descriptor, POLLIN, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(timeout.count()));
    if (ready < 0) return -errno;
    return ready == 0 ? 0 : wanted.revents;
  }

  void* map(int descriptor, std::size_t length, std::int64_t offset) override {
    // Some drivers refuse a mapping that cannot be written to.
    void* const memory =
        ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, offset);
    return memory == MAP_FAILED ? nullptr : memory;
  }

  void unmap(void* memory, std::size_t length) override { ::munmap(memory, length); }

  std::int64_t now_ns() override { return monotonic_now_ns(); }
  void sleep_until_ns(std::int64_t time_ns) override { fathom::sleep_until_ns(time_ns); }

  std::vector<std::string> list(const std::string& folder) override {
    std::vector<std::string> paths;
    std::error_code missing;
    for (fs::directory_iterator entry(folder, missing), end; !missing && entry != end;
         entry.increment(missing)) {
      paths.push_back(entry->path().string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
  }

  std::string resolve(const std::string& path) override {
    std::error_code missing;
    const fs::path resolved = fs::canonical(path, missing);
    return missing ? path : resolved.string();
  }
};

}  // namespace

System& real_system() {
  static RealSystem system;
  return system;
}

}  // namespace fathom::v4l2
