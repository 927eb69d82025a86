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

/// CLI11 takes 010 for eight, as C does, and 0x10 for sixteen. Whoever types 010 means ten.
std::string make_decimal(std::string& text) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  const std::size_t zeros = text.find_first_not_of('0', sign);
  if (zeros == sign) return {};
  if (zeros == std::string::npos) {
    text = "0";
  } else if (text.find_first_not_of("0123456789", sign) != std::string::npos) {
    return fmt::format("\"{}\" is not a whole number", text);
  } else {
    text.erase(sign, zeros - sign);
  }
  return {};
}

/// CLI11 takes 0x10 here too, and a number that no double holds.
std::string problem_of_number(const std::string& text) {
  double value = 0;
  const char* const start = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [next, error] = std::from_chars(start, text.data() + text.size(), value);
  const bool is_hexadecimal = text.find_first_of("xX") != std::string::npos;
  if (error != std::errc::result_out_of_range && !is_hexadecimal) return {};
  return fmt::format("\"{}\" is no decimal number of usual size; write a number", text);
}

template <OptionValue Value>
void require_plain(CLI::Option& option) {
  if constexpr (OneOf<Value, int, std::size_t, std::optional<int>, std::vector<int>>)
    option.transform(CLI::Validator(make_decimal, "", "decimal"));
  if constexpr (OneOf<Value, double, std::optional<double>, std::vector<double>>)
    option.check(CLI::Validator(problem_of_number, "", "a number"));
}

bool misses_a_value(std::string_view list) {
  return list.starts_with(',') || list.ends_with(',') || list.find(",,") != std::string_view::npos;
}

/// CLI11 passes over the empty one of 1400,,1500, which may be a number that somebody forgot.
void require_no_empty_value(const CLI::App& app, int argc, const char* const* argv) {
  const auto verbs =
      app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == argv[1]; });
  const CLI::Option* list = nullptr;
  for (int i = 2; !verbs.empty() && i < argc; ++i) {
    std::string_view value = argv[i];
    if (value.starts_with("--")) {
      const std::string_view name = value.substr(0, value.find('='));
      list = verbs[0]->get_option_no_throw(std::string(name));
      value.remove_prefix(std::min(name.size() + 1, value.size()));
    }
    if (list == nullptr || list->get_delimiter() == '\0' || !misses_a_value(value)) continue;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} {}: a value is missing beside a comma", list->get_name(), value));
  }
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

OptionEntry entry_of(const CLI::Option& option) {
  OptionEntry entry;
  entry.names = option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  const bool is_flag = option.get_items_expected_max() == 0 || option.get_type_size() == 0;
  if (!is_flag) entry.value = option.get_type_name();
  entry.initial = option.get_default_str();
  entry.help = option.get_description();
  entry.is_required = option.get_required();
  entry.is_repeatable = option.get_expected_max() > 1;
  return entry;
}

VerbEntry manual_of(const CLI::App& app, const std::string& name) {
  VerbEntry verb{.name = name,
                 .help = app.get_description(),
                 .arguments = {},
                 .options = {},
                 .verbs = {},
                 .notes = app.get_footer()};
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? verb.arguments : verb.options).push_back(entry_of(*option));
  for (const CLI::App* child : app.get_subcommands([](const CLI::App*) { return true; }))
    verb.verbs.push_back(manual_of(*child, name + " " + child->get_name()));
  return verb;
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
  CLI::App* const verb = app_->add_subcommand(name, help);
  verb->footer("");  // Else it would have that of the program.
  return {*verb, *status_};
}

void Verb::require_verb() { app_->require_subcommand(1); }

void Verb::set_footer(const std::string& text) { app_->footer(text); }

template <OptionValue Value>
Option Verb::add_option(const std::string& names, Value& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(names, value, help);
  require_plain<Value>(*option);
  return Option(option);
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

VerbEntry Verb::manual() const { return manual_of(*app_, app_->get_name()); }

CommandLine::CommandLine(const std::string& help, const std::string& version,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(help, "fathom")) {
  app_->set_version_flag("--version", version);
  app_->footer(footer);
  app_->require_subcommand(1);
  app_->formatter_fn([](const CLI::App* verb, const std::string& name, CLI::AppFormatMode) {
    return help_text(manual_of(*verb, name));
  });
}

CommandLine::~CommandLine() = default;

Verb CommandLine::program() { return {*app_, status_}; }

int CommandLine::run(int argc, const char* const* argv) {
  require_no_empty_argument(argc, argv);
  require_known_verb(*app_, argc, argv);
  if (argc > 1) require_no_empty_value(*app_, argc, argv);
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
