// SPDX-License-Identifier: Apache-2.0
// The newest picture, for any number of watchers. A watcher that is slow misses pictures; nobody
// waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/frame.hpp"

namespace fathom::serve {

/// A picture that many look at. Encoded once for each width, by whoever asks first.
class Picture {
 public:
  Picture(Frame frame, std::uint64_t number, int most_grey)
      : number_(number), frame_(std::move(frame)), most_grey_(most_grey) {}

  const Frame& frame() const { return frame_; }
  std::uint64_t number() const { return number_; }
  /// The grey value that is white, 255 of 8 bit and, say, 4095 of 12.
  int most_grey() const { return most_grey_; }
  std::optional<double> position;  ///< Of the lens, where it is known.
  bool is_settled = false;         ///< The lens stood still while it was exposed.

  /// A JPEG of 8 bit, made narrower by a whole number until it is no wider than `widest_px`; 0: as
  /// it is.
  std::shared_ptr<const std::string> jpeg(int widest_px) const;

 private:
  const std::uint64_t number_;
  const Frame frame_;
  const int most_grey_;
  mutable std::mutex mutex_;
  mutable std::map<int, std::shared_ptr<const std::string>> jpegs_;  ///< By how much narrower.
};

class PictureFeed {
 public:
  /// Copies the frame.
  void show(const Frame& frame, std::optional<double> position, bool is_settled, int most_grey);

  /// A picture with a number above `seen`, or nothing where none comes in time.
  std::shared_ptr<const Picture> next(std::uint64_t seen, std::chrono::milliseconds timeout);
  /// Null before the first one.
  std::shared_ptr<const Picture> newest() const;

  int watchers() const;
  void add_watcher(int change);

  /// Nobody waits any more.
  void close();
  bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return is_closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable shown_;
  std::shared_ptr<const Picture> newest_;
  std::uint64_t count_ = 0;
  int watchers_ = 0;
  bool is_closed_ = false;
};

}  // namespace fathom::serve
