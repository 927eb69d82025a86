// SPDX-License-Identifier: Apache-2.0
#include "engine/process.hpp"

#include <pthread.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace fathom {
namespace {

std::atomic<unsigned> fork_count = 0;

/// Holds threads until they all are there.
class Gate {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [this] { return is_open_; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    opened_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool is_open_ = false;
};

}  // namespace

unsigned forks() {
  static const int watched = ::pthread_atfork(nullptr, nullptr, [] { ++fork_count; });
  static_cast<void>(watched);
  return fork_count.load(std::memory_order_relaxed);
}

std::size_t startable_threads(std::size_t wanted) {
  Gate gate;
  std::vector<std::thread> threads;
  try {
    threads.reserve(wanted);
    while (threads.size() < wanted) threads.emplace_back([&gate] { gate.wait(); });
  } catch (const std::system_error&) {
    // As many as there are.
  }
  gate.open();
  for (std::thread& thread : threads) thread.join();
  return threads.size();
}

bool can_start_drivers() {
  constexpr std::size_t kOthers = 4;  // of compilers, caches and queues
  const std::size_t wanted = std::thread::hardware_concurrency() + kOthers;
  return startable_threads(wanted) == wanted;
}

}  // namespace fathom
