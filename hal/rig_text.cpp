// SPDX-License-Identifier: Apache-2.0
#include "hal/rig_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "hal/toml.hpp"

namespace fathom {
namespace {

const RigDriver& driver_named(std::string_view name, const std::string& where) {
  std::vector<std::string> names;
  for (const RigDriver* driver : all_rig_drivers()) {
    if (name == driver->name()) return *driver;
    names.emplace_back(driver->name());
  }
  for (const AbsentRigDriver& absent : absent_rig_drivers()) {
    if (name != absent.name) continue;
    throw Error(ErrorCode::unavailable, fmt::format("{}: this build has no rig driver \"{}\": {}",
                                                    where, name, absent.reason));
  }
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("{}: no rig driver \"{}\"; there are {}, or give the path of a .toml file", where,
                  name, fmt::join(names, ", ")));
}

/// A TOML value as the text that a settings getter reads.
std::string scalar_text(const toml::node& node, const std::string& where, std::string_view key) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  throw Error(ErrorCode::bad_data,
              fmt::format("{}: {} must be a text, a number or true or false", where, key));
}

/// The driver that one TOML table names, with the table's other keys.
RigPart parse_table(const toml::table& table, const std::string& where,
                    const std::filesystem::path& folder) {
  std::map<std::string, std::string> values;
  for (const auto& [key, node] : table) {
    if (key != "driver") values[std::string(key.str())] = scalar_text(node, where, key.str());
  }
  const auto name = table["driver"].value<std::string>();
  if (!name) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{}: needs driver = \"...\", such as \"sim\"", where));
  }
  const RigDriver& driver = driver_named(*name, where);
  // A path in a rig file is relative to the file, so that the file can be used from anywhere.
  for (const std::string_view key : driver.path_keys()) {
    const auto path = values.find(std::string(key));
    if (path != values.end() && !path->second.empty())
      path->second = (folder / path->second).string();
  }
  return {&driver, RigSettings(where, std::move(values))};
}

/// Moves the KEY=VALUEs that a driver knows from the end of a bare value into `values`; returns the
/// rest.
std::string take_trailing(std::string bare, const RigDriver& driver,
                          std::map<std::string, std::string>& values) {
  const auto keys = driver.trailing_keys();
  for (;;) {
    const std::size_t comma = bare.rfind(',');
    const std::size_t equals = bare.find('=', std::min(comma, bare.size()));
    if (comma == std::string::npos || equals == std::string::npos) return bare;
    const std::string key = bare.substr(comma + 1, equals - comma - 1);
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) return bare;
    if (!values.emplace(key, bare.substr(equals + 1)).second) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("{}: {} is given twice", driver.name(), key));
    }
    bare.resize(comma);
  }
}

/// Whether a text begins with a value alone, and not with a key. That of a path may hold equals
/// signs.
bool starts_bare(const std::string& options, const RigDriver& driver) {
  if (driver.bare_key() == nullptr || options.empty()) return false;
  const std::string first = options.substr(0, options.find(','));
  if (!driver.trailing_keys().empty())
    return !options.starts_with(std::string(driver.bare_key()) + "=");
  return first.find('=') == std::string::npos;
}

/// Moves the bare value, and what can only be told from it with its help, into `values`; returns the
/// rest.
std::string take_bare(const std::string& options, const RigDriver& driver,
                      std::map<std::string, std::string>& values) {
  if (!driver.trailing_keys().empty()) {
    values[driver.bare_key()] = take_trailing(options, driver, values);
    return {};
  }
  const std::size_t comma = std::min(options.find(','), options.size());
  values[driver.bare_key()] = options.substr(0, comma);
  return options.substr(std::min(comma + 1, options.size()));
}

void add_pairs(const std::string& pairs, const RigDriver& driver,
               std::map<std::string, std::string>& values) {
  std::istringstream stream(pairs);
  for (std::string item; std::getline(stream, item, ',');) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("{0}: \"{1}\" is not key=value; write {0}:key=value,key=value",
                              driver.name(), item));
    }
    const std::string key = item.substr(0, equals);
    if (!values.emplace(key, item.substr(equals + 1)).second) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("{}: {} is given twice", driver.name(), key));
    }
  }
}

}  // namespace

RigPart parse_rig_options(std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const RigDriver& driver = driver_named(text.substr(0, colon), fmt::format("rig \"{}\"", text));
  std::string options(text.substr(std::min(colon + 1, text.size())));
  std::map<std::string, std::string> values;
  if (starts_bare(options, driver)) options = take_bare(options, driver, values);
  add_pairs(options, driver, values);
  return {&driver, RigSettings(driver.name(), std::move(values))};
}

RigRequest parse_rig_file(std::string_view toml, const std::filesystem::path& path) {
  const std::string where = path.string();
  const toml::table table = parse_toml(toml, where);
  const auto* camera = table["camera"].as_table();
  const auto* lens = table["lens"].as_table();
  if (camera == nullptr && lens == nullptr) {
    return {parse_table(table, where, path.parent_path()), std::nullopt};
  }
  for (const auto& [key, node] : table) {
    if (key == "camera" || key == "lens") continue;
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{}: {} stands outside of the tables [camera] and [lens]", where, key.str()));
  }
  if (camera == nullptr || lens == nullptr) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{}: needs both tables, [camera] and [lens]", where));
  }
  return {parse_table(*camera, where + " [camera]", path.parent_path()),
          parse_table(*lens, where + " [lens]", path.parent_path())};
}

namespace {

bool names_driver(std::string_view name) {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (name == driver->name()) return true;
  }
  return false;
}

}  // namespace

RigRequest parse_rig(std::string_view text) {
  constexpr std::uintmax_t kLargestRigFile = 1 << 20;
  // A driver's own name goes first: "replay:stack.toml" is no rig file.
  if (text.ends_with(".toml") && !names_driver(text.substr(0, text.find(':')))) {
    return parse_rig_file(read_file(text, kLargestRigFile), text);
  }
  return {parse_rig_options(text), std::nullopt};
}

}  // namespace fathom
