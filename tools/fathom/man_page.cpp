// SPDX-License-Identifier: Apache-2.0
// What is said of a verb or a topic, as a page of man(1).
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "tools/fathom/manual.hpp"

namespace fathom::cli {
namespace {

/// Text in which troff finds no commands of its own.
std::string troff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool starts_line = out.empty() || out.back() == '\n';
    if (starts_line && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + troff(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + troff(text) + "\\fR"; }

std::string header(std::string name, int section, std::string_view version, std::string_view help) {
  std::string title = name;
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  return fmt::format(".TH {} {} \"\" \"fathom {}\" \"Fathom\"\n.SH NAME\n{} \\- {}\n", troff(title),
                     section, version, troff(name), troff(help));
}

std::string options_section(const char* title, const std::vector<OptionEntry>& options) {
  if (options.empty()) return "";
  std::string text = fmt::format(".SH {}\n", title);
  for (const OptionEntry& option : options) {
    text += ".TP\n" + bold(option.names);
    if (!option.value.empty()) text += " " + italic(option.value);
    if (option.is_repeatable) text += " ...";
    text += "\n" + troff(option.help);
    if (!option.initial.empty()) text += troff(" (otherwise " + option.initial + ")");
    if (option.is_required) text += " (required)";
    text += "\n";
  }
  return text;
}

/// Lines that begin with blanks stay as they are; others flow.
std::string paragraph(const std::vector<std::string>& lines) {
  std::string text = ".PP\n";
  bool is_kept = false;
  for (const std::string& line : lines) {
    if (line.starts_with(' ') != is_kept) {
      text += is_kept ? ".fi\n" : ".nf\n";
      is_kept = !is_kept;
    }
    text += troff(line) + "\n";
  }
  return text + (is_kept ? ".fi\n" : "");
}

std::vector<std::vector<std::string>> paragraphs_of(std::string_view text) {
  std::vector<std::vector<std::string>> paragraphs(1);
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) {
      paragraphs.back().push_back(line);
    } else if (!paragraphs.back().empty()) {
      paragraphs.emplace_back();
    }
  }
  if (paragraphs.back().empty()) paragraphs.pop_back();
  return paragraphs;
}

/// A section whose first paragraph begins with it.
std::string section(const char* title, std::string_view text) {
  if (text.empty()) return "";
  constexpr std::string_view kParagraph = ".PP\n";
  if (text.starts_with(kParagraph)) text.remove_prefix(kParagraph.size());
  return fmt::format(".SH {}\n{}", title, text);
}

/// What stands below the options: examples in a section of their own, then the rest.
std::string notes_sections(std::string_view notes) {
  std::string examples, rest;
  for (std::vector<std::string>& lines : paragraphs_of(notes)) {
    const bool is_example = lines.front().starts_with("Example");
    if (is_example) lines.erase(lines.begin());
    (is_example ? examples : rest) += paragraph(lines);
  }
  return section("EXAMPLES", examples) + section("NOTES", rest);
}

std::string verbs_section(const std::vector<VerbEntry>& verbs) {
  if (verbs.empty()) return "";
  std::string text = ".SH VERBS\n";
  for (const VerbEntry& verb : verbs)
    text += ".TP\n" + bold(page_name(verb)) + "(1)\n" + troff(verb.help) + "\n";
  return text;
}

}  // namespace

std::string man_page(const VerbEntry& verb, std::string_view version) {
  std::string synopsis = bold(verb.name) + " [" + italic("OPTIONS") + "]";
  for (const OptionEntry& argument : verb.arguments) {
    const std::string name = italic(argument.names) + (argument.is_repeatable ? " ..." : "");
    synopsis += argument.is_required ? " " + name : " [" + name + "]";
  }
  if (!verb.verbs.empty()) synopsis += " " + italic("VERB") + " ...";
  return header(page_name(verb), 1, version, verb.help) + ".SH SYNOPSIS\n" + synopsis + "\n" +
         options_section("ARGUMENTS", verb.arguments) + options_section("OPTIONS", verb.options) +
         verbs_section(verb.verbs) + notes_sections(verb.notes) +
         ".SH SEE ALSO\n.BR fathom (1),\n.BR fathom\\-rigs (7),\n.BR fathom\\-metrics (7),\n"
         ".BR fathom\\-searches (7)\n";
}

std::string man_page_of_topic(std::string_view name, std::string_view help, std::string_view text,
                              std::string_view version) {
  std::string description;
  for (const std::vector<std::string>& lines : paragraphs_of(text)) description += paragraph(lines);
  return header(fmt::format("fathom-{}", name), 7, version, help) +
         section("DESCRIPTION", description) + ".SH SEE ALSO\n.BR fathom (1)\n";
}

}  // namespace fathom::cli
