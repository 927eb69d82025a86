// SPDX-License-Identifier: Apache-2.0
// Smaller and simpler as long as it fails: a small case says where to look.
#include <algorithm>

#include "engine/error.hpp"
#include "tests/differential/judge.hpp"

namespace fathom::differential {
namespace {

class Minimiser {
 public:
  Minimiser(Judge& judge, Case failing, std::string label)
      : judge_(judge), label_(std::move(label)), case_(std::move(failing)) {}

  Case run() {
    // With the oracle for all windows it may be another window that is wrong, or a batch that the
    // device alone does not fail at all: then the case stays as it is.
    const auto found = judge_.examine_alone(case_, label_);
    if (found.empty()) return case_;
    Case alone = case_;
    alone.windows = {case_.windows[found[0].window]};
    if (!adopt(alone)) drop_windows();
    crop();
    for (const auto& simpler : simplifications()) {
      Case tried = case_;
      simpler(tried);
      if (tried != case_) adopt(tried);
    }
    return case_;
  }

 private:
  using Simplification = void (*)(Case&);

  static std::vector<Simplification> simplifications() {
    return {[](Case& c) { c.gap = 0; }, [](Case& c) { c.spec.band.reset(); },
            [](Case& c) { c.spec.power = false; },
            [](Case& c) { c.spec.taper = MetricSpec::standard(c.spec.transform, c.spec.n).taper; },
            [](Case& c) { c.spec.taper = Taper::none(); }};
  }

  /// A simpler metric may be none: without its band, a ring may be empty.
  static bool is_metric(const MetricSpec& spec) {
    try {
      spec.validate();
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  bool adopt(const Case& tried) {
    if (!is_metric(tried.spec)) return false;
    if (judge_.examine_alone(tried, label_).empty()) return false;
    case_ = tried;
    return true;
  }

  /// Runs of windows, the longest first, that the failure does without.
  void drop_windows() {
    for (std::size_t run = case_.windows.size() / 2; run > 0; run /= 2) {
      for (std::size_t first = 0; first < case_.windows.size() && case_.windows.size() > 1;) {
        Case tried = case_;
        const std::size_t last = std::min(first + run, tried.windows.size());
        tried.windows.erase(tried.windows.begin() + first, tried.windows.begin() + last);
        if (tried.windows.empty() || !adopt(tried)) first += run;
      }
    }
  }

  void crop() {
    int left = case_.crop.width, top = case_.crop.height, right = 0, bottom = 0;
    for (const Window& window : case_.windows) {
      left = std::min(left, window.x);
      top = std::min(top, window.y);
      right = std::max(right, window.x + window.n);
      bottom = std::max(bottom, window.y + window.n);
    }
    Case tried = case_;
    tried.crop = {case_.crop.x + left, case_.crop.y + top, right - left, bottom - top};
    for (Window& window : tried.windows) window = {window.x - left, window.y - top, window.n};
    adopt(tried);
  }

  Judge& judge_;
  std::string label_;
  Case case_;
};

}  // namespace

Case minimised(Judge& judge, const Case& failing, const std::string& label) {
  return Minimiser(judge, failing, label).run();
}

}  // namespace fathom::differential
