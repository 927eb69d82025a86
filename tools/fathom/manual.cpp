// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/manual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace fathom::cli {
namespace {

constexpr int kNameColumns = 30;  ///< Where the help of options begins.

/// The name in front, its help wrapped behind it, or below it where the name is long.
std::string entry(const std::string& name, const std::string& help) {
  const std::vector<std::string> lines = wrapped(help, kHelpColumns - kNameColumns);
  std::string text = "  " + name;
  bool is_open = text.size() + 2 <= kNameColumns;  // the first line of help goes behind the name
  if (!is_open) text += "\n";
  for (const std::string& line : lines) {
    text += is_open ? fmt::format("{:<{}}", "", kNameColumns - static_cast<int>(text.size()))
                    : std::string(kNameColumns, ' ');
    text += line + "\n";
    is_open = false;
  }
  return text;
}

/// A line of what a verb's author wrote: wrapped under its own indentation.
std::string note_line(const std::string& line) {
  const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
  if (static_cast<int>(line.size()) <= kHelpColumns) return line + "\n";
  std::string text;
  for (const std::string& part : wrapped(line, kHelpColumns - static_cast<int>(indent)))
    text += std::string(indent, ' ') + part + "\n";
  return text;
}

std::string usage(const VerbEntry& verb) {
  std::string text = "Usage: " + verb.name + " [OPTIONS]";
  for (const OptionEntry& argument : verb.arguments) {
    const std::string name = argument.names + (argument.is_repeatable ? "..." : "");
    text += argument.is_required ? " " + name : " [" + name + "]";
  }
  if (!verb.verbs.empty()) text += " VERB ...";
  return text + "\n";
}

std::string entries(const char* title, const std::vector<OptionEntry>& options) {
  if (options.empty()) return "";
  std::string text = fmt::format("\n{}:\n", title);
  for (const OptionEntry& option : options) text += entry(spelled(option), option.help);
  return text;
}

std::string last_word(const std::string& name) { return name.substr(name.rfind(' ') + 1); }

}  // namespace

std::vector<std::string> wrapped(std::string_view text, int columns) {
  std::vector<std::string> lines;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    const bool fits = !lines.empty() &&
                      lines.back().size() + 1 + word.size() <= static_cast<std::size_t>(columns);
    if (fits) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

std::string spelled(const OptionEntry& option) {
  std::string text = option.names;
  if (!option.value.empty()) text += " " + option.value;
  if (!option.initial.empty()) text += "=" + option.initial;
  if (option.is_repeatable) text += " ...";
  if (option.is_required) text += " REQUIRED";
  return text;
}

std::string help_text(const VerbEntry& verb) {
  std::string text = verb.help + "\n" + usage(verb);
  text += entries("Arguments", verb.arguments) + entries("Options", verb.options);
  if (!verb.verbs.empty()) text += "\nVerbs:\n";
  for (const VerbEntry& child : verb.verbs) text += entry(last_word(child.name), child.help);
  if (!verb.notes.empty()) text += "\n";
  std::istringstream notes(verb.notes);
  for (std::string line; std::getline(notes, line);) text += note_line(line);
  return text;
}

std::string page_name(const VerbEntry& verb) {
  std::string name = verb.name;
  std::ranges::replace(name, ' ', '-');
  return name;
}

}  // namespace fathom::cli
