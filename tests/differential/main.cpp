// SPDX-License-Identifier: Apache-2.0
// Random metrics on random pictures: every device against every other, and against the oracle.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <random>

#include "tests/differential/judge.hpp"

namespace fathom::differential {
namespace {

constexpr const char* kUsage =
    R"(fathom_differential [OPTION VALUE]... [--keep-going]

  --seed S            of the first round, the next has S + 1; "random" takes one and tells it (1)
  --rounds N          at most so many (100); 0: no limit
  --seconds T         starts no round after so long; 0: no limit (0)
  --case TEXT         this one case instead, as a failure prints it; again for more
  --device A,B        only these, such as vulkan:0,cpu:0; else every one that opens
  --transform A,B     only these
  --n A,B             only windows of these sides, the first likelier
  --picture A,B       only pictures of these kinds
  --bits 8            only 8-bit pictures, or 16-bit ones
  --reference-ms T    how long the oracle may take over a round (50); it always scores two windows
  --keep-going        counts failures to the end, rather than stop at the first

Exit status: 0 no failure, 1 failures, 2 wrong usage.
)";

struct Options {
  std::uint64_t seed = 1;
  std::size_t rounds = 100;
  double seconds = 0, reference_ms = 50;
  std::vector<Case> only;
  std::vector<std::string> devices;
  Choice choice;
  bool keeps_going = false;
};

std::vector<std::string> list(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::vector<int> numbers(const std::string& text) {
  std::vector<int> all;
  for (const std::string& part : list(text)) all.push_back(std::stoi(part));
  return all;
}

void set(Options& options, const std::string& name, const std::string& value) {
  if (name == "--seed") {
    options.seed = value == "random" ? std::random_device()() : std::stoull(value);
  } else if (name == "--rounds") {
    options.rounds = std::stoull(value);
  } else if (name == "--seconds") {
    options.seconds = std::stod(value);
  } else if (name == "--reference-ms") {
    options.reference_ms = std::stod(value);
  } else if (name == "--case") {
    options.only.push_back(Case::parse(value));
  } else if (name == "--device") {
    options.devices = list(value);
  } else if (name == "--transform") {
    options.choice.transforms = list(value);
  } else if (name == "--n") {
    options.choice.sides = numbers(value);
  } else if (name == "--picture") {
    options.choice.pictures = list(value);
  } else if (name == "--bits") {
    options.choice.bits = numbers(value);
  } else {
    throw std::invalid_argument("no option " + name);
  }
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--keep-going") {
      options.keeps_going = true;
    } else {
      if (i + 1 >= argc) throw std::invalid_argument(name + " wants a value");
      set(options, name, argv[++i]);
    }
  }
  return options;
}

std::vector<Examinee> chosen(const Options& options) {
  const auto all = all_examinees([](const std::string& line) { fmt::print("{}\n", line); });
  if (options.devices.empty()) return all;
  std::vector<Examinee> some;
  for (const std::string& label : options.devices) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Examinee& one) { return one.label == label; });
    if (found == all.end()) throw std::invalid_argument("no device " + label);
    some.push_back(*found);
  }
  return some;
}

/// Prints each mismatch and the least case that repeats it.
void tell(Judge& judge, const Case& failing, const std::vector<Mismatch>& mismatches) {
  for (const Mismatch& mismatch : mismatches) {
    const Case least = minimised(judge, failing, mismatch.label);
    fmt::print("WRONG {} window {}: {}\n", mismatch.label, mismatch.window, mismatch.what);
    fmt::print("repeat: fathom_differential --device {} --case '{}'\n", mismatch.label,
               least.text());
  }
  std::fflush(stdout);
}

void print_tallies(const Judge& judge) {
  for (const auto& [label, tally] : judge.tallies()) {
    fmt::print("{}: {} cases, {} windows\n", label, tally.cases, tally.windows);
    if (tally.judged > 0) {
      fmt::print("  {} with a tolerance beside the reference, {} of them as good as in double\n",
                 tally.judged, tally.as_good_double);
      fmt::print("  worst {:.4f} tolerances: {}\n", tally.worst, tally.worst_case);
    }
    for (const auto& [reason, specs] : tally.declined) {
      fmt::print("  DECLINED {} metrics, such as {}: {}\n", specs.size(), *specs.begin(), reason);
    }
  }
}

int run(const Options& options) {
  Judge judge(chosen(options), options.reference_ms);
  std::size_t rounds = 0, failures = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto is_over = [&] {
    if (!options.only.empty()) return rounds == options.only.size();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    return (options.rounds > 0 && rounds == options.rounds) ||
           (options.seconds > 0 && spent.count() > options.seconds);
  };
  while (!is_over() && (failures == 0 || options.keeps_going)) {
    const std::uint64_t seed = options.seed + rounds++;
    const Case tested =
        options.only.empty() ? random_case(seed, options.choice) : options.only[rounds - 1];
    const auto mismatches = judge.examine(tested);
    if (mismatches.empty()) continue;
    ++failures;
    fmt::print("round of seed {}\n", seed);
    tell(judge, tested, mismatches);
  }
  fmt::print("{} rounds from seed {}, {} failed\n", rounds, options.seed, failures);
  if (options.rounds > 0 && rounds < options.rounds && failures == 0 && options.only.empty()) {
    fmt::print("STOPPED EARLY: {} rounds were asked for\n", options.rounds);
  }
  print_tallies(judge);
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace fathom::differential

int main(int argc, char** argv) {
  using namespace fathom::differential;
  try {
    return run(parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n\n{}", error.what(), kUsage);
    return 2;
  }
}
