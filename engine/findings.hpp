// SPDX-License-Identifier: Apache-2.0
// Numbers that were measured on this machine, kept between runs, and believed only when two
// measurements at different times agree. A busy machine spoils one of them, not both alike.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "clock.hpp"

namespace fathom {

/// A number and whether nothing disturbed its measurement.
struct Measured {
  std::size_t value = 0;
  bool is_certain = true;
};

/// Two measurements must lie so far apart before the second one can confirm the first.
inline constexpr double kApart_s = 60;
/// A number that is older is measured again.
inline constexpr double kOld_s = 30.0 * 24 * 3600;

/// The numbers of one file of the cache, by name. Names hold no white space.
class Findings {
 public:
  /// file, key: as read_cached takes them. The clock must outlive it.
  Findings(std::string file, std::string key, const Clock& clock);

  /// What is known and need not be measured now: it was confirmed and is not old, or it was
  /// measured less than kApart_s ago. Nothing where a measurement is due.
  std::optional<std::size_t> known(const std::string& name) const;

  /// Keeps a new measurement and answers it. It confirms the old one where both are certain and
  /// agree; else it takes its place, unconfirmed.
  std::size_t learn(const std::string& name, const Measured& measured,
                    const std::function<bool(std::size_t, std::size_t)>& agree);

 private:
  struct Entry {
    std::size_t value = 0;
    int agreeing = 0;  ///< Certain measurements in a row that agree.
    double at_s = 0;   ///< When the last one was made.
  };
  double age_s(const Entry& entry) const { return clock_.calendar_s() - entry.at_s; }
  void keep() const;

  std::string file_, key_;
  const Clock& clock_;
  std::map<std::string, Entry> entries_;
};

}  // namespace fathom
