// SPDX-License-Identifier: Apache-2.0
// The USAF-1951 resolution chart (MIL-STD-150A): elements of three upright and three level bars,
// six elements to a group, each 2^(1/6) finer than the last.
#include <cmath>

#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {
namespace {

constexpr double kWhite = 0.85;
constexpr double kBlack = 0.05;

/// Even groups of the chart; each sheet holds one and the odd group after it. The coarsest fills
/// the field at 10 m, the finest is beyond the sensor at the nearest distance.
constexpr int kCoarsestGroup = -6;
constexpr int kFinestGroup = 2;

double line_width_mm(int group, int element) {
  return 0.5 / std::exp2(group + (element - 1) / 6.0);
}

/// One element with its upper left corner at (x, y): 11 line widths wide and 5 high.
void draw_element(Layer& chart, double x_mm, double y_mm, double line_mm) {
  for (int bar = 0; bar < 3; ++bar) {
    const double along = 2 * bar * line_mm;
    chart.paint_rectangle(x_mm + along, y_mm, line_mm, 5 * line_mm, kBlack);
    chart.paint_rectangle(x_mm + 6 * line_mm, y_mm + along, 5 * line_mm, line_mm, kBlack);
  }
}

/// Elements of a group one below the other.
void draw_column(Layer& chart, double x_mm, double y_mm, int group, int first_element) {
  for (int element = first_element; element <= 6; ++element) {
    const double line_mm = line_width_mm(group, element);
    draw_element(chart, x_mm, y_mm, line_mm);
    y_mm += 6 * line_mm;
  }
}

/// Elements 2 to 6 of an even group on the left, the next group on the right, element 1 below it,
/// and room between for the next sheet, a quarter as large. The numbers place the columns so that
/// all sheets shrink towards the middle of the picture: wherever the window is cut, it has fine
/// detail.
void draw_sheet(Layer& chart, int group) {
  const double line_mm = line_width_mm(group, 1);
  draw_column(chart, -14.0 * line_mm, -13.8 * line_mm, group, 2);
  draw_column(chart, 2.8 * line_mm, -12.0 * line_mm, group + 1, 1);
  draw_element(chart, -2.7 * line_mm, 2.6 * line_mm, line_mm);
}

}  // namespace

void draw_usaf(Scene& scene, double cell_mm) {
  Layer& chart = scene.layers.emplace_back(0.0, cell_mm);
  chart.fill(kWhite);
  for (int group = kCoarsestGroup; group <= kFinestGroup; group += 2) draw_sheet(chart, group);
}

}  // namespace fathom::simulated
