// SPDX-License-Identifier: Apache-2.0
// Who may command the rig: one client at a time. The others watch, and may ask for it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/clock.hpp"

namespace fathom::serve {

/// Not safe to be called by two threads at once.
class Drive {
 public:
  /// A driver that has no page open and commands nothing for so long has gone.
  static constexpr double kGone_s = 10;
  /// A driver that does not answer for so long has lost the drive to whoever asked.
  static constexpr double kAnswer_s = 10;

  explicit Drive(const Clock& clock) : clock_(clock) {}

  /// Whether this client may command now. Where nobody drives, it does from now on.
  bool may_command(const std::string& client);

  void ask(const std::string& client);
  /// Throws Error(unavailable) where somebody drives who has not been asked, or may still answer.
  void take(const std::string& client);
  /// To whoever asked first, or to nobody. Throws Error(bad_argument) for one who does not drive.
  void give(const std::string& client);
  /// Nobody who asked gets it. Throws likewise.
  void refuse(const std::string& client);

  /// A page of this client watches, or does no more.
  void opened(const std::string& client) { ++pages_[client]; }
  void closed(const std::string& client);

  /// Nobody once it has gone.
  std::optional<std::string> driver() const;
  /// In the order in which they asked.
  std::vector<std::string> asking() const;

 private:
  struct Question {
    std::string client;
    double since_s;
  };

  bool is_gone() const;
  bool has_waited(const std::string& client) const;
  void hand_to(const std::string& client);
  void require_driver(const std::string& client) const;

  const Clock& clock_;
  std::optional<std::string> driver_;
  double last_sign_s_ = 0;  ///< When the driver last commanded, or closed its last page.
  std::vector<Question> questions_;
  std::map<std::string, int> pages_;
};

}  // namespace fathom::serve
