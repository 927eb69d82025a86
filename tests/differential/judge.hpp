// SPDX-License-Identifier: Apache-2.0
// Every device scores the same windows; the judge says who is wrong.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "engine/backend.hpp"
#include "tests/differential/case.hpp"

namespace fathom::differential {

/// A device under its name for --device, "vulkan:0".
struct Examinee {
  std::string label;
  std::shared_ptr<Device> device;
};

/// Every device of every backend of this build but `reference`, as far as they open; tell gets a
/// line on each that does not.
std::vector<Examinee> all_examinees(const std::function<void(const std::string&)>& tell);

/// What a device did wrong, first window first.
struct Mismatch {
  std::string label;
  std::size_t window = 0;  ///< Of the case's, where it shows.
  std::string what;
};

/// What the judge saw of one device, over all cases.
struct Tally {
  std::size_t cases = 0, windows = 0;
  std::size_t judged = 0;          ///< Windows with a tolerance that the oracle scored as well.
  std::size_t as_good_double = 0;  ///< Of these: nearer to it than single precision gets.
  double worst = 0;                ///< Error of these over what is allowed.
  std::string worst_case;          ///< A case with that window alone.
  std::map<std::string, std::set<std::string>> declined;  ///< Reason -> metrics.
};

class Judge {
 public:
  /// reference_ms: about how long the oracle may take over one case; it scores at least two windows
  /// of each, those first that devices disagree about.
  Judge(std::vector<Examinee> examinees, double reference_ms);

  /// Runs the case on every device. At most one mismatch a device: the first.
  std::vector<Mismatch> examine(const Case& tested);

  /// The same of one device beside the oracle, which then scores all windows; without a tally.
  std::vector<Mismatch> examine_alone(const Case& tested, const std::string& label);

  const std::vector<Examinee>& examinees() const { return examinees_; }
  const std::map<std::string, Tally>& tallies() const { return tallies_; }

 private:
  std::vector<Examinee> examinees_;
  std::shared_ptr<Device> reference_;
  double reference_ms_;
  std::map<std::string, Tally> tallies_;
};

/// The case with as little as can be that this device still fails: fewer windows, a smaller frame,
/// no gaps, a simpler metric.
Case minimised(Judge& judge, const Case& failing, const std::string& label);

}  // namespace fathom::differential
