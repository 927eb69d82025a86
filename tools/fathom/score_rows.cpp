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
    after_position_ =
        "," + after.body() + (setting.spec.outputs() == 1 ? ",\"score\":" : ",\"scores\":");
  } else {
    before_position_ = fmt::format(" {} page {} window ", setting.image, setting.page);
    after_position_ = fmt::format(",{} {}\n", setting.spec.n, metric);
  }
}

void ScoreRows::add(const Window& window, std::span<const double> values) {
  switch (format_) {
    case RowFormat::json:
      return add_json(window, values);
    case RowFormat::text:
      return add_text(window, values);
  }
}

void ScoreRows::add_json(const Window& window, std::span<const double> values) {
  text_ += before_position_;
  append_json(text_, window.x);
  text_ += ",\"y\":";
  append_json(text_, window.y);
  text_ += after_position_;
  if (values.size() != 1) text_ += '[';
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0) text_ += ',';
    append_json(text_, values[k]);
  }
  text_ += values.size() != 1 ? "]}\n" : "}\n";
}

void ScoreRows::add_text(const Window& window, std::span<const double> values) {
  for (std::size_t k = 0; k < values.size(); ++k)
    fmt::format_to(std::back_inserter(text_), "{}{:<14.9g}", k > 0 ? " " : "", values[k]);
  fmt::format_to(std::back_inserter(text_), "{}{},{}{}", before_position_, window.x, window.y,
                 after_position_);
}

}  // namespace fathom::cli
