// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/plot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>
#include <vector>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/palette.hpp"

namespace fathom::cli {
namespace {

/// A canvas of braille characters, each 2 x 4 dots.
class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns) * rows) {}

  int width() const { return 2 * columns_; }
  int height() const { return 4 * rows_; }

  void dot(int x, int y) {
    // Unicode numbers the dots of a cell down the columns, the fourth row last.
    static constexpr unsigned char bits[4][2] = {
        {0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    cells_[static_cast<std::size_t>(y / 4) * columns_ + x / 2] |= bits[y % 4][x % 2];
  }

  void line(double x0, double y0, double x1, double y1) {
    const int steps =
        std::max(1, static_cast<int>(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0)))));
    for (int i = 0; i <= steps; ++i) {
      const double part = static_cast<double>(i) / steps;
      dot(static_cast<int>(std::lround(x0 + part * (x1 - x0))),
          static_cast<int>(std::lround(y0 + part * (y1 - y0))));
    }
  }

  /// Something that stands out from lines, in the place of a character.
  void mark(double x, double y) {
    marks_.insert({static_cast<int>(std::lround(y)) / 4, static_cast<int>(std::lround(x)) / 2});
  }

  std::string row(int index) const {
    std::string text;
    for (int column = 0; column < columns_; ++column) {
      if (marks_.contains({index, column})) {
        text += 'o';
        continue;
      }
      const unsigned code = 0x2800u + cells_[static_cast<std::size_t>(index) * columns_ + column];
      text += static_cast<char>(0xE0 | (code >> 12));
      text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
      text += static_cast<char>(0x80 | (code & 0x3F));
    }
    return text;
  }

 private:
  int columns_, rows_;
  std::vector<unsigned char> cells_;
  std::set<std::pair<int, int>> marks_;  // row and column
};

/// How gnuplot draws a curve. Lines take turns with the colours, so that each has its own.
std::string gnuplot_style(const Curve& curve, std::size_t line) {
  const auto colour = [&](const char* usual) {
    return curve.colour.empty() ? std::string(usual) : curve.colour;
  };
  const char* const turn = palette::kTurns[line % std::size(palette::kTurns)];
  switch (curve.style) {
    case CurveStyle::line:
      return fmt::format("1:2 with lines lc rgb '#{}' lw 2", colour(turn));
    case CurveStyle::dashed:
      return fmt::format("1:2 with lines lc rgb '#{}' lw 1.5 dt 2", colour(palette::kSoft));
    case CurveStyle::samples:
      return fmt::format("1:2 with linespoints lc rgb '#{}' pt 7 ps 0.5 lw 1.5", colour(turn));
    case CurveStyle::mark:
      return fmt::format("1:2 with points lc rgb '#{}' pt 6 ps 1.6 lw 2",
                         colour(palette::kVermilion));
    case CurveStyle::points:
      return fmt::format("1:2 with points lc rgb '#{}' pt {} ps 0.7", colour(turn),
                         curve.point_type);
    case CurveStyle::error_bars:
      return fmt::format("1:2:3 with yerrorbars lc rgb '#{}' pt {} ps 0.9 lw 1.5", colour(turn),
                         curve.point_type);
    case CurveStyle::band:
      return fmt::format("1:($2-$3):($2+$3) with filledcurves lc rgb '#{}'",
                         colour(palette::kBand));
  }
  return {};
}

/// Whether a curve takes its turn with the colours.
bool takes_turn(const Curve& curve) {
  return curve.colour.empty() && curve.style != CurveStyle::dashed &&
         curve.style != CurveStyle::mark && curve.style != CurveStyle::band;
}

std::string gnuplot_range(const AxisRange& range) {
  return fmt::format("[{:.17g}:{:.17g}]", range.low, range.high);
}

std::string gnuplot_header(const PlotLabels& labels) {
  const auto quoted = gnuplot_quoted;
  std::string script = fmt::format(
      "set title {}\nset xlabel {}\nset ylabel {}\nset grid lc rgb '#{}'\n"
      "set border 3\nset tics nomirror\nset key {}\n",
      quoted(labels.title), quoted(labels.x), quoted(labels.y), palette::kGrid, labels.key);
  if (labels.x_range) script += "set xrange " + gnuplot_range(*labels.x_range) + "\n";
  if (labels.x_step > 0) script += fmt::format("set xtics {:.17g}\n", labels.x_step);
  if (labels.y_range) return script + "set yrange " + gnuplot_range(*labels.y_range) + "\n";
  return script + fmt::format("set yrange [0:{}]\n",
                              labels.highest > 0 ? fmt::format("{:.17g}", labels.highest) : "*");
}

std::string gnuplot_script(const std::filesystem::path& path, std::span<const Curve> curves,
                           const PlotLabels& labels) {
  std::string script = gnuplot_terminal(path, labels.width_px, labels.height_px, labels.font_px) +
                       gnuplot_header(labels);
  std::string points;
  std::size_t turns = 0;
  for (const Curve& curve : curves) {
    if (curve.points.empty()) continue;
    script += fmt::format("{} '-' using {} {}", points.empty() ? "plot" : ",",
                          gnuplot_style(curve, turns),
                          curve.title.empty() ? "notitle" : "title " + gnuplot_quoted(curve.title));
    if (takes_turn(curve)) ++turns;
    for (const auto& point : curve.points)
      points += fmt::format("{:.17g} {:.17g} {:.17g}\n", point.x, point.y, point.error);
    points += "e\n";
  }
  if (points.empty()) throw Error(ErrorCode::bad_argument, "there is nothing to plot");
  return script + "\n" + points;
}

}  // namespace

std::string gnuplot_quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 2)
    text.insert(at, "'");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return "'" + text + "'";
}

std::string run_gnuplot(const std::string& script) {
  char name[] = "/tmp/fathom-plot-XXXXXX";
  const int file = ::mkstemp(name);
  if (file < 0) throw Error(ErrorCode::io, "cannot write a plot script to /tmp");
  ::close(file);
  write_file(name, script);
  std::FILE* const output = ::popen(fmt::format("gnuplot {} 2>/dev/null", name).c_str(), "r");
  std::string svg;
  char block[4096];
  for (std::size_t n; output != nullptr && (n = std::fread(block, 1, sizeof block, output)) > 0;) {
    svg.append(block, n);
  }
  const int status = output != nullptr ? ::pclose(output) : -1;
  ::unlink(name);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
    throw Error(ErrorCode::unavailable,
                "there is no gnuplot; install it (apt-get install gnuplot-nox)");
  }
  if (status != 0 || svg.empty()) {
    throw Error(ErrorCode::unavailable, "gnuplot cannot plot these values");
  }
  return svg;
}

std::string text_plot(std::span<const Evaluation> evaluations, const PlotLabels& labels,
                      int columns) {
  if (evaluations.empty()) return "(no points)\n";
  const FocusCurve curve({evaluations.begin(), evaluations.end()});
  constexpr int rows = 14, margin = 11;
  Canvas canvas(std::max(20, columns - margin), rows);
  const double left = curve.front().position, right = curve.back().position;
  const double top = curve.top().score > 0 ? curve.top().score : 1;
  const auto x = [&](double position) {
    return right > left ? (position - left) / (right - left) * (canvas.width() - 1) : 0;
  };
  const auto y = [&](double score) {
    return (1 - std::clamp(score / top, 0.0, 1.0)) * (canvas.height() - 1);
  };
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Evaluation& from = curve[i == 0 ? 0 : i - 1];
    canvas.line(x(from.position), y(from.score), x(curve[i].position), y(curve[i].score));
  }
  // Where every column has its own there would be no line left to see.
  const bool has_room = 2 * curve.size() <= static_cast<std::size_t>(canvas.width()) / 2;
  for (const Evaluation& e : curve.evaluations()) {
    if (has_room) canvas.mark(x(e.position), y(e.score));
  }
  std::string text = fmt::format("{:>{}}{}\n", "", margin, printable(labels.y));
  for (int row = 0; row < rows; ++row) {
    const std::string tick = row == 0          ? fmt::format("{:.3g}", top)
                             : row == rows - 1 ? std::string("0")
                                               : std::string();
    text += fmt::format("{:>{}} \u2502{}\n", tick, margin - 2, canvas.row(row));
  }
  const int width = canvas.width() / 2;
  text += fmt::format("{:>{}} \u2514", "", margin - 2);
  for (int column = 0; column < width; ++column) text += "\u2500";
  text += "\n";
  const std::string low = fmt::format("{:.6g}", left), high = fmt::format("{:.6g}", right);
  const int space = std::max(1, width - static_cast<int>(low.size() + high.size()));
  text += fmt::format("{:>{}}{}{:^{}}{}\n", "", margin, low, printable(labels.x), space, high);
  return text;
}

std::string gnuplot_terminal(const std::filesystem::path& path, int width_px, int height_px,
                             int font_px) {
  // pngcairo counts letters in points, of which three are four pixels, and draws marks half as wide.
  const bool png = path.extension() == ".png";
  return fmt::format(
      "set terminal {} size {},{} font 'sans,{:g}' background '#ffffff' noenhanced\n",
      png ? "pngcairo pointscale 2" : "svg", width_px, height_px, png ? 0.75 * font_px : font_px);
}

std::string svg_curves(std::span<const Curve> curves, const PlotLabels& labels) {
  return run_gnuplot(gnuplot_script("curves.svg", curves, labels));
}

void write_curves(const std::filesystem::path& path, std::span<const Curve> curves,
                  const PlotLabels& labels) {
  write_file(path, run_gnuplot(gnuplot_script(path, curves, labels)));
}

void plot(const std::string& where, std::span<const Evaluation> evaluations,
          const PlotLabels& labels, bool json, const Focus* focus) {
  if (where.empty()) return;
  if (where != "-") return write_focus_plot(where, evaluations, labels, focus);
  const std::string drawing = text_plot(evaluations, labels, std::min(terminal_columns(), 100));
  std::fputs(drawing.c_str(), json ? stderr : stdout);
}

bool is_picture(const std::string& where) {
  return where.ends_with(".svg") || where.ends_with(".png");
}

void require_plot_target(const std::string& where) {
  if (where.empty() || where == "-" || is_picture(where)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("cannot plot to {}; name a file ending in .svg or .png, or - for the "
                          "terminal",
                          where));
}

}  // namespace fathom::cli
