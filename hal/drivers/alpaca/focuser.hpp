// SPDX-License-Identifier: Apache-2.0
// A focuser of an Alpaca server, absolute or relative.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/drivers/alpaca/settings.hpp"
#include "hal/lens.hpp"
#include "hal/restorer.hpp"
#include "hal/stop.hpp"

namespace fathom::alpaca {

class AlpacaFocuser final : public Lens {
 public:
  /// device: "focuser/0". Throws as Connection, Error(bad_argument) for a relative focuser whose travel
  /// or place nobody tells.
  AlpacaFocuser(std::unique_ptr<Connection> connection, std::string device, const FocuserKeys& keys,
                StopRequests stop_requests);

  LensInfo info() const override { return info_; }
  double position() const override;
  Arrival move_to(double position) override;
  Arrival home() override;
  void declare_at(double position) override;
  std::string why_unwatched() const override {
    return "a server says where its focuser is when it is asked, and not when it was there";
  }

 private:
  void connect();
  void describe();
  std::vector<int> legs(int from, int to) const;
  void go_by(int steps, const StopWatch& stop);
  void drive(int from, int to, const StopWatch& stop);
  void await_rest(int to, const StopWatch& stop);
  void halt() noexcept;
  void rest(std::int64_t until_ns, const StopWatch& stop);
  Arrival settled(std::int64_t started_ns, const StopWatch& stop);

  std::unique_ptr<Connection> connection_;
  std::string device_;
  FocuserKeys keys_;
  StopRequests stop_requests_;
  bool is_absolute_ = true;
  int most_at_once_ = 0;
  LensInfo info_;
  std::optional<int> counted_;     ///< Where a relative one stands.
  std::optional<int> approached_;  ///< Where a move of ours ended, coming from below.
  Restorer restorer_;              ///< The first to go: it needs the connection.
};

}  // namespace fathom::alpaca
