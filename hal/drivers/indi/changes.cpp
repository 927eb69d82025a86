// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/changes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::indi {
namespace {

// For all of them: at first, a pause before those that were refused, and these once more.
constexpr std::int64_t kPutBack_ns = 2'000'000'000;
constexpr std::int64_t kPause_ns = 200'000'000;
constexpr std::int64_t kOnceMore_ns = 800'000'000;

/// Whether a property stands as another one does.
bool is_alike(const Property& a, const Property& b) {
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                    [](const Value& x, const Value& y) {
                      const bool is_same_number =
                          x.number == y.number || (std::isnan(x.number) && std::isnan(y.number));
                      return x.name == y.name && is_same_number && x.is_on == y.is_on;
                    });
}

}  // namespace

void Changes::remember(const Property& property) {
  const bool is_known = std::any_of(found_.begin(), found_.end(),
                                    [&](const Property& p) { return p.name == property.name; });
  if (!is_known) found_.push_back(property);
}

void Changes::set_numbers(const std::string& name, const std::vector<NumberWish>& wishes) {
  const Property& property = client_.need(device_, name);
  const bool stands = std::all_of(wishes.begin(), wishes.end(), [&](const NumberWish& wish) {
    const Value* value = property.find(wish.first);
    return value != nullptr && value->number == wish.second;
  });
  if (stands) return;
  remember(property);
  client_.set_numbers(device_, name, wishes);
}

void Changes::set_switch(const std::string& name, const std::string& value) {
  const Property& property = client_.need(device_, name);
  const Value* wished = property.find(value);
  if (wished != nullptr && wished->is_on) return;
  remember(property);
  client_.set_switch(device_, name, value);
}

void Changes::put_back(const Property& found) {
  const Property* now = client_.devices().find(device_, found.name);
  if (now == nullptr || is_alike(*now, found)) return;
  if (found.kind == Kind::number) {
    std::vector<NumberWish> wishes;
    for (const Value& value : found.values) {
      if (now->find(value.name) != nullptr) wishes.emplace_back(value.name, value.number);
    }
    return client_.send_numbers(*now, wishes);
  }
  for (const Value& value : found.values) {
    if (value.is_on && now->find(value.name) != nullptr) client_.send_switch(*now, value.name);
  }
}

/// Those that do not stand as wanted in the end.
std::vector<Property> Changes::put_back_all(std::vector<Property> wanted,
                                            std::int64_t deadline_ns) {
  const auto stands = [&](const Property& found) {
    const Property* now = client_.devices().find(device_, found.name);
    return now == nullptr || (is_alike(*now, found) && now->state != State::busy);
  };
  // One after the other: a frame may depend on the binning.
  for (const Property& found : wanted) {
    const Property* const before = client_.devices().find(device_, found.name);
    const std::uint64_t serial = before == nullptr ? 0 : before->serial;
    put_back(found);
    const auto is_answered = [&] {
      const Property* now = client_.devices().find(device_, found.name);
      return stands(found) || (now->serial != serial && now->state == State::alert);
    };
    client_.wait(is_answered, deadline_ns);
  }
  std::erase_if(wanted, stands);
  return wanted;
}

Changes::~Changes() {
  try {
    client_.drain();
    std::reverse(found_.begin(), found_.end());
    const std::vector<Property> refused = put_back_all(found_, monotonic_now_ns() + kPutBack_ns);
    if (refused.empty()) return;
    // What was in the way may be over by now: an exposure, or another setting.
    client_.wait([] { return false; }, monotonic_now_ns() + kPause_ns);
    put_back_all(refused, monotonic_now_ns() + kOnceMore_ns);
  } catch (...) {  // the server is gone, and with it who could put anything back
  }
}

}  // namespace fathom::indi
