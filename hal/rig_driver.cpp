// SPDX-License-Identifier: Apache-2.0
#include "hal/rig_driver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <filesystem>
#include <sstream>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom {
namespace {

constexpr std::uintmax_t kLargestRigFile = 1 << 20;

const RigDriver& driver_named(const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (const RigDriver* driver : all_rig_drivers()) {
    if (name == driver->name()) return *driver;
    names.emplace_back(driver->name());
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: no rig driver \"{}\"; there are {}, or give the path of a .toml file",
                          where, name, fmt::join(names, ", ")));
}

/// "key=value,key=value" or a bare value for the driver's bare key (which may hold commas and equals
/// signs, being a path, unless it names a key of its own).
RigSettings parse_options(const RigDriver& driver, const std::string& options) {
  std::map<std::string, std::string> values;
  if (driver.bare_key() != nullptr && !options.empty() &&
      !options.starts_with(std::string(driver.bare_key()) + "=")) {
    values[driver.bare_key()] = options;
    return RigSettings(driver.name(), std::move(values));
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
      throw Error(ErrorCode::bad_argument, fmt::format("{}: {} is given twice", driver.name(), key));
    }
  }
  return RigSettings(driver.name(), std::move(values));
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

/// Opens the driver that one TOML table names, with the table's other keys.
Hardware open_table(const toml::table& table, const std::string& where,
                    const std::filesystem::path& folder) {
  std::map<std::string, std::string> values;
  for (const auto& [key, node] : table) {
    if (key != "driver") values[std::string(key.str())] = scalar_text(node, where, key.str());
  }
  const auto name = table["driver"].value<std::string>();
  if (!name) {
    throw Error(ErrorCode::bad_data, fmt::format("{}: needs driver = \"...\", such as \"sim\"", where));
  }
  const RigDriver& driver = driver_named(*name, where);
  // A path in a rig file is relative to the file, so that the file can be used from anywhere.
  if (driver.bare_key() != nullptr && values.contains(driver.bare_key())) {
    std::string& path = values[driver.bare_key()];
    path = (folder / path).string();
  }
  const RigSettings settings(where, std::move(values));
  Hardware hardware = driver.open(settings);
  settings.require_all_used();
  return hardware;
}

Hardware open_rig_file(const std::filesystem::path& path) {
  const std::string where = path.string();
  toml::table table;
  try {
    table = toml::parse(read_file(path, kLargestRigFile), where);
  } catch (const toml::parse_error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", where, error.source().begin.line,
                                                 error.description()));
  }
  const auto* camera = table["camera"].as_table();
  const auto* lens = table["lens"].as_table();
  if (camera == nullptr && lens == nullptr) return open_table(table, where, path.parent_path());
  for (const auto& [key, node] : table) {
    if (key != "camera" && key != "lens") {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{}: {} stands outside of the tables [camera] and [lens]", where, key.str()));
    }
  }
  if (camera == nullptr || lens == nullptr) {
    throw Error(ErrorCode::bad_data, fmt::format("{}: needs both tables, [camera] and [lens]", where));
  }
  Hardware eye = open_table(*camera, where + " [camera]", path.parent_path());
  Hardware motor = open_table(*lens, where + " [lens]", path.parent_path());
  return {std::move(eye.camera), std::move(motor.lens), nullptr};
}

Hardware open_any(std::string_view text) {
  if (text.ends_with(".toml")) return open_rig_file(text);
  const std::size_t colon = text.find(':');
  const RigDriver& driver =
      driver_named(std::string(text.substr(0, colon)), fmt::format("rig \"{}\"", text));
  const bool has_options = colon != std::string_view::npos;
  const RigSettings settings =
      parse_options(driver, has_options ? std::string(text.substr(colon + 1)) : std::string());
  Hardware hardware = driver.open(settings);
  settings.require_all_used();
  return hardware;
}

}  // namespace

Hardware open_hardware(std::string_view text) {
  Hardware hardware = open_any(text);
  if (hardware.camera == nullptr || hardware.lens == nullptr) {
    throw Error(ErrorCode::unavailable,
                fmt::format("rig \"{}\" has no {}; put two drivers together in a rig file", text,
                            hardware.camera == nullptr ? "camera" : "lens"));
  }
  return hardware;
}

}  // namespace fathom
