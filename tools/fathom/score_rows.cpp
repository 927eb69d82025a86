// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/score_rows.hpp"

#include <iterator>

#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

/// Of a stack with channels and times, what its page is.
void add_place(JsonLine& line, const PagePlace& place) {
  if (place.image) line.add("image_of_file", *place.image);
  if (place.channel) line.add("channel", *place.channel);
  if (!place.channel_name.empty()) line.add("channel_name", place.channel_name);
  if (place.slice) line.add("z", *place.slice);
  if (place.time) line.add("time", *place.time);
}

}  // namespace

ScoreRows::ScoreRows(RowFormat format, const RowSetting& setting) : format_(format) {
  const std::string metric = setting.spec.text();
  if (format == RowFormat::json) {
    JsonLine before = JsonLine().add("image", setting.image).add("page", setting.page);
    add_place(before, setting.place);
    const auto after =
        JsonLine().add("n", setting.spec.n).add("metric", metric).add("backend", setting.backend);
    before_position_ = "{" + before.body() + ",\"x\":";
    after_position_ =
        "," + after.body() + (setting.spec.outputs() == 1 ? ",\"score\":" : ",\"scores\":");
  } else {
    before_position_ = fmt::format(" {} page {}{} window ", printable(setting.image), setting.page,
                                   text_of(setting.place));
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
