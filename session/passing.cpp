// SPDX-License-Identifier: Apache-2.0
#include "session/passing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Nothing where the motion does not know it. A motor that failed says why.
std::optional<Where> place_of(Motion& motion, const Frame& frame) {
  try {
    return motion.during(frame.exposure);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_argument) return std::nullopt;
    if (error.code() == ErrorCode::unavailable) motion.wait();
    throw;
  }
}

class Passing {
 public:
  Passing(const PassingRules& rules, std::int64_t since_ns, const FramePassed& passed)
      : rules_(rules), since_ns_(since_ns), passed_(passed) {
    if (rules.seen_at) last_ = *rules.seen_at;
  }

  /// Whether to go on.
  bool see(const Frame& frame, const std::optional<Where>& where) {
    if (!where || !(where->sigma <= rules_.most_sigma)) {
      ++passage_.unplaced;
      return ++in_a_row_ < rules_.most_unplaced;
    }
    in_a_row_ = 0;
    if (where->smear > rules_.most_smear) {
      ++passage_.smeared;
    } else if (is_apart(where->position)) {
      return tell(frame, *where);
    }
    return true;
  }

  /// When the lens will be far enough from the place of the last frame at the pace that it had then.
  std::int64_t next_ns() const { return next_ns_; }

  Passage ended(const Arrival& arrival, bool is_cut) const {
    Passage passage = passage_;
    passage.arrival = arrival;
    passage.is_cut = is_cut;
    return passage;
  }

 private:
  /// Two frames of one place are one point of a curve.
  bool is_apart(double position) const {
    const double distance = std::abs(position - last_);
    return distance > 0 && distance >= rules_.apart;
  }

  /// Until it has gone as far again, at the pace since the frame before.
  std::int64_t wait_ns(double gone, std::int64_t lasted_ns) const {
    constexpr double kOfTheWay = 0.9;  // a pace is no promise
    constexpr double kLongest_ns = 5e8;
    if (!std::isfinite(gone) || !(gone > 0)) return 0;
    return static_cast<std::int64_t>(
        std::min(kOfTheWay * rules_.apart / gone * static_cast<double>(lasted_ns), kLongest_ns));
  }

  bool tell(const Frame& frame, const Where& where) {
    const Exposure& exposure = frame.exposure;
    const double gone = std::abs(where.position - std::exchange(last_, where.position));
    next_ns_ = exposure.start_ns + wait_ns(gone, exposure.start_ns - since_ns_);
    const Arrival way{.position = where.position,
                      .started_ns = since_ns_,
                      .stopped_ns = exposure.start_ns,
                      .settled_ns = exposure.start_ns};
    since_ns_ = exposure.end_ns;
    return passed_(frame, way, where);
  }

  const PassingRules& rules_;
  std::int64_t since_ns_, next_ns_ = 0;
  const FramePassed& passed_;
  Passage passage_;
  int in_a_row_ = 0;                                        // that are unplaced
  double last_ = -std::numeric_limits<double>::infinity();  // no frame yet
};

/// What is not looked at on the way is looked at afterwards.
class SkipsOnTheWay {
 public:
  explicit SkipsOnTheWay(Camera& camera) : camera_(camera) {}
  SkipsOnTheWay(const SkipsOnTheWay&) = delete;
  SkipsOnTheWay& operator=(const SkipsOnTheWay&) = delete;
  ~SkipsOnTheWay() { camera_.skip_until(0); }

  void until(std::int64_t time_ns) { camera_.skip_until(time_ns); }

 private:
  Camera& camera_;
};

}  // namespace

Passage take_passing(Camera& camera, Lens& lens, double to, std::int64_t since_ns,
                     const PassingRules& rules, const ShotOptions& options,
                     const FramePassed& passed) {
  const std::unique_ptr<Motion> motion = lens.start(to);
  Passing passing(rules, since_ns, passed);
  SkipsOnTheWay skips(camera);
  for (;;) {
    const std::optional<Arrival> arrived = motion->arrived();
    if (arrived) {
      require_arrival(lens, to, *arrived);
      if (!rules.ends_at_rest) return passing.ended(*arrived, false);
    }
    skips.until(passing.next_ns());
    const Frame frame = take_one(camera, since_ns, options);
    if (!passing.see(frame, place_of(*motion, frame))) {
      motion->stop();
      return passing.ended(motion->wait(), true);
    }
    if (arrived && frame.exposure.start_ns >= arrived->settled_ns)
      return passing.ended(*arrived, false);
  }
}

}  // namespace fathom
