// SPDX-License-Identifier: Apache-2.0
// The rows of fathom score. A fast backend scores a window in about a microsecond, so what all rows
// of a picture share is put into words once.
#pragma once

#include <span>
#include <string>

#include "engine/metric.hpp"
#include "engine/window.hpp"
#include "tools/fathom/page_place.hpp"

namespace fathom::cli {

enum class RowFormat { text, json };

/// What every row of one page of a picture says alike.
struct RowSetting {
  std::string image;
  std::size_t page = 0;
  PagePlace place;
  MetricSpec spec;
  std::string backend;
};

/// Gathers rows of one picture's windows, each with its line end.
class ScoreRows {
 public:
  ScoreRows(RowFormat format, const RowSetting& setting);

  /// values: as many as the metric gives. One stands alone, as "score"; more as a list, "scores".
  void add(const Window& window, std::span<const double> values);
  /// The rows since the last clear().
  const std::string& text() const { return text_; }
  void clear() { text_.clear(); }

 private:
  void add_json(const Window& window, std::span<const double> values);
  void add_text(const Window& window, std::span<const double> values);

  RowFormat format_;
  std::string before_position_;
  std::string after_position_;
  std::string text_;
};

}  // namespace fathom::cli
