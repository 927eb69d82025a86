// SPDX-License-Identifier: Apache-2.0
// A thread for each connection, and no more connections than there may be.
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>

namespace fathom::serve {

class ConnectionPool final : public httplib::TaskQueue {
 public:
  explicit ConnectionPool(std::size_t most) : most_(most) {}

  /// Runs it on a thread of its own. Where there are too many already, or the system gives no
  /// thread, it is run at once, and is_refusing() is true meanwhile.
  void enqueue(std::function<void()> serve) override;
  /// Waits until all have ended.
  void shutdown() override;

  /// Whether what runs on this thread is one connection too many.
  static bool is_refusing();

 private:
  bool begin();
  void end();

  std::size_t most_;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t running_ = 0;
};

}  // namespace fathom::serve
