// SPDX-License-Identifier: Apache-2.0
// A report before it is HTML or Markdown, so that the two cannot drift apart.
//
// Texts may hold `code`, **bold** and [text](#section); everything else means itself.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace fathom::reproduce {

/// A colour mark beside a cell's text.
enum class Mark { none, holds, partly, fails };

struct Cell {
  std::string text;
  Mark mark = Mark::none;

  Cell(const char* words) : text(words) {}             // NOLINT: cells are written as texts
  Cell(std::string words) : text(std::move(words)) {}  // NOLINT
  Cell(std::string words, Mark colour) : text(std::move(words)), mark(colour) {}
};

struct Paragraph {
  std::string text;
};
/// A paragraph that nobody should miss.
struct Notice {
  std::string text;
};
struct Bullets {
  std::vector<std::string> items;
};
/// Commands to type, a line each.
struct Commands {
  std::vector<std::string> lines;
};
struct Table {
  std::vector<std::string> header;
  std::string alignment;  ///< A letter a column: l or r.
  std::vector<std::vector<Cell>> rows;
  std::string caption;
  bool folds = false;  ///< On a narrow screen each row becomes a card: for tables of words.
  std::string id;      ///< May be empty.
};
/// One plot of a figure.
struct Picture {
  std::string file;         ///< Name in the folder of figures, without .svg.
  std::string description;  ///< For those who cannot see it.
  std::string svg;          ///< Empty where there is no gnuplot.
};
struct Figure {
  std::vector<Picture> pictures;  ///< Side by side where there is room.
  std::string caption;
};

using Block = std::variant<Paragraph, Notice, Bullets, Commands, Table, Figure>;

struct Section {
  std::string id;
  std::string title;
  std::vector<Block> blocks;
};

struct Document {
  std::string title;
  std::string subtitle;
  std::vector<Section> sections;  ///< The first comes before the list of contents.
};

/// One page that needs nothing beside it: styles and pictures are part of it, no scripts.
std::string html_of(const Document& document);

/// The same for reading as text. figures: folder of the pictures, relative to the file.
std::string markdown_of(const Document& document, const std::string& figures);

}  // namespace fathom::reproduce
