// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/document.hpp"
#include "tools/fathom/reproduce/style.hpp"

namespace fathom::reproduce {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

std::string escaped(std::string text) {
  replace_all(text, "&", "&amp;");
  replace_all(text, "<", "&lt;");
  replace_all(text, ">", "&gt;");
  replace_all(text, "\"", "&quot;");
  return text;
}

/// Turns pairs of a mark into an element.
std::string paired(const std::string& text, std::string_view mark, const char* element) {
  std::string result;
  bool open = false;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(mark, from)) != std::string::npos; from = at + mark.size()) {
    result += text.substr(from, at - from) + (open ? "</" : "<") + element + ">";
    open = !open;
  }
  return result + text.substr(from);
}

/// [text](#section)
std::string linked(const std::string& text) {
  std::string result;
  std::size_t from = 0;
  for (std::size_t middle; (middle = text.find("](#", from)) != std::string::npos;) {
    const std::size_t open = text.rfind('[', middle), close = text.find(')', middle);
    if (open == std::string::npos || open < from || close == std::string::npos) break;
    result += text.substr(from, open - from);
    result += fmt::format("<a href=\"{}\">{}</a>", text.substr(middle + 2, close - middle - 2),
                          text.substr(open + 1, middle - open - 1));
    from = close + 1;
  }
  return result + text.substr(from);
}

std::string inline_html(const std::string& text) {
  return linked(paired(paired(escaped(text), "**", "strong"), "`", "code"));
}

const char* class_of(Mark mark) {
  switch (mark) {
    case Mark::none:
      return "";
    case Mark::holds:
      return "mark holds";
    case Mark::partly:
      return "mark partly";
    case Mark::fails:
      return "mark fails";
  }
  return "";
}

std::string cell_html(const Cell& cell, const std::string& label, char alignment) {
  const std::string text = inline_html(cell.text);
  return fmt::format("<td{} data-label=\"{}\">{}</td>", alignment == 'r' ? " class=\"r\"" : "",
                     escaped(label),
                     cell.mark == Mark::none
                         ? text
                         : fmt::format("<span class=\"{}\">{}</span>", class_of(cell.mark), text));
}

/// gnuplot numbers the parts of every picture alike; in one page each must have its own names. The
/// size gives way to that of the page.
std::string embedded(const Picture& picture) {
  std::string svg = picture.svg;
  svg.erase(0, svg.find("<svg"));
  const std::string prefix = picture.file + "-";
  replace_all(svg, " id=\"", " id=\"" + prefix);
  replace_all(svg, " id='", " id='" + prefix);
  replace_all(svg, "xlink:href='#", "xlink:href='#" + prefix);
  replace_all(svg, "url(#", "url(#" + prefix);
  const std::size_t end = svg.find('>');
  std::string head = svg.substr(0, end);
  for (const char* const size : {" width=\"", " height=\""}) {
    const std::size_t at = head.find(size);
    if (at == std::string::npos) continue;
    head.erase(at, head.find('"', at + std::string_view(size).size()) + 1 - at);
  }
  return head + fmt::format(" role=\"img\" aria-label=\"{}\"", escaped(picture.description)) +
         svg.substr(end);
}

class Writer {
 public:
  std::string text;

  void operator()(const Paragraph& block) { text += "<p>" + inline_html(block.text) + "</p>\n"; }
  void operator()(const Notice& block) {
    text += "<p class=\"notice\">" + inline_html(block.text) + "</p>\n";
  }
  void operator()(const Bullets& block) {
    text += "<ul>\n";
    for (const std::string& item : block.items) text += "<li>" + inline_html(item) + "</li>\n";
    text += "</ul>\n";
  }
  void operator()(const Commands& block) {
    text += "<pre>";
    for (const std::string& line : block.lines) text += "<span>" + escaped(line) + "</span>";
    text += "</pre>\n";
  }
  void operator()(const Table& table) {
    text += fmt::format("<div class=\"scroll\"><table{}{}>\n",
                        table.id.empty() ? "" : " id=\"" + table.id + "\"",
                        table.folds ? " class=\"folds\"" : "");
    if (!table.caption.empty()) {
      text += "<caption>" + inline_html(table.caption) + "</caption>\n";
    }
    text += "<thead><tr>";
    for (std::size_t i = 0; i < table.header.size(); ++i) {
      text += fmt::format("<th{}>{}</th>", table.alignment[i] == 'r' ? " class=\"r\"" : "",
                          inline_html(table.header[i]));
    }
    text += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      text += "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i) {
        text += cell_html(row[i], table.header[i], table.alignment[i]);
      }
      text += "</tr>\n";
    }
    text += "</tbody></table></div>\n";
  }
  void operator()(const Figure& figure) {
    text += fmt::format("<figure class=\"n{}\">\n<div class=\"pictures\">\n",
                        std::min<std::size_t>(figure.pictures.size(), 3));
    for (const Picture& picture : figure.pictures) {
      text += picture.svg.empty()
                  ? "<p class=\"missing\">Plot missing: " + escaped(picture.description) + "</p>\n"
                  : "<div>" + embedded(picture) + "</div>\n";
    }
    text += "</div>\n<figcaption>" + inline_html(figure.caption) + "</figcaption>\n</figure>\n";
  }
};

std::string contents_html(const Document& document) {
  std::string text = "<nav>\n<h2>Contents</h2>\n<ol>\n";
  for (std::size_t i = 1; i < document.sections.size(); ++i) {
    const Section& section = document.sections[i];
    text += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", section.id, escaped(section.title));
  }
  return text + "</ol>\n</nav>\n";
}

}  // namespace

std::string html_of(const Document& document) {
  Writer writer;
  writer.text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<header>\n<h1>{0}</h1>\n"
      "<p class=\"subtitle\">{2}</p>\n</header>\n<main>\n",
      escaped(document.title), kStyle, inline_html(document.subtitle));
  bool is_first = true;
  for (const Section& section : document.sections) {
    writer.text +=
        fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n", section.id, escaped(section.title));
    for (const Block& block : section.blocks) std::visit(writer, block);
    writer.text += "</section>\n";
    if (is_first) writer.text += contents_html(document);
    is_first = false;
  }
  return writer.text + "</main>\n</body>\n</html>\n";
}

}  // namespace fathom::reproduce
