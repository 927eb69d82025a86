// SPDX-License-Identifier: Apache-2.0
// Verbs, options and flags. CLI11 parses them; only command_line.cpp includes its headers, which
// take a compiler longer than any verb.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/fathom/manual.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fathom::cli {

/// What the value of an option may be.
template <typename T, typename... Types>
concept OneOf = (std::same_as<T, Types> || ...);
template <typename T>
concept OptionValue =
    OneOf<T, std::string, int, std::size_t, double, std::optional<int>, std::optional<double>,
          std::vector<std::string>, std::vector<int>, std::vector<double>>;

/// An option that has been added to a verb, for what more is to be said of it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  /// The help shows the value that the variable has now.
  Option shows_default();
  /// Several values are written "--name 1 --name 2", never "--name 1 2".
  Option takes_one_at_a_time();
  /// Several values may be written "--name 1,2".
  Option takes_commas();
  /// Accepts whole numbers from 1 on.
  Option at_least_one();
  Option one_of(std::vector<int> values);

 private:
  CLI::Option* option_;
};

/// A verb, or the program itself. A handle, alive as long as its CommandLine.
class Verb {
 public:
  Verb(CLI::App& app, int& status) : app_(&app), status_(&status) {}

  Verb add_verb(const std::string& name, const std::string& help);
  /// One of the verbs that were added must be given.
  void require_verb();
  /// What --help ends with.
  void set_footer(const std::string& text);
  /// names: "-o,--output", or "FILE" for an argument without a name. `value` must live as long as
  /// the CommandLine.
  template <OptionValue Value>
  Option add_option(const std::string& names, Value& value, const std::string& help);
  void add_flag(const std::string& names, bool& value, const std::string& help);
  /// Called where the verb was given, after its options have their values. What `run` returns is
  /// the exit status of the program.
  void on_run(std::function<int()> run);
  /// What --help says, as values. Complete once all verbs and options were added.
  VerbEntry manual() const;

 private:
  CLI::App* app_;
  int* status_;
};

/// What was typed, taken apart.
class CommandLine {
 public:
  /// help: what the program is; footer: what its --help ends with.
  CommandLine(const std::string& help, const std::string& version, const std::string& footer);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// To add verbs to.
  Verb program();
  /// Runs the verb that was given, or prints help, and returns the exit status. Throws
  /// Error(bad_argument) for what it does not understand, and what the verb throws.
  int run(int argc, const char* const* argv);

 private:
  std::unique_ptr<CLI::App> app_;
  int status_ = 0;
};

}  // namespace fathom::cli
