// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/document.hpp"

namespace fathom::reproduce {
namespace {

/// A cell must not end at a bar of its own.
std::string cell_text(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

const char* sign_of(Mark mark) {
  switch (mark) {
    case Mark::none:
      return "";
    case Mark::holds:
      return "\U0001F7E2 ";  // a green disc
    case Mark::partly:
      return "\U0001F7E1 ";  // a yellow one
    case Mark::fails:
      return "\U0001F534 ";  // a red one
  }
  return "";
}

class Writer {
 public:
  explicit Writer(std::string figures) : figures_(std::move(figures)) {}
  std::string text;

  void operator()(const Paragraph& block) { text += block.text + "\n\n"; }
  void operator()(const Notice& block) { text += "> **Note:** " + block.text + "\n\n"; }
  void operator()(const Bullets& block) {
    for (const std::string& item : block.items) text += "- " + item + "\n";
    text += "\n";
  }
  void operator()(const Commands& block) {
    text += "```sh\n";
    for (const std::string& line : block.lines) text += line + "\n";
    text += "```\n\n";
  }
  void operator()(const Table& table) {
    if (!table.caption.empty()) text += table.caption + "\n\n";
    text += "|";
    for (const std::string& title : table.header) text += " " + cell_text(title) + " |";
    text += "\n|";
    for (const char side : table.alignment) text += side == 'r' ? "---:|" : "---|";
    text += "\n";
    for (const auto& row : table.rows) {
      text += "|";
      for (const Cell& cell : row) text += " " + (sign_of(cell.mark) + cell_text(cell.text)) + " |";
      text += "\n";
    }
    text += "\n";
  }
  void operator()(const Figure& figure) {
    for (const Picture& picture : figure.pictures) {
      text += picture.svg.empty() ? fmt::format("(plot missing: {})\n\n", picture.description)
                                  : fmt::format("![{}]({}/{}.svg)\n\n", picture.description,
                                                figures_, picture.file);
    }
    text += "*" + figure.caption + "*\n\n";
  }

 private:
  std::string figures_;
};

}  // namespace

std::string markdown_of(const Document& document, const std::string& figures) {
  Writer writer(figures);
  writer.text = fmt::format("# {}\n\n{}\n\n", document.title, document.subtitle);
  bool is_first = true;
  for (const Section& section : document.sections) {
    writer.text += fmt::format("<a id=\"{}\"></a>\n\n## {}\n\n", section.id, section.title);
    for (const Block& block : section.blocks) std::visit(writer, block);
    if (is_first) {
      writer.text += "**Contents**\n\n";
      for (std::size_t i = 1; i < document.sections.size(); ++i) {
        writer.text +=
            fmt::format("{}. [{}](#{})\n", i, document.sections[i].title, document.sections[i].id);
      }
      writer.text += "\n";
    }
    is_first = false;
  }
  return writer.text;
}

}  // namespace fathom::reproduce
