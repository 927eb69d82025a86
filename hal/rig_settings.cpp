// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "engine/error.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& key, const std::string& value,
                         const std::string& wanted) {
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {}={} is not {}", where, key, value, wanted));
}

template <class Number>
Number parse(const std::string& where, const std::string& key, const std::string& text,
             Number lowest, Number highest) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  // The comparison is written so that a NaN fails it.
  if (problem != std::errc() || next != end || !(value >= lowest && value <= highest)) {
    refuse(where, key, text, fmt::format("a number from {} to {}", lowest, highest));
  }
  return value;
}

}  // namespace

const std::string* RigSettings::find(const std::string& key) const {
  known_.insert(key);
  const auto found = values_.find(key);
  return found == values_.end() ? nullptr : &found->second;
}

std::string RigSettings::text(const std::string& key, const std::string& fallback) const {
  const std::string* value = find(key);
  return value != nullptr ? *value : fallback;
}

double RigSettings::number(const std::string& key, double fallback, double lowest,
                           double highest) const {
  const std::string* value = find(key);
  return value != nullptr ? parse(where_, key, *value, lowest, highest) : fallback;
}

long long RigSettings::integer(const std::string& key, long long fallback, long long lowest,
                               long long highest) const {
  const std::string* value = find(key);
  return value != nullptr ? parse(where_, key, *value, lowest, highest) : fallback;
}

std::optional<double> RigSettings::number_if_given(const std::string& key, double lowest,
                                                   double highest) const {
  const double value = number(key, lowest, lowest, highest);
  return has(key) ? std::optional(value) : std::nullopt;
}

std::optional<int> RigSettings::integer_if_given(const std::string& key, int lowest,
                                                 int highest) const {
  const auto value = static_cast<int>(integer(key, lowest, lowest, highest));
  return has(key) ? std::optional(value) : std::nullopt;
}

bool RigSettings::flag(const std::string& key, bool fallback) const {
  const std::string* value = find(key);
  if (value == nullptr) return fallback;
  if (*value == "true" || *value == "on" || *value == "1" || *value == "yes") return true;
  if (*value == "false" || *value == "off" || *value == "0" || *value == "no") return false;
  refuse(where_, key, *value, "on or off");
}

std::string RigSettings::choice(const std::string& key, const std::string& fallback,
                                std::span<const std::string_view> words) const {
  const std::string* value = find(key);
  if (value == nullptr) return fallback;
  if (std::find(words.begin(), words.end(), *value) != words.end()) return *value;
  refuse(where_, key, *value, fmt::format("one of {}", fmt::join(words, ", ")));
}

void RigSettings::require_all_used() const {
  for (const auto& [key, value] : values_) {
    if (known_.contains(key)) continue;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: no key \"{}\"; there are {}", where_, key,
                            known_.empty() ? "none" : fmt::format("{}", fmt::join(known_, ", "))));
  }
}

}  // namespace fathom
