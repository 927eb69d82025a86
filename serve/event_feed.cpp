// SPDX-License-Identifier: Apache-2.0
#include "serve/event_feed.hpp"

#include <iterator>
#include <utility>

namespace fathom::serve {

void EventFeed::tell(std::string_view kind, std::string data) {
  const std::lock_guard lock(mutex_);
  bytes_ += data.size();
  events_.push_back({next_++, std::string(kind), std::move(data)});
  while (events_.size() > most_ || bytes_ > most_bytes_) {
    bytes_ -= events_.front().data.size();
    events_.pop_front();
  }
  told_.notify_all();
}

std::uint64_t EventFeed::next() const {
  const std::lock_guard lock(mutex_);
  return next_;
}

std::optional<std::vector<Event>> EventFeed::read(std::uint64_t from,
                                                  std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  told_.wait_for(lock, timeout, [&] { return next_ > from || is_closed_; });
  const std::uint64_t oldest = next_ - events_.size();
  if (from < oldest) return std::nullopt;
  if (from >= next_) return std::vector<Event>();
  return std::vector<Event>(std::next(events_.begin(), static_cast<long>(from - oldest)),
                            events_.end());
}

int EventFeed::readers() const {
  const std::lock_guard lock(mutex_);
  return readers_;
}

void EventFeed::add_reader(int change) {
  const std::lock_guard lock(mutex_);
  readers_ += change;
}

void EventFeed::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  told_.notify_all();
}

}  // namespace fathom::serve
