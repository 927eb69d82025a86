// SPDX-License-Identifier: Apache-2.0
// What there is to say of every verb, as values: --help, the pages of man and the completion of
// shells are all made of this one table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fathom::cli {

/// An option, a flag or an argument without a name.
struct OptionEntry {
  std::string names;    ///< "-o,--output", or "images" of an argument without a name.
  std::string value;    ///< What is written behind it, such as "TEXT"; empty of a flag.
  std::string initial;  ///< The value that it has if nothing is written, or empty.
  std::string help;
  bool is_required = false;
  bool is_repeatable = false;
};

/// A verb with all that may be written behind it, or the program itself.
struct VerbEntry {
  std::string name;  ///< As it is typed: "fathom rigs check".
  std::string help;
  std::vector<OptionEntry> arguments;
  std::vector<OptionEntry> options;
  std::vector<VerbEntry> verbs;
  std::string notes;  ///< Examples and more, as paragraphs with an empty line between them.
};

/// Columns that help takes at most.
inline constexpr int kHelpColumns = 100;

/// The words of `text` in lines of at most `columns`, where no word is longer than that.
std::vector<std::string> wrapped(std::string_view text, int columns);

/// "--name TEXT ..." as it stands in front of an option's help.
std::string spelled(const OptionEntry& option);

/// What --help prints, in lines of at most kHelpColumns.
std::string help_text(const VerbEntry& verb);

/// A verb (section 1) or a topic (section 7) as a page of man(1), in troff.
std::string man_page(const VerbEntry& verb, std::string_view version);
std::string man_page_of_topic(std::string_view name, std::string_view help, std::string_view text,
                              std::string_view version);

/// The file's name of a verb's page without its section: "fathom-rigs-check".
std::string page_name(const VerbEntry& verb);

}  // namespace fathom::cli
