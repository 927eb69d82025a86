// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {

Section speed_section(const ThisRun& this_run) {
  const cli::ThesisTimes& times = this_run.times;
  Table table;
  table.header = {"What", "Thesis (68010)", "Here", "Times faster"};
  table.alignment = "lrrr";
  for (const cli::ThesisTime& time : times.rows) {
    table.rows.push_back(
        {time.what, time.thesis_text(), time.here_text(), fmt::format("{:.3g}", time.times())});
  }
  const double ratio = times.rows[0].here_s / times.rows[1].here_s;
  Table claims;
  claims.header = {"Claim", "In the thesis", "Its number", "Ours", "Outcome"};
  claims.alignment = "lllll";
  claims.folds = true;
  claims.rows.push_back({"Walsh is more than three times faster than the FFT",
                         "p. 94",
                         "55 s to 17 s",
                         fmt::format("{:.2f} times as fast", ratio),
                         {to_string(holds_if(ratio > 3)), holds_if(ratio > 3)}});
  // The motor counts too: one cycle of lens and camera for each evaluation.
  const double whole_s =
      times.search_s + static_cast<double>(times.evaluations) * times.rows[2].here_s;
  const double faster = times.rows[3].least_s / whole_s;
  const Mark hundred = holds_if(faster > 100, faster > 10 ? Mark::partly : Mark::fails);
  claims.rows.push_back(
      {"A whole focus cycle could be almost two orders of magnitude faster",
       "p. 94",
       "20 to 30 min",
       fmt::format("{:.0f} s with the simulated motor's 25 steps/s, {:.0f} times faster; the "
                   "computing of it {}",
                   whole_s, faster, times.rows[3].here_text()),
       {to_string(hundred), hundred}});
  const Mark bar = holds_if(times.search_s < 0.002);
  claims.rows.push_back({"Fathom's own bar: the computing of a whole distance takes less than 2 ms",
                         "",
                         "",
                         fmt::format("{:.3f} ms", 1e3 * times.search_s),
                         {to_string(bar), bar}});
  return {
      "speed",
      "Speed, and this run",
      {Paragraph{fmt::format(
           "All that may differ between two runs is in this section. One distance is a search of "
           "{} "
           "evaluations with its verdict; lens and camera are the simulated rig's, by its clock.",
           times.evaluations)},
       table, claims,
       Paragraph{
           "Computing is no burden any more. What takes time now is the motor, and the frames "
           "that the camera must wait for."},
       Bullets{{"Program: " + this_run.program, "Computed by: " + times.device,
                "Machine: " + this_run.machine, "Date: " + this_run.date}},
       Commands{{"fathom bench --thesis"}}}};
}

}  // namespace fathom::reproduce
