// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/document.hpp"

#include <gtest/gtest.h>

namespace fathom::reproduce {
namespace {

Document example() {
  Table table;
  table.header = {"what", "a | b"};
  table.alignment = "lr";
  table.rows = {{"x < y & \"z\"", Cell("yes", Mark::holds)}};
  const Figure figure{
      {{"one", "a plot",
        "<?xml version=\"1.0\"?>\n<svg width=\"9\" height=\"8\" viewBox=\"0 0 9 8\">"
        "<path id='gpPt0'/><use xlink:href='#gpPt0'/></svg>"},
       {"two", "no plot", ""}},
      "two plots"};
  return {"Title <1>",
          "sub",
          {{"first", "First", {Paragraph{"**bold**, `code < 1` and [there](#second)"}}},
           {"second",
            "Second",
            {table, figure, Commands{{"fathom --x"}}, Notice{"loud"}, Bullets{{"one", "two"}}}}}};
}

void expect_all(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << "no " << word << " in\n" << text;
  }
}

TEST(Html, EscapesMarksLinksAndEmbeds) {
  const std::string html = html_of(example());
  expect_all(html, {"<h1>Title &lt;1&gt;</h1>", "<strong>bold</strong>", "<code>code &lt; 1</code>",
                    "<a href=\"#second\">there</a>", "x &lt; y &amp; &quot;z&quot;",
                    "<span class=\"mark holds\">yes</span>", "<section id=\"second\">",
                    "<li><a href=\"#second\">Second</a></li>", "Plot missing: no plot",
                    "<figcaption>two plots</figcaption>", "id='one-gpPt0'",
                    "xlink:href='#one-gpPt0'", "aria-label=\"a plot\""});
  EXPECT_EQ(html.find("<?xml"), std::string::npos);
  EXPECT_EQ(html.find("width=\"9\""), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
}

TEST(Markdown, SaysTheSame) {
  const std::string text = markdown_of(example(), "figures");
  expect_all(text, {"# Title <1>", "**bold**, `code < 1` and [there](#second)",
                    "<a id=\"second\"></a>", "| what | a \\| b |", "|---|---:|",
                    "![a plot](figures/one.svg)", "(plot missing: no plot)",
                    "```sh\nfathom --x\n```", "> **Note:** loud", "1. [Second](#second)"});
}

}  // namespace
}  // namespace fathom::reproduce
