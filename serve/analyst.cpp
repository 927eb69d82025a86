// SPDX-License-Identifier: Apache-2.0
// What is told of pictures beside their scores: histogram, exposure, spectrum. On a thread of its
// own, because a measurement must not wait for it.
#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "serve/base64.hpp"
#include "serve/operator.hpp"
#include "session/grey_levels.hpp"
#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kBins = 64;

/// How many pictures a second there were of late.
class Pace {
 public:
  double per_s(std::uint64_t number, std::int64_t now) {
    seen_.push_back({now, number});
    while (seen_.size() > 2 && now - seen_.front().ns > kSecond) seen_.pop_front();
    const Seen& first = seen_.front();
    if (now == first.ns) return 0;
    return static_cast<double>(number - first.number) * kSecond /
           static_cast<double>(now - first.ns);
  }

 private:
  struct Seen {
    std::int64_t ns;
    std::uint64_t number;
  };
  std::deque<Seen> seen_;
};

}  // namespace

void Operator::tell_frame(const Picture& picture, double per_s) {
  const GreyLevels greys =
      grey_levels_of(picture.frame(), static_cast<std::uint32_t>(picture.most_grey()), kBins);
  std::vector<double> histogram;
  for (const std::size_t pixels : greys.histogram) histogram.push_back(greys.part(pixels));
  JsonLine line;
  line.add_json("stamp_ns", std::to_string(picture.frame().exposure.start_ns)).add("fps", per_s);
  picture.position ? line.add("position", *picture.position) : line.add_null("position");
  line.add("mean", greys.mean / picture.most_grey()).add("histogram", histogram);
  publisher_.events.tell(
      "frame",
      line.add("under", greys.part(greys.black)).add("over", greys.part(greys.white)).text());
}

void Operator::tell_spectrum(const Picture& picture) {
  const std::shared_ptr<LiveScores> now = scores();
  const std::string bytes = base64(now->spectrum(picture.frame()));
  publisher_.events.tell("spectrum",
                         JsonLine().add("n", now->windows()[0].n).add("db", bytes).text());
}

void Operator::analyse() {
  constexpr std::chrono::milliseconds kApart{100};
  Pace pace;
  std::uint64_t seen = 0;
  for (bool is_odd = false; !is_ending_;) {
    const auto picture = publisher_.pictures.next(seen, std::chrono::seconds(1));
    if (!picture || publisher_.events.readers() == 0) {
      if (picture) seen = picture->number();
      continue;
    }
    seen = picture->number();
    try {
      tell_frame(*picture, pace.per_s(seen, monotonic_now_ns()));
      if (is_odd) tell_spectrum(*picture);
    } catch (const Error& error) {
      publisher_.warn(error.what());
    }
    is_odd = !is_odd;
    std::unique_lock lock(mutex_);
    wakes_.wait_for(lock, kApart, [this] { return is_ending_.load(); });
  }
}

}  // namespace fathom::serve
