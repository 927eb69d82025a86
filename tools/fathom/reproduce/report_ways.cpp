// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

Table ways_table(const Ways& ways) {
  Table table;
  table.header = {"Way",        "Runs",           "Distances",    "Wrong",
                  "Frames",     "Travel (steps)", "Times direct", "Rig time (s)",
                  "Mean error", "Largest"};
  table.alignment = "lrrrrrrrrr";
  table.caption =
      "Wrong: off by more than half of the depth of field. Travel: from the start to the last "
      "picture; times direct: all of it over all direct ways. Errors: of the distances told.";
  for (const Way* way : ways.all()) {
    const Trial& trial = way->trial;
    const bool any = trial.answers > 0;
    table.rows.push_back(
        {trial.name, std::to_string(trial.runs.size()), std::to_string(trial.answers),
         std::to_string(trial.wrong), fmt::format("{:.1f}", way->frames.mean),
         fmt::format("{:.0f}", way->travel.mean), fmt::format("{:.2f}", way->times_direct),
         fmt::format("{:.1f}", way->rig_seconds.mean), any ? percent(trial.size.mean, 3) : "-",
         any ? percent(trial.size.most, 2) : "-"});
  }
  return table;
}

std::string right_words(const Trial& trial) {
  const std::string wrong = trial.wrong > 0 ? fmt::format(", {} wrong", trial.wrong) : "";
  return fmt::format("{} of {}{}", right_of(trial), trial.runs.size(), wrong);
}

Table noise_table(const Ways& ways) {
  Table table;
  table.header = {"Noise over the rig's", "dB", "Thesis' metric, coarse pass", "By spectra"};
  table.alignment = "rrrr";
  table.caption = "Right answers.";
  for (const NoiseLevel& level : ways.noise) {
    table.rows.push_back({fmt::format("{:g}", level.times), fmt::format("{:.1f}", level.decibels()),
                          right_words(level.coarse), right_words(level.spectral)});
  }
  return table;
}

Cell met(bool is_true) { return {is_true ? "met" : "missed", is_true ? Mark::holds : Mark::fails}; }

void add_cost_bars(Table& table, const Way& spectral) {
  const Trial& trial = spectral.trial;
  const auto runs = static_cast<int>(trial.runs.size());
  table.rows.push_back({"Travel", "at most 1.5 times the direct way",
                        fmt::format("{:.2f} times", spectral.times_direct),
                        met(spectral.times_direct <= 1.5)});
  table.rows.push_back(
      {"Time of the rig", "at most 1.5 times the direct travel at 25 steps/s, and 3 s",
       fmt::format("{:.1f} s; the bar is {:.1f} s", spectral.rig_seconds.mean, spectral.allowed_s),
       met(spectral.rig_seconds.mean <= spectral.allowed_s)});
  table.rows.push_back(
      {"Error", "mean at most 0.03 %, none over half of the depth of field",
       fmt::format("mean {}, {} wrong, {} of {} focused", percent(trial.size.mean, 4), trial.wrong,
                   trial.answers, runs),
       met(trial.size.mean <= 0.0003 && trial.wrong == 0 && trial.answers == runs)});
}

void add_frames_bars(Table& table, const Way& near) {
  const auto runs = static_cast<int>(near.trial.runs.size());
  table.rows.push_back({"Three frames, from within 200 steps", "error at most 0.5 % in nine of ten",
                        fmt::format("{} of {}, {} wrong", near.close, runs, near.trial.wrong),
                        met(10 * near.close >= 9 * runs)});
  table.rows.push_back({"Their sigma", "errors 0.7 to 1.3 sigmas, rms",
                        fmt::format("{:.2f} sigmas", near.off_in_sigmas),
                        met(near.off_in_sigmas >= 0.7 && near.off_in_sigmas <= 1.3)});
}

void add_noise_bars(Table& table, const Ways& ways) {
  const Trial& loud = level_at(ways, 24).spectral;
  const Trial& loud_before = level_at(ways, 24).coarse;
  table.rows.push_back(
      {"Noise 24 times the rig's", "every chart found",
       fmt::format("{}; with the coarse pass {}", right_words(loud), right_words(loud_before)),
       met(right_of(loud) == static_cast<int>(loud.runs.size()))});
  const double before = noise_stood(ways, &NoiseLevel::coarse);
  const double now = noise_stood(ways, &NoiseLevel::spectral);
  table.rows.push_back({"Nine of ten right", "10 dB more noise than with the thesis' metric",
                        fmt::format("up to {:.0f} dB, instead of {:.0f} dB", now, before),
                        met(now - before >= 9.5)});
  table.rows.push_back({"A blank card with all these noises", "never focused",
                        fmt::format("{} of {} focused", ways.blank.answers, ways.blank.runs.size()),
                        met(ways.blank.answers == 0)});
}

Table way_bars_table(const Ways& ways) {
  Table table;
  table.header = {"What", "Bar", "Here", "Outcome"};
  table.alignment = "llll";
  table.folds = true;
  add_cost_bars(table, ways.spectral);
  add_frames_bars(table, ways.three_near);
  add_noise_bars(table, ways);
  return table;
}

}  // namespace

Section ways_section(const Results& results, const Artist& artist) {
  const Ways& ways = results.ways;
  return {
      "ways",
      "The thesis' way and this way",
      {Paragraph{
           "Scores cost microseconds, motors and exposures cost seconds. So it counts how far the "
           "lens travels, and how many frames it stops for. All ways measure the same chart at the "
           "same random distances (1400 to 2600 mm), from the same random places of the lens (0 "
           "to 1199). Golden section is told a bracket round the focus, as the thesis' operator "
           "told it; the others are told nothing. Three frames are depth from defocus: no more "
           "frames than these, whatever they leave unsaid."},
       ways_table(ways), ways_figure(artist, ways),
       Paragraph{
           "The whole spectrum also stands more noise than its moment does: every ring of "
           "frequencies rises and falls by a law of optics, and all rings of all pictures tell of "
           "one focus. Below, the noise of the simulated camera grows to 96 times what it is, and "
           "the lamp wanders more by as much."},
       noise_figure(artist, ways), noise_table(ways), way_bars_table(ways),
       Commands{{"fathom focus --rig sim:distance=1700,start=300 --json            # travel, "
                 "rig_seconds, frames",
                 "fathom focus --rig sim:distance=1700,start=300 --search coarse --json",
                 "fathom focus --rig sim:distance=1700,start=700 --frames 3"}}}};
}

}  // namespace fathom::reproduce
