// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/rig_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hal/rig_text.hpp"

namespace fathom::cli {
namespace {

/// Whether TOML's number is written the same: no sign but a minus, no zeros around it.
bool is_number(std::string_view text) {
  constexpr std::size_t kLongest = 15;  // longer ones are names that happen to be digits
  if (text == "-0") return false;
  if (text.starts_with('-')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const auto are_digits = [](std::string_view part) {
    return !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  const std::string_view whole = text.substr(0, point);
  const bool has_part = point < text.size();
  return text.size() <= kLongest && are_digits(whole) && (whole.size() == 1 || whole[0] != '0') &&
         (!has_part || (are_digits(text.substr(point + 1)) && text.back() != '0'));
}

std::string value_text(const std::string& value) {
  if (is_number(value) || value == "true" || value == "false") return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string table_text(const RigPart& part, const std::optional<LensSettings>& lens) {
  std::map<std::string, std::string> values = part.settings.values();
  if (lens) {
    values["settle_ms"] = fmt::format("{:g}", lens->settle_ms);
    values["backlash"] = fmt::format("{:g}", lens->backlash);
    values["coarse"] = fmt::format("{:g}", lens->coarse);
  }
  std::string text = fmt::format("driver = \"{}\"\n", part.driver->name());
  for (const auto& [key, value] : values) text += fmt::format("{} = {}\n", key, value_text(value));
  return text;
}

}  // namespace

std::string rig_file_text(std::string_view rig, const std::optional<LensSettings>& lens) {
  const RigRequest request = parse_rig(rig);
  if (!request.lens) return table_text(request.camera, lens);
  return "[camera]\n" + table_text(request.camera, std::nullopt) + "\n[lens]\n" +
         table_text(*request.lens, lens);
}

}  // namespace fathom::cli
