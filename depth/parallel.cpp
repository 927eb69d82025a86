// SPDX-License-Identifier: Apache-2.0
#include "depth/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "depth/interruption.hpp"

namespace fathom::depth {
namespace {

/// Parts that threads take one by one.
class Parts {
 public:
  Parts(std::size_t items, std::size_t part,
        const std::function<void(std::size_t, std::size_t)>& work)
      : items_(items), part_(part), work_(work) {}

  /// Until there is none left.
  void take_all() noexcept {
    try {
      for (std::size_t begin; (begin = next_.fetch_add(part_)) < items_;) {
        look_for_interruption();  // asks in the caller's thread alone
        work_(begin, std::min(begin + part_, items_));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      next_ = items_;
    }
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::size_t items_, part_;
  const std::function<void(std::size_t, std::size_t)>& work_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

void share_out(std::size_t items, std::size_t part, int threads,
               const std::function<void(std::size_t, std::size_t)>& work) {
  part = std::max<std::size_t>(part, 1);
  Parts parts(items, part, work);
  std::vector<std::thread> others;
  const std::size_t helpers =
      std::min<std::size_t>(std::max(threads, 1), (items + part - 1) / part);
  try {
    for (std::size_t i = 1; i < helpers; ++i) others.emplace_back([&parts] { parts.take_all(); });
  } catch (const std::system_error&) {  // those that could be started do it
  }
  parts.take_all();
  for (std::thread& other : others) other.join();
  parts.rethrow();
}

}  // namespace fathom::depth
