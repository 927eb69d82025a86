// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/score_rows.hpp"

#include <iterator>

#include "tools/fathom/console.hpp"

namespace fathom::cli {

ScoreRows::ScoreRows(RowFormat format, const RowSetting& setting) : format_(format) {
  const std::string metric = setting.spec.text();
  if (format == RowFormat::json) {
    const auto before = JsonLine().add("image", setting.image).add("page", setting.page);
    const auto after =
        JsonLine().add("n", setting.spec.n).add("metric", metric).add("backend", setting.backend);
    before_position_ = "{" + before.body() + ",\"x\":";
    after_position_ = "," + after.body() + ",\"score\":";
  } else {
    before_position_ = fmt::format(" {} page {} window ", setting.image, setting.page);
    after_position_ = fmt::format(",{} {}\n", setting.spec.n, metric);
  }
}

void ScoreRows::add(const Window& window, double score) {
  if (format_ == RowFormat::json) {
    add_json(window, score);
  } else {
    add_text(window, score);
  }
}

void ScoreRows::add_json(const Window& window, double score) {
  text_ += before_position_;
  append_json(text_, window.x);
  text_ += ",\"y\":";
  append_json(text_, window.y);
  text_ += after_position_;
  append_json(text_, score);
  text_ += "}\n";
}

void ScoreRows::add_text(const Window& window, double score) {
  fmt::format_to(std::back_inserter(text_), "{:<14.9g}{}{},{}{}", score, before_position_, window.x,
                 window.y, after_position_);
}

}  // namespace fathom::cli
