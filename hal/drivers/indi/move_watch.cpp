// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/move_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom::indi {
namespace {

constexpr double kPartOfWay = 1e-3;
constexpr double kMostSteps = 1e9;

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

MoveWatch::MoveWatch(const MoveOrder& order)
    : order_(order),
      least_(order.goal ? std::abs(*order.goal - order.from) : order.steps),
      quantum_(std::max(kPartOfWay * least_, 1.0)),
      said_(std::numeric_limits<double>::quiet_NaN()),
      since_ns_(order.now_ns) {}

double MoveWatch::beside() const { return std::abs(said_ - *order_.goal); }

bool MoveWatch::has_come_nearer() {
  const double left = order_.goal ? beside() : std::abs(said_);
  if (!(left <= least_ - quantum_)) return false;
  least_ = left;
  return true;
}

/// A driver that does not count may repeat the end of the move before. So it is believed only once
/// it has been busy, or has had a while to become so. One that counts may do so as well: beside its
/// goal it is believed at once only where it has come from farther away.
bool MoveWatch::is_there(const Property& property, std::int64_t now_ns) const {
  if (is_busy_) return false;
  const bool rests = now_ns - since_ns_ >= order_.rest_ns;
  if (!order_.goal) return property.busy_serial > order_.before || rests;
  if (beside() < 0.5) return true;
  return rests && is_beside() && beside() <= std::abs(*order_.goal - order_.from) / 2;
}

MoveWord MoveWatch::heed(const Property& property, double said, std::int64_t now_ns) {
  if (property.serial == order_.before) return MoveWord::nothing;
  if (property.state == State::alert) return MoveWord::failed;
  const bool is_busy = property.state == State::busy;
  if (!has_answered_ || !is_same(said, said_) || is_busy != is_busy_) since_ns_ = now_ns;
  has_answered_ = true;
  is_busy_ = is_busy;
  said_ = said;
  if (order_.goal && !(std::abs(said) <= kMostSteps)) return MoveWord::nonsense;
  if (is_there(property, now_ns)) return MoveWord::arrived;
  const bool begins = is_busy && !has_begun_;
  has_begun_ = has_begun_ || is_busy;
  return has_come_nearer() || begins ? MoveWord::progress : MoveWord::nothing;
}

}  // namespace fathom::indi
