// SPDX-License-Identifier: Apache-2.0
#include "serve/connection_pool.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <system_error>
#include <thread>
#include <utility>

namespace fathom::serve {
namespace {

thread_local bool refuses = false;

void refuse(const std::function<void()>& serve) {
  refuses = true;
  serve();
  refuses = false;
}

/// Whoever watches waits for whoever measures. Linux keeps a niceness for each thread.
void give_way() {
  constexpr int kNice = 10;
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
}

}  // namespace

bool ConnectionPool::is_refusing() { return refuses; }

bool ConnectionPool::begin() {
  const std::lock_guard lock(mutex_);
  if (running_ == most_) return false;
  ++running_;
  return true;
}

void ConnectionPool::end() {
  const std::lock_guard lock(mutex_);
  --running_;
  ended_.notify_all();
}

void ConnectionPool::enqueue(std::function<void()> serve) {
  if (!begin()) return refuse(serve);
  try {
    std::thread([this, serve] {
      give_way();
      serve();
      end();
    }).detach();
  } catch (const std::system_error&) {
    end();
    refuse(serve);
  }
}

void ConnectionPool::shutdown() {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return running_ == 0; });
}

}  // namespace fathom::serve
