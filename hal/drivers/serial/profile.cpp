// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/profile.hpp"

#include <fmt/args.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/toml.hpp"

namespace fathom::serial {
namespace {

std::string format(const std::string& text, const Place& place) {
  fmt::dynamic_format_arg_store<fmt::format_context> numbers;
  numbers.push_back(fmt::arg("position", place.position));
  numbers.push_back(fmt::arg("steps", place.steps));
  return fmt::vformat(text, numbers);
}

/// Puts the values of variables in their place; braces of others stay.
std::string filled(std::string text, const Variables& values) {
  for (const auto& [name, value] : values) {
    const std::string hole = "{" + name + "}";
    for (auto at = text.find(hole); at != std::string::npos; at = text.find(hole, at)) {
      text.replace(at, hole.size(), value);
      at += value.size();
    }
  }
  return text;
}

/// Reads one table of a profile, and refuses what it does not know.
class Reader {
 public:
  Reader(const toml::table& table, std::string where, const Variables& values)
      : table_(table), where_(std::move(where)), values_(values) {}

  std::string text(std::string_view key, const std::string& fallback) {
    const auto* const node = find(key);
    if (node == nullptr) return fallback;
    if (const auto* value = node->as_string()) return filled(value->get(), values_);
    fail(fmt::format("{} must be a text", key));
  }

  std::string required(std::string_view key) {
    if (std::string value = text(key, ""); !value.empty()) return value;
    fail(fmt::format("{} is missing", key));
  }

  double number(std::string_view key, double fallback, double lowest, double highest) {
    const auto* const node = find(key);
    if (node == nullptr) return fallback;
    const auto value = node->value<double>();
    if (value && *value >= lowest && *value <= highest) return *value;
    fail(fmt::format("{} must be a number from {} to {}", key, lowest, highest));
  }

  bool flag(std::string_view key, bool fallback) {
    const auto* const node = find(key);
    if (node == nullptr) return fallback;
    if (const auto* value = node->as_boolean()) return value->get();
    fail(fmt::format("{} must be true or false", key));
  }

  std::optional<Pattern> pattern(std::string_view key) {
    const std::string value = text(key, "");
    if (value.empty()) return std::nullopt;
    return Pattern(value, fmt::format("{}: {}", where_, key));
  }

  /// The bytes of an array of numbers, for what is no text.
  std::string bytes(std::string_view key) {
    const auto* const node = find(key);
    if (node == nullptr) return {};
    std::string bytes;
    const auto* const array = node->as_array();
    if (array == nullptr) fail(fmt::format("{} must be a list of numbers", key));
    for (const auto& element : *array) {
      const auto value = element.value<int>();
      if (!value || *value < 0 || *value > 255) fail(fmt::format("{} holds what is no byte", key));
      bytes += static_cast<char>(*value);
    }
    return bytes;
  }

  const toml::table* table(std::string_view key) {
    const auto* const node = find(key);
    if (node == nullptr) return nullptr;
    if (const auto* value = node->as_table()) return value;
    fail(fmt::format("{} must be a table", key));
  }

  const toml::array* tables(std::string_view key) {
    const auto* const node = find(key);
    if (node == nullptr) return nullptr;
    const auto* const value = node->as_array();
    if (value != nullptr && value->is_homogeneous(toml::node_type::table)) return value;
    fail(fmt::format("{} must be a list of tables, [[{}]]", key, key));
  }

  void require_all_used() const {
    for (const auto& [key, node] : table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
      fail(fmt::format("there is no {}; there are {}", key.str(), fmt::join(known_, ", ")));
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_data, fmt::format("{}: {}", where_, what));
  }

  const std::string& where() const { return where_; }

 private:
  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
  }

  const toml::table& table_;
  std::string where_;
  const Variables& values_;
  std::vector<std::string> known_;
};

/// What may stand in the braces of a command: so much that no number becomes longer than a line.
void require_short_formats(const std::string& send, const Reader& reader) {
  static const std::regex kHole("\\{[^}]*\\}?"),
      kPlain("\\{(position|steps)(:0?[0-9]{0,2}(\\.[0-9]{1,2})?[dfgxX]?)?\\}");
  for (auto hole = std::sregex_iterator(send.begin(), send.end(), kHole);
       hole != std::sregex_iterator(); ++hole) {
    if (std::regex_match(hole->str(), kPlain)) continue;
    reader.fail(
        fmt::format("send: \"{}\" is neither a variable, nor {{position}} or {{steps}} with a "
                    "format such as {{position:.3f}}",
                    hole->str()));
  }
}

Command read_command(const toml::table& table, const std::string& where, const Variables& values,
                     const std::string& line_end) {
  Reader reader(table, where, values);
  Command command;
  const std::string bytes = reader.bytes("send_bytes");
  const std::string text = reader.text("send", "");
  command.send = text.empty() ? "" : text + reader.text("end", line_end);
  command.answer = reader.pattern("answer");
  command.done = reader.pattern("done");
  command.good = reader.pattern("good");
  command.at_end = reader.flag("at_end", false);
  reader.require_all_used();
  if (text.empty() == bytes.empty()) reader.fail("needs send or send_bytes, and not both");
  require_short_formats(text, reader);
  try {
    command.text({1.5, 2});
  } catch (const fmt::format_error& error) {
    reader.fail(fmt::format("send: {}", error.what()));
  }
  if (!bytes.empty()) command.send = bytes;
  if ((command.good || command.at_end) && !command.answer) reader.fail("needs answer");
  return command;
}

std::vector<TroubleLine> read_troubles(const toml::array* list, const std::string& where,
                                       const Variables& values) {
  std::vector<TroubleLine> troubles;
  if (list == nullptr) return troubles;
  for (const auto& element : *list) {
    Reader reader(*element.as_table(), where + " [[trouble]]", values);
    const std::string means = reader.required("means");
    if (means != "refused" && means != "lost") reader.fail("means must be \"refused\" or \"lost\"");
    troubles.push_back({Pattern(reader.required("match"), reader.where()),
                        means == "lost" ? Trouble::lost : Trouble::refused,
                        reader.required("words")});
    reader.require_all_used();
  }
  return troubles;
}

/// The tables of a profile that are commands.
class Commands {
 public:
  Commands(Reader& reader, const Variables& values, std::string line_end)
      : reader_(reader), values_(values), line_end_(std::move(line_end)) {}

  std::optional<Command> find(const std::string& key) {
    const toml::table* const table = reader_.table(key);
    if (table == nullptr) return std::nullopt;
    return read_command(*table, fmt::format("{} [{}]", reader_.where(), key), values_, line_end_);
  }

  /// One that is a question.
  std::optional<Command> question(const std::string& key) {
    auto command = find(key);
    if (command && !command->answer) reader_.fail(fmt::format("[{}] needs answer", key));
    return command;
  }

  Command required(std::optional<Command> command, const std::string& key) const {
    if (!command) reader_.fail(fmt::format("[{}] is missing", key));
    return *std::move(command);
  }

  std::vector<Command> list(const std::string& key) {
    std::vector<Command> commands;
    const toml::array* const list = reader_.tables(key);
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      commands.push_back(read_command(*list->get(i)->as_table(),
                                      fmt::format("{} [[{}]]", reader_.where(), key), values_,
                                      line_end_));
    }
    return commands;
  }

 private:
  Reader& reader_;
  const Variables& values_;
  std::string line_end_;
};

void read_basics(Reader& reader, Profile& profile) {
  profile.name = reader.required("name");
  reader.required("manual");  // for readers
  profile.unit = reader.text("unit", "steps");
  profile.step = reader.number("step", 1, 1e-9, 1e9);
  profile.scale = reader.number("scale", 1, -1e9, 1e9);
  profile.number_base = static_cast<int>(reader.number("number_base", 10, 10, 16));
  profile.baud = static_cast<int>(reader.number("baud", 9600, 300, 4e6));
  profile.answer_end = reader.text("answer_end", "\n");
  profile.timeout_s = reader.number("timeout_s", 1, 0.01, 60);
  profile.greeting = reader.pattern("greeting");
  profile.wait_s = reader.number("wait_s", 0, 0, 60);
  profile.forgets = reader.flag("forgets", false);
  profile.tells_on_way = reader.flag("tells_on_way", false);
}

/// The state's table has the patterns that are read from its answer beside its command.
void read_state(const toml::table* table, Profile& profile, const std::string& where,
                const Variables& values, const std::string& line_end) {
  if (table == nullptr) return;
  toml::table rest = *table;
  Reader reader(*table, where + " [state]", values);
  profile.moving = reader.pattern("moving");
  profile.unknown = reader.pattern("unknown");
  if (!profile.moving) reader.fail("moving is missing");
  rest.erase("moving");
  rest.erase("unknown");
  profile.state = read_command(rest, reader.where(), values, line_end);
  if (!profile.state->answer) reader.fail("answer is missing");
}

const toml::table& table_of(const toml::table& profile, const std::string& where) {
  static const toml::table kNone;
  const auto* const node = profile.get("variables");
  if (node == nullptr) return kNone;
  if (const auto* table = node->as_table()) return *table;
  throw Error(ErrorCode::bad_data, fmt::format("{}: variables must be a table", where));
}

Variables defaults_of(const toml::table& profile, const std::string& where) {
  Variables defaults;
  for (const auto& [name, node] : table_of(profile, where)) {
    const auto* const value = node.as_string();
    if (value == nullptr) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} [variables]: {} must be a text", where, name.str()));
    }
    defaults[std::string(name.str())] = value->get();
  }
  return defaults;
}

void require_plain(const std::string& name, const std::string& value, const std::string& where) {
  const auto is_plain = [](unsigned char c) {
    return c >= 0x20 && c != 0x7f && c != '{' && c != '}';
  };
  if (std::all_of(value.begin(), value.end(), is_plain)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {} may hold neither control characters nor braces", where, name));
}

}  // namespace

Pattern::Pattern(const std::string& text, const std::string& where) {
  // The library descends a level for each bracket.
  constexpr std::size_t kLongest = 400;
  if (text.size() > kLongest) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{}: a regular expression of more than {} characters", where, kLongest));
  }
  try {
    expression_ = std::regex(text);
  } catch (const std::regex_error& error) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{}: \"{}\" is no regular expression: {}", where, text, error.what()));
  }
}

std::optional<std::string> Pattern::find(const std::string& line) const {
  std::smatch match;
  if (!std::regex_search(line, match, expression_)) return std::nullopt;
  return match.size() > 1 && match[1].matched ? match[1].str() : match[0].str();
}

std::string Command::text(const Place& place) const { return format(send, place); }

Variables variables_of(std::string_view text, const std::string& where) {
  return defaults_of(parse_toml(text, where), where);
}

Profile read_profile(std::string_view text, const std::string& where, const Variables& values) {
  const toml::table table = parse_toml(text, where);
  Variables variables = defaults_of(table, where);
  for (const auto& [name, value] : values) {
    if (!variables.contains(name)) {
      throw Error(ErrorCode::bad_argument, fmt::format("{}: there is no {}", where, name));
    }
    require_plain(name, value, where);
    variables[name] = value;
  }
  Reader reader(table, where, variables);
  Profile profile;
  reader.table("variables");
  read_basics(reader, profile);
  const std::string line_end = reader.text("line_end", "\n");
  Commands commands(reader, variables, line_end);
  profile.open = commands.list("open");
  profile.move = commands.required(commands.find("move"), "move");
  profile.position = commands.required(commands.question("position"), "position");
  read_state(reader.table("state"), profile, where, variables, line_end);
  profile.arrive = commands.question("arrive");
  profile.known = commands.question("known");
  profile.stop = commands.find("stop");
  profile.home = commands.find("home");
  profile.lowest = commands.question("lowest");
  profile.highest = commands.question("highest");
  profile.troubles = read_troubles(reader.tables("trouble"), where, variables);
  reader.require_all_used();
  if (profile.state.has_value() == profile.arrive.has_value()) {
    reader.fail("needs [state], which says whether it moves, or [arrive], and not both");
  }
  if (profile.known && !profile.known->good) reader.fail("[known] needs good");
  if (profile.scale == 0) reader.fail("scale must not be 0");
  return profile;
}

}  // namespace fathom::serial
