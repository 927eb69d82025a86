// SPDX-License-Identifier: Apache-2.0
// fathom merge: what shards have printed, as one table.
#include <algorithm>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/merged_parts.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string table;
  std::vector<std::string> parts;
};

/// Whoever forgets the first argument would lose the first part.
void require_no_part(const Arguments& arguments) {
  if (std::ranges::find(arguments.parts, arguments.table) == arguments.parts.end() &&
      !is_shard(arguments.table)) {
    return;
  }
  throw Error(ErrorCode::bad_argument,
              printable(arguments.table) +
                  " is a part itself; the first argument is the table that is written");
}

std::string text_of(const MergedParts& merged, bool as_csv) {
  if (as_csv) return csv_of(merged);
  std::string text;
  for (const std::string& row : merged.rows) text += row + "\n";
  return text;
}

int run(const Arguments& arguments) {
  require_no_part(arguments);
  const MergedParts merged = merge_parts(arguments.parts);
  write_file(arguments.table, text_of(merged, arguments.table.ends_with(".csv")));
  print_line(fmt::format("{} rows of {} part{} in {}", merged.rows.size(), arguments.parts.size(),
                         arguments.parts.size() == 1 ? "" : "s", printable(arguments.table)));
  if (merged.failed == 0) return kDone;
  note(fmt::format("{} could not be read; their shards said why",
                   merged.failed == 1 ? "one picture or stack"
                                      : fmt::format("{} pictures or stacks", merged.failed)));
  return kError;
}

}  // namespace

void add_merge(Verb& program) {
  Verb verb =
      program.add_verb("merge", "Put together what fathom score or depth --shard has printed");
  verb.set_footer(
      "Example:\n  fathom score *.png --json --shard 1/2 > 1.json\n"
      "  fathom score *.png --json --shard 2/2 > 2.json\n  fathom merge scores.csv 1.json "
      "2.json\n\n"
      "The table is what one process would have printed. A shard that is missing, cut off or "
      "there\n"
      "twice is said, and nothing is written.");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("table", arguments->table,
                  "The file that is written: CSV, if its name ends so, else JSON lines")
      .required();
  verb.add_option("parts", arguments->parts, "Files with what the shards printed, in any order")
      .required();
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
