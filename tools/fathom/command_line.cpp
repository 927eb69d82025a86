// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <utility>

#include "engine/error.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

std::string problem_of_count(const std::string& text) {
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && next == end && value >= 1) return {};
  return fmt::format("\"{}\" is not a whole number from 1 on", text);
}

/// An unset shell variable in quotes must not mean "not given".
void require_no_empty_argument(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (*argv[i] == '\0') {
      throw Error(
          ErrorCode::bad_argument,
          fmt::format("argument {} is empty; leave it out, with its option, or fill it in", i));
    }
  }
}

/// CLI11 takes a mistyped verb for an extra argument and says that one is missing.
void require_known_verb(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || *argv[1] == '-') return;
  std::string verbs;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_name() == argv[1]) return;
    verbs += " " + verb->get_name();
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no verb \"{}\"; there are{}; try fathom --help", argv[1], verbs));
}

/// What was wrong with the command line, in one line.
std::string problem_of(const CLI::ParseError& error) {
  std::string what = error.what();
  what = what.substr(0, what.find('\n'));
  // CLI11 says "Could not convert: --from = abc" of an option that takes a number.
  const std::string start = "Could not convert: ";
  if (!what.starts_with(start)) return what;
  what.erase(0, start.size());
  if (const auto equals = what.find(" = "); equals != std::string::npos)
    what.replace(equals, 3, " ");
  return what + ": write a number";
}

}  // namespace

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option Option::takes_one_at_a_time() {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::takes_commas() {
  option_->delimiter(',');
  return *this;
}

Option Option::at_least_one() {
  option_->check(CLI::Validator(problem_of_count, "", "at least 1"));
  return *this;
}

Option Option::one_of(std::vector<int> values) {
  option_->check(CLI::IsMember(std::move(values)));
  return *this;
}

Verb Verb::add_verb(const std::string& name, const std::string& help) {
  return {*app_->add_subcommand(name, help), *status_};
}

void Verb::require_verb() { app_->require_subcommand(1); }

void Verb::set_footer(const std::string& text) { app_->footer(text); }

void Verb::add_above_footer(const std::string& text) {
  app_->footer(text + "\n" + app_->get_footer());
}

template <OptionValue Value>
Option Verb::add_option(const std::string& names, Value& value, const std::string& help) {
  return Option(app_->add_option(names, value, help));
}

template Option Verb::add_option(const std::string&, std::string&, const std::string&);
template Option Verb::add_option(const std::string&, int&, const std::string&);
template Option Verb::add_option(const std::string&, std::size_t&, const std::string&);
template Option Verb::add_option(const std::string&, double&, const std::string&);
template Option Verb::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option Verb::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Verb::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Verb::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option Verb::add_option(const std::string&, std::vector<double>&, const std::string&);

void Verb::add_flag(const std::string& names, bool& value, const std::string& help) {
  app_->add_flag(names, value, help);
}

void Verb::on_run(std::function<int()> run) {
  app_->callback([run = std::move(run), status = status_] { *status = run(); });
}

CommandLine::CommandLine(const std::string& help, const std::string& version,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(help, "fathom")) {
  app_->set_version_flag("--version", version);
  app_->footer(footer);
  app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Verb CommandLine::program() { return {*app_, status_}; }

int CommandLine::run(int argc, const char* const* argv) {
  require_no_empty_argument(argc, argv);
  require_known_verb(*app_, argc, argv);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    const int done = app_->exit(help);
    flush_lines();
    return done;
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorCode::bad_argument,
                problem_of(error) + "; try fathom --help, or fathom VERB --help");
  }
  return status_;
}

}  // namespace fathom::cli
