// SPDX-License-Identifier: Apache-2.0
// What happens, for any number of readers: whoever tells never waits for one of them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::serve {

struct Event {
  std::uint64_t id = 0;  ///< Counts from 1.
  std::string kind;      ///< "score", "state" and so on.
  std::string data;      ///< JSON on one line.
};

/// The newest events, as many as memory was set aside for. Every function may be called from any
/// thread.
class EventFeed {
 public:
  /// How many events are kept for slow readers, and how many bytes of data.
  explicit EventFeed(std::size_t most = 4096, std::size_t most_bytes = 8 << 20)
      : most_(most), most_bytes_(most_bytes) {}

  void tell(std::string_view kind, std::string data);

  /// The id that the next event will have.
  std::uint64_t next() const;

  /// Events from number `from` on, once there is one or the time is up. Nothing where the first of
  /// them is gone already: the reader was too slow.
  std::optional<std::vector<Event>> read(std::uint64_t from, std::chrono::milliseconds timeout);

  /// How many watch now; nobody makes events that are for watchers alone where there are none.
  int readers() const;
  void add_reader(int change);

  /// No reader waits any more.
  void close();
  bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return is_closed_;
  }

 private:
  const std::size_t most_, most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable told_;
  std::deque<Event> events_;
  std::size_t bytes_ = 0;
  std::uint64_t next_ = 1;
  int readers_ = 0;
  bool is_closed_ = false;
};

}  // namespace fathom::serve
