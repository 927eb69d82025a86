// SPDX-License-Identifier: Apache-2.0
#include "hal/rig_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "engine/error.hpp"

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

toml::table parse_toml(std::string_view text, const std::string& where) {
  try {
    return toml::parse(text, where);
  } catch (const toml::parse_error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", where, error.source().begin.line,
                                                 error.description()));
  }
}

}  // namespace

RigPart parse_rig_options(std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const RigDriver& driver = driver_named(text.substr(0, colon), fmt::format("rig \"{}\"", text));
  const std::string options(text.substr(std::min(colon + 1, text.size())));
  std::map<std::string, std::string> values;
  // A bare value may hold commas and equals signs, being a path, unless it starts with its own key.
  if (driver.bare_key() != nullptr && !options.empty() &&
      !options.starts_with(std::string(driver.bare_key()) + "=")) {
    values[driver.bare_key()] = options;
    return {&driver, RigSettings(driver.name(), std::move(values))};
  }
  std::istringstream stream(options);
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

}  // namespace fathom
