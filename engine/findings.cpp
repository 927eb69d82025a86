// SPDX-License-Identifier: Apache-2.0
#include "engine/findings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "engine/cache.hpp"

namespace fathom {
namespace {

constexpr int kConfirmed = 2;

}  // namespace

Findings::Findings(std::string file, std::string key, const Clock& clock)
    : file_(std::move(file)), key_(std::move(key)), clock_(clock) {
  std::istringstream lines(read_cached(file_, key_).value_or(std::string()));
  std::string name;
  for (Entry entry; lines >> name >> entry.value >> entry.agreeing >> entry.at_s;) {
    entries_[name] = entry;
  }
}

std::optional<std::size_t> Findings::known(const std::string& name) const {
  const auto found = entries_.find(name);
  if (found == entries_.end()) return std::nullopt;
  const Entry& entry = found->second;
  const double age = age_s(entry);
  // A calendar that was set back says nothing about age.
  const bool is_good = age >= 0 && age < (entry.agreeing >= kConfirmed ? kOld_s : kApart_s);
  return is_good ? std::optional(entry.value) : std::nullopt;
}

std::size_t Findings::learn(const std::string& name, const Measured& measured,
                            const std::function<bool(std::size_t, std::size_t)>& agree) {
  Entry& entry = entries_[name];
  const bool confirms =
      measured.is_certain && entry.agreeing > 0 && agree(entry.value, measured.value);
  const int agreeing = confirms ? kConfirmed : measured.is_certain ? 1 : 0;
  // Whole seconds, as in the file, and never of the future.
  entry = {measured.value, agreeing, std::floor(clock_.calendar_s())};
  keep();
  return measured.value;
}

void Findings::keep() const {
  std::string lines;
  for (const auto& [name, entry] : entries_) {
    lines += fmt::format("{} {} {} {:.0f}\n", name, entry.value, entry.agreeing, entry.at_s);
  }
  write_cached(file_, key_, lines);
}

}  // namespace fathom
