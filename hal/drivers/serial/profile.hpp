// SPDX-License-Identifier: Apache-2.0
// How a motor, a stage or a focuser that is told what to do in lines of text is spoken with: data,
// not code. docs/serial.md says what stands in a profile.
#pragma once

#include <map>
#include <optional>
#include <regex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::serial {

/// The names and texts that a profile leaves to its user: axis, address, feed.
using Variables = std::map<std::string, std::string>;

/// What an answer looks like.
class Pattern {
 public:
  /// text: an ECMAScript regular expression. Throws Error(bad_data).
  Pattern(const std::string& text, const std::string& where);

  bool is_in(const std::string& line) const { return std::regex_search(line, expression_); }
  /// Its first group where it has one that matched, else what matched; nothing where it does not.
  std::optional<std::string> find(const std::string& line) const;

 private:
  std::regex expression_;
};

/// The place that a command speaks of, as the device counts.
struct Place {
  double position = 0;  ///< {position} in a command.
  long long steps = 0;  ///< {steps}: the nearest whole number.
};

/// One thing that can be said to the device.
struct Command {
  std::string send;  ///< A format with {position} and {steps}, the line's end included.
  std::optional<Pattern> answer;  ///< What ends it; absent: it is never answered.
  std::optional<Pattern> done;    ///< What comes after the answer and belongs to it.
  std::optional<Pattern> good;    ///< Which answers mean that it was taken; absent: all.

  bool at_end = false;  ///< Of [home]: the answer comes once it is there.

  /// The bytes that go over the line.
  std::string text(const Place& place = {}) const;
};

/// What a line that nobody asked for means.
enum class Trouble {
  refused,  ///< What was asked for will not be done; the device stands where it was.
  lost,     ///< Where the device stands is not known from here on.
};

struct TroubleLine {
  Pattern match;
  Trouble trouble = Trouble::refused;
  std::string words;  ///< For the user: what it is, and what to do.
};

struct Profile {
  std::string name;      ///< "GRBL 1.1".
  std::string unit;      ///< Of the lens.
  double step = 1;       ///< Smallest move that means anything, in that unit.
  double scale = 1;      ///< What the device counts for each unit.
  int number_base = 10;  ///< Of the places that it tells.
  int baud = 9600;
  std::string answer_end;
  double timeout_s = 1;             ///< For an answer.
  std::optional<Pattern> greeting;  ///< What it says when it has been switched on or reset.
  double wait_s = 0;                ///< For the greeting, after opening.
  bool forgets = false;       ///< Whether it counts from zero each time that it is switched on.
  bool tells_on_way = false;  ///< Whether it says where it is, not where it was sent.

  std::vector<Command> open;  ///< Said first.
  Command move;
  Command position;
  std::optional<Command> state;    ///< Whether it moves,
  std::optional<Pattern> moving;   ///< which answers say so,
  std::optional<Pattern> unknown;  ///< and which that it does not know where it is.
  std::optional<Command> arrive;   ///< Answered once it stands; instead of `state`.
  std::optional<Command> known;    ///< `good` where it knows where it is.
  std::optional<Command> stop, home, lowest, highest;
  std::vector<TroubleLine> troubles;
};

/// What a profile says when its variables have these values. text: TOML. where: how messages name
/// it. Throws Error(bad_data) for what is no profile, Error(bad_argument) for a variable that it
/// has not or a value with control characters.
Profile read_profile(std::string_view text, const std::string& where, const Variables& values);

/// The variables of a profile, with the values that they have where nobody says otherwise.
Variables variables_of(std::string_view text, const std::string& where);

/// A profile that comes with the program.
struct KnownProfile {
  std::string_view name;  ///< What profile = "..." takes.
  std::string_view text;
};
std::span<const KnownProfile> known_profiles();

}  // namespace fathom::serial
