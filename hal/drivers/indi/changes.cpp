// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/changes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::indi {
namespace {

constexpr std::int64_t kPutBack_ns = 2'000'000'000;  // for all of them

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

Changes::~Changes() {
  try {
    const std::int64_t deadline_ns = monotonic_now_ns() + kPutBack_ns;
    client_.drain();
    std::reverse(found_.begin(), found_.end());
    for (const Property& found : found_) {
      put_back(found);
      // One after the other: a frame may depend on the binning.
      client_.wait(
          [&] {
            const Property* now = client_.devices().find(device_, found.name);
            return now == nullptr || (is_alike(*now, found) && now->state != State::busy);
          },
          deadline_ns);
    }
  } catch (...) {  // the server is gone, and with it who could put anything back
  }
}

}  // namespace fathom::indi
