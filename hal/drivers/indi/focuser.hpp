// SPDX-License-Identifier: Apache-2.0
// A focuser on an INDI server, in its own steps: absolute where it counts by itself
// (ABS_FOCUS_POSITION), else relative (REL_FOCUS_POSITION and FOCUS_MOTION).
//
// A relative focuser is told how far to go, not where; where it stands is counted here, from its
// inner stop = 0 outward. Nobody knows the place at first: the rig text says it (start), or home()
// finds it, or declare_at(). After a move that did not end as it should nobody knows it again.
//
// A driver that comes to rest a little beside where it is sent, and says so, is believed. Where it
// does so every time, it is sent that much farther from then on.
//
// What moves a focuser by itself (temperature compensation) is switched off while it is open, and
// put back. Its driver's own backlash compensation is left as it is: use that, or LensTraits'
// backlash, not both.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/drivers/indi/changes.hpp"
#include "hal/drivers/indi/move_watch.hpp"
#include "hal/drivers/indi/settings.hpp"
#include "hal/lens.hpp"

namespace fathom::indi {

class IndiFocuser final : public Lens {
 public:
  /// `device` must be connected. Throws Error(unsupported) for a relative focuser whose travel
  /// nobody tells, Error(bad_argument) for an absolute one that is told what it knows by itself,
  /// Error(timeout), Error(bad_data).
  IndiFocuser(std::unique_ptr<Client> client, std::string device, const IndiSettings& settings,
              StopRequests stop_requests);

  LensInfo info() const override { return info_; }
  double position() const override;
  Arrival move_to(double position) override;
  Arrival home() override;
  void declare_at(double position) override;
  std::string why_unwatched() const override {
    return "a server says where its focuser is now and then, and not when it was there";
  }

 private:
  static constexpr const char* kAbsolute = "ABS_FOCUS_POSITION";
  static constexpr const char* kAbsoluteValue = "FOCUS_ABSOLUTE_POSITION";
  static constexpr const char* kRelative = "REL_FOCUS_POSITION";
  static constexpr double kMostSteps = 1e9;

  void prepare(const IndiSettings& settings);
  std::vector<int> legs(int from, int to) const;
  void refuse_relative_keys(const std::string& where) const;
  void hold_still();
  double travel() const;
  double counted_by_driver() const;
  void go_to(double target, const StopWatch& stop);
  void drive(double target, double sent, const StopWatch& stop);
  void go_by(double steps, const StopWatch& stop);
  void await_arrival(const char* property, const MoveOrder& order, const StopWatch& stop);
  double said_in(const Property& property, const MoveOrder& order) const;
  std::int64_t patience_ns(const MoveWatch& move) const;
  [[noreturn]] void fail(MoveWord word, const MoveOrder& order, const MoveWatch& move,
                         const std::string& words);
  void bring_to_rest(const char* property, std::uint64_t before);
  void rest(std::int64_t until_ns, const StopWatch& stop);
  Arrival settled(std::int64_t started_ns, const StopWatch& stop);

  std::unique_ptr<Client> client_;
  std::string device_;
  StopRequests stop_requests_;
  FocuserWishes wishes_;
  Changes changes_;  // after the client, which it needs to put things back
  bool is_absolute_ = true;
  LensInfo info_;
  std::optional<double> counted_;  // where a relative one stands
  std::optional<int> approached_;  // where a move of ours ended, coming from below
  double aim_ = 0;                 // how much farther it is sent than it shall go
  bool is_aimed_ = false;          // whether that was tried
};

}  // namespace fathom::indi
