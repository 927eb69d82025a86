// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/patience.hpp"

#include <condition_variable>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>

#include "engine/cache.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

constexpr std::chrono::milliseconds kMoment{400};

std::string words_for(Work work, const std::string& subject) {
  const std::string_view once = cache_folder().empty() ? "" : "; the answer is kept";
  switch (work) {
    case Work::listing:
      return fmt::format("asking the drivers of {} for their devices", subject);
    case Work::opening:
      return fmt::format("opening {}; the first time its kernels are compiled", subject);
    case Work::timing:
      return fmt::format("timing {} to choose the fastest device{}", subject, once);
    case Work::done:
      break;
  }
  return {};
}

/// One thing at a time, and a thread only while there is one. What was said once is not said again.
class Patience {
 public:
  Patience() = default;
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;
  ~Patience() { end(); }

  void begin(std::string words) {
    end();
    if (words.empty()) return;
    is_over_ = false;
    try {
      waiting_ = std::thread([this, words = std::move(words)] {
        std::unique_lock lock(mutex_);
        if (!over_.wait_for(lock, kMoment, [this] { return is_over_; }) &&
            said_.insert(words).second) {
          note(words);
        }
      });
    } catch (const std::system_error&) {  // no thread to be had: then nothing is said
    }
  }

 private:
  void end() {
    if (!waiting_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    over_.notify_one();
    waiting_.join();
  }

  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::set<std::string> said_;
  std::thread waiting_;
};

}  // namespace

OnWork patient_words() {
  return [patience = std::make_shared<Patience>()](Work work, const std::string& subject) {
    patience->begin(words_for(work, subject));
  };
}

}  // namespace fathom::cli
