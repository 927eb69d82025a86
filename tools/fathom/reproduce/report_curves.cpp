// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "focus/noise.hpp"
#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

Table best_positions(const Curves& curves) {
  Table table;
  table.header = {"Target (mm)", "True focus", "FFT", "Normal Walsh", "Sequency Walsh"};
  table.alignment = "rrrrr";
  table.caption =
      "Position of the highest score, and in brackets that of the fitted peak, in steps.";
  for (const MeasuredCurves& curve : curves.curves) {
    std::vector<Cell> row = {fmt::format("{:g}", curve.distance_mm),
                             fmt::format("{:.2f}", curve.truth)};
    for (std::size_t t = 0; t < kTransformCount; ++t) {
      row.emplace_back(fmt::format("{:g} ({:.2f})", curve.best[t], curve.fitted[t]));
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string interval(const Ratio& ratio) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", ratio.value, ratio.low, ratio.high);
}

double mean_of(const Curves& curves, ThreeNumbers FarFloor::*which, std::size_t t) {
  std::vector<double> values;
  for (const FarFloor& floor : curves.floors) values.push_back((floor.*which)[t]);
  return summarise(values).mean;
}

Table roughness_table(const Curves& curves) {
  Table table;
  table.header = {"Transform",         "Level, of the peak",      "Roughness, of the peak",
                  "FFT is rougher by", "Roughness, of the level", "FFT is rougher by"};
  table.alignment = "lrrrrr";
  table.caption =
      fmt::format("Means over {} rigs; in brackets the 95 % confidence interval of the mean ratio.",
                  curves.floors.size());
  const Ratio* const of_peak[] = {nullptr, &curves.paley_of_peak, &curves.sequency_of_peak};
  const Ratio* const of_level[] = {nullptr, &curves.paley_of_level, &curves.sequency_of_level};
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    table.rows.push_back({kTransforms[t].name, percent(mean_of(curves, &FarFloor::level, t), 1),
                          percent(mean_of(curves, &FarFloor::of_peak, t), 3),
                          of_peak[t] == nullptr ? "" : interval(*of_peak[t]),
                          percent(mean_of(curves, &FarFloor::of_level, t), 2),
                          of_level[t] == nullptr ? "" : interval(*of_level[t])});
  }
  return table;
}

std::string white_noise(const char* metric) {
  return percent(white_noise_scatter(MetricSpec::parse(metric)));
}

Table bare_table(const Searches& searches) {
  Table table;
  table.header = {"Transform", "Runs", "Lost", "Largest error", "Evaluations"};
  table.alignment = "lrrrr";
  table.caption =
      "Golden section over the whole travel, 0 to 1200 steps, without a coarse pass, on the "
      "seedling. "
      "Lost: off by more than half of the depth of field.";
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const Trial& trial = searches.bare[t];
    table.rows.push_back(
        {kTransforms[t].name, std::to_string(trial.runs.size()), std::to_string(trial.wrong),
         percent(trial.size.most),
         fmt::format("{:.0f} to {:.0f}", trial.evaluations.least, trial.evaluations.most)});
  }
  return table;
}

Table repeat_table(const Repeatability& repeatability) {
  Table table;
  table.header = {"Target (mm)", "Lens", "Frames", "FFT", "Normal Walsh", "Sequency Walsh"};
  table.alignment = "rlrrrr";
  table.caption =
      "Half of the range of the readings as a part of their mean, and in brackets their "
      "standard deviation.";
  for (const Readings& r : repeatability.readings) {
    std::vector<Cell> row = {fmt::format("{:g}", r.distance_mm),
                             r.far ? "300 steps off" : "in focus", std::to_string(r.average)};
    for (std::size_t t = 0; t < kTransformCount; ++t) {
      const Summary s = r.of(t);
      row.emplace_back(
          fmt::format("{} ({})", plus_minus(s.half_range_part()), percent(s.sd / s.mean)));
    }
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

Section curves_section(const Results& results, const Artist& artist) {
  const Curves& curves = results.curves;
  return {
      "curves",
      "Focus quality against lens position (figures 11 to 13)",
      {Paragraph{"The lens went through its whole travel with the chart at three distances. One "
                 "picture at each position was scored by all three transforms, so nothing else "
                 "differs. Each curve is divided by its highest value, as the thesis' are."},
       curves_figure_13(artist, curves), curves_figure_11_12(artist, curves),
       curves_close_up(artist, curves), best_positions(curves),
       Paragraph{"All three have one peak, and it is at best focus. They are as good as each other "
                 "at finding it, as the thesis says."},
       Commands{{"fathom sweep --rig sim:distance=2000 --metric fft --step 5 --plot fft.svg",
                 "fathom sweep --rig sim:distance=2000 --metric walsh-paley --step 5 --plot "
                 "walsh.svg"}}}};
}

Section far_section(const Results& results, const Artist& artist) {
  return {
      "far",
      "Far from focus",
      {Paragraph{
           "The thesis saw larger fluctuations of the FFT under harsh defocus, did not measure "
           "them, and asked for that. The statistic here is the **roughness**: every 10 steps, "
           "more than 150 steps from focus, how far a score stands off the straight line through "
           "its two neighbours, `(y[i-1] - 2 y[i] + y[i+1]) / sqrt(6)`, as a root mean square. A "
           "slope adds nothing to it, independent noise its own deviation. It is given as a part "
           "of the peak, which is what the thesis' normalised plots show, and of the level far "
           "from focus."},
       far_figure(artist, results.curves), roughness_table(results.curves),
       Paragraph{fmt::format(
           "Walsh is the steadier one, by either measure. The reason is the noise of the pixels: "
           "by "
           "theory, white noise alone makes the level of these metrics fluctuate by {}, {} and {}. "
           "It is the taper that costs the FFT its steadiness, because it makes neighbouring "
           "frequencies alike and so leaves fewer to average over; without a taper it would be {}.",
           white_noise(kTransforms[kFft].metric), white_noise(kTransforms[kPaley].metric),
           white_noise(kTransforms[kSequency].metric), white_noise("fft:64:none"))},
       Paragraph{"It matters where a search starts without a bracket, on the far slopes:"},
       bare_table(results.searches),
       Commands{{"fathom focus --rig sim:target=seedling,distance=1700 --search golden --bracket "
                 "0,458,1200 --peak evaluated"}}}};
}

Section repeatability_section(const Results& results, const Artist& artist) {
  return {
      "repeatability",
      "How well a score repeats",
      {Paragraph{fmt::format(
           "The lens stood in one place and the chart was scored {} times, from one frame and from "
           "the mean of {}. A minute lies between two readings, as one FFT took the thesis.",
           results.effort.readings, kManyFrames)},
       repeatability_figure(artist, results.repeatability), repeat_table(results.repeatability),
       Paragraph{"In focus both of the thesis' limits hold. Ten frames help little, here as there: "
                 "what is left is light that changes slowly, not noise. (The thesis put it down to "
                 "the sensor's fixed pattern; a fixed pattern, being fixed, does not change a "
                 "reading from one time to the next.) Far from focus the noise is a larger part of "
                 "the score, most of all for the FFT, and there averaging does help."}}};
}

}  // namespace fathom::reproduce
