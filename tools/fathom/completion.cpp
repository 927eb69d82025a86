// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/completion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/fathom/completion_values.hpp"

namespace fathom::cli {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// What is typed of a verb behind "fathom ": "rigs check".
std::string typed(const VerbEntry& verb) {
  const std::size_t blank = verb.name.find(' ');
  return blank == std::string::npos ? "" : verb.name.substr(blank + 1);
}

std::string last_word(const VerbEntry& verb) { return verb.name.substr(verb.name.rfind(' ') + 1); }

/// The program, its verbs and theirs.
std::vector<const VerbEntry*> with_children(const VerbEntry& verb) {
  std::vector<const VerbEntry*> all{&verb};
  for (const VerbEntry& child : verb.verbs) {
    for (const VerbEntry* one : with_children(child)) all.push_back(one);
  }
  return all;
}

std::string verb_words(const VerbEntry& verb) {
  std::vector<std::string> words;
  for (const VerbEntry& child : verb.verbs) words.push_back(last_word(child));
  return joined(words);
}

std::string option_words(const VerbEntry& verb) {
  std::vector<std::string> words;
  for (const OptionEntry& option : verb.options) {
    for (const std::string& name : names_of(option)) words.push_back(name);
  }
  return joined(words);
}

/// The table as the branches of three cases, which bash and zsh read alike: verbs and options by the
/// verb that was typed, values by verb and option, "-" being its first argument.
std::string shell_tables(const VerbEntry& program) {
  std::string verbs, options, values;
  for (const VerbEntry* verb : with_children(program)) {
    const std::string name = typed(*verb);
    if (!verb->verbs.empty())
      verbs += fmt::format("    '{}') echo '{}' ;;\n", name, verb_words(*verb));
    options += fmt::format("    '{}') echo '{}' ;;\n", name, option_words(*verb));
    const auto add = [&](const std::string& pattern, const OptionEntry& option) {
      const OfferedValues offered = offered_values(option);
      const std::string words = joined(offered.words) + (offered.has_files ? " FILES" : "");
      values += fmt::format("    {}) echo '{}' ;;\n", pattern, words.empty() ? " " : words);
    };
    for (const OptionEntry& option : verb->options) {
      if (option.value.empty()) continue;
      std::string pattern;
      for (const std::string& one : names_of(option))
        pattern += fmt::format("{}'{} {}'", pattern.empty() ? "" : "|", name, one);
      add(pattern, option);
    }
    if (!verb->arguments.empty()) add(fmt::format("'{} -'", name), verb->arguments.front());
  }
  return "_fathom_verbs() {\n  case $1 in\n" + verbs +
         "  esac\n}\n\n_fathom_options() {\n  case $1 in\n" + options +
         "  esac\n}\n\n_fathom_values() {\n  case \"$1 $2\" in\n" + values + "  esac\n}\n\n";
}

std::string bash_script(const VerbEntry& program) {
  return "# Completion of fathom for bash. Made from its help; do not edit.\n\n" +
         shell_tables(program) +
         R"(_fathom() {
  local line=${COMP_LINE:0:COMP_POINT} words word prev verb="" offered
  read -ra words <<<"$line"
  [[ $line == *' ' ]] && words+=("")
  word=${words[${#words[@]}-1]} prev=""
  if (( ${#words[@]} > 2 )); then
    verb=${words[1]} prev=${words[${#words[@]}-2]}
    if (( ${#words[@]} > 3 )) && [[ " $(_fathom_verbs "$verb") " == *" ${words[2]} "* ]]; then
      verb+=" ${words[2]}"
    fi
  fi
  if [[ $word == --*=* ]]; then
    prev=${word%%=*} word=${word#*=}
  fi
  COMPREPLY=()
  offered=$(_fathom_values "$verb" "$prev")
  if [[ -z $offered || $prev != -* ]]; then
    if [[ $word == -* ]]; then
      offered=$(_fathom_options "$verb")
    else
      offered=$(_fathom_verbs "$verb")
      [[ -n $offered ]] || offered=$(_fathom_values "$verb" -)
      [[ -n $offered ]] || offered="FILES"
    fi
  fi
  if [[ " $offered " == *' FILES '* ]]; then
    offered=${offered%FILES}
    compopt -o filenames 2>/dev/null
    local path=$word
    [[ $word == replay:* || $word == v4l2:* ]] && path=${word#*:}
    mapfile -t COMPREPLY < <(compgen -f -P "${word%"$path"}" -- "$path")
  fi
  while IFS= read -r path; do COMPREPLY+=("$path"); done < <(compgen -W "$offered" -- "$word")
  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *: ]] && compopt -o nospace 2>/dev/null
  # Colons part words for readline: what stands in front of the last one is not typed again.
  local kept=${word%"${word##*[:=]}"}
  COMPREPLY=("${COMPREPLY[@]#"$kept"}")
}
complete -F _fathom fathom
)";
}

std::string zsh_script(const VerbEntry& program) {
  return "#compdef fathom\n# Completion of fathom for zsh. Made from its help; do not edit.\n\n" +
         shell_tables(program) +
         R"(_fathom() {
  local word=${words[CURRENT]} prev="" verb="" offered
  if (( CURRENT > 2 )); then
    verb=${words[2]} prev=${words[CURRENT-1]}
    if (( CURRENT > 3 )) && [[ " $(_fathom_verbs "$verb") " == *" ${words[3]} "* ]]; then
      verb+=" ${words[3]}"
    fi
  fi
  offered=$(_fathom_values "$verb" "$prev")
  if [[ -z $offered || $prev != -* ]]; then
    if [[ $word == -* ]]; then
      offered=$(_fathom_options "$verb")
    else
      offered=$(_fathom_verbs "$verb")
      [[ -n $offered ]] || offered=$(_fathom_values "$verb" -)
      [[ -n $offered ]] || offered="FILES"
    fi
  fi
  local -a each=(${=offered%FILES})
  compadd -- ${each:#*:}
  compadd -S '' -- ${(M)each:#*:}
  if [[ " $offered " == *' FILES '* ]]; then
    compset -P 'replay:' || compset -P 'v4l2:'
    _files
  fi
}

if [[ $funcstack[1] == _fathom ]]; then
  _fathom "$@"
else
  compdef _fathom fathom
fi
)";
}

std::string fish_quoted(std::string text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

/// One line of fish: the option, what it takes, and its help.
std::string fish_option(const std::string& condition, const OptionEntry& option) {
  std::string line = fmt::format("complete -c fathom -n {}", fish_quoted(condition));
  for (const std::string& name : names_of(option)) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.value.empty()) {
    const OfferedValues offered = offered_values(option);
    line += offered.has_files ? " -r -F" : " -x";
    if (!offered.words.empty()) line += " -a " + fish_quoted(joined(offered.words));
  }
  return line + " -d " + fish_quoted(option.help) + "\n";
}

std::string fish_verb(const VerbEntry& verb, const std::string& condition) {
  std::string text;
  for (const OptionEntry& option : verb.options) text += fish_option(condition, option);
  for (const VerbEntry& child : verb.verbs) {
    text += fmt::format("complete -c fathom -f -n {} -a {} -d {}\n", fish_quoted(condition),
                        last_word(child), fish_quoted(child.help));
  }
  if (!verb.arguments.empty()) {
    const OfferedValues offered = offered_values(verb.arguments.front());
    if (!offered.words.empty()) {
      text += fmt::format("complete -c fathom -n {}{} -a {}\n", fish_quoted(condition),
                          offered.has_files ? "" : " -f", fish_quoted(joined(offered.words)));
    }
  }
  return text;
}

std::string fish_script(const VerbEntry& program) {
  std::string text = "# Completion of fathom for fish. Made from its help; do not edit.\n" +
                     fish_verb(program, "__fish_use_subcommand");
  for (const VerbEntry& verb : program.verbs) {
    std::string condition = "__fish_seen_subcommand_from " + last_word(verb);
    for (const VerbEntry& child : verb.verbs) {
      text += fish_verb(child, condition + "; and __fish_seen_subcommand_from " + last_word(child));
    }
    if (!verb.verbs.empty()) {
      condition += "; and not __fish_seen_subcommand_from " + verb_words(verb);
    }
    text += fish_verb(verb, condition);
  }
  return text;
}

constexpr Completion kCompletions[] = {
    {"bash", "bash-completion/completions/fathom", bash_script},
    {"zsh", "zsh/site-functions/_fathom", zsh_script},
    {"fish", "fish/vendor_completions.d/fathom.fish", fish_script},
};

}  // namespace

std::span<const Completion> completions() { return kCompletions; }

}  // namespace fathom::cli
