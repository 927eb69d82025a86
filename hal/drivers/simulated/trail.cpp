// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/trail.hpp"

#include <algorithm>
#include <iterator>
#include <map>

namespace fathom::simulated {

void Trail::add(std::int64_t since_ns, int lens) { places_.push_back({since_ns, lens}); }

void Trail::forget_before(std::int64_t time_ns) {
  const auto later = std::find_if(places_.begin(), places_.end(),
                                  [&](const Place& place) { return place.since_ns > time_ns; });
  if (later == places_.begin()) return;
  places_.erase(places_.begin(), std::prev(later));  // the last of the others holds until then
}

bool Trail::covers(const Exposure& exposure) const {
  return !places_.empty() && places_.back().since_ns > exposure.start_ns;
}

std::vector<Stay> Trail::stays(const Exposure& exposure) const {
  const auto length_ns = static_cast<double>(exposure.end_ns - exposure.start_ns);
  std::map<int, double> shares;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    // What was before the first place is not known to differ from it.
    const std::int64_t from_ns =
        i == 0 ? exposure.start_ns : std::max(places_[i].since_ns, exposure.start_ns);
    const std::int64_t until_ns = i + 1 < places_.size()
                                      ? std::min(places_[i + 1].since_ns, exposure.end_ns)
                                      : exposure.end_ns;
    if (until_ns > from_ns) {
      shares[places_[i].lens] += static_cast<double>(until_ns - from_ns) / length_ns;
    }
  }
  std::vector<Stay> stays;
  for (const auto& [lens, share] : shares) stays.push_back({lens, share});
  return stays;
}

}  // namespace fathom::simulated
