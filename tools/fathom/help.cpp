// SPDX-License-Identifier: Apache-2.0
// fathom help: what the program, a verb or a topic is about; and the same for man and for shells.
#include <filesystem>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "tools/fathom/completion.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/topics.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> words;
  std::string shell;
  std::string folder;
};

std::string typed_words(const std::vector<std::string>& words) {
  std::string text = "fathom";
  for (const std::string& word : words) text += " " + word;
  return text;
}

/// Of the program or of a verb below it; null where none has this name.
const VerbEntry* find_verb(const VerbEntry& verb, const std::string& name) {
  if (verb.name == name) return &verb;
  for (const VerbEntry& child : verb.verbs) {
    if (const VerbEntry* found = find_verb(child, name)) return found;
  }
  return nullptr;
}

const Topic* find_topic(const std::string& name) {
  for (const Topic& topic : topics()) {
    if (name == topic.name) return &topic;
  }
  return nullptr;
}

std::string list_of_topics() {
  std::string text = "\nTopics (fathom help TOPIC):\n";
  for (const Topic& topic : topics()) text += fmt::format("  {:<28}{}\n", topic.name, topic.help);
  return text;
}

[[noreturn]] void refuse(const std::string& name, const VerbEntry& program) {
  std::string known;
  for (const Topic& topic : topics()) known += std::string(" ") + topic.name;
  for (const VerbEntry& verb : program.verbs) {
    if (find_topic(verb.name.substr(7)) == nullptr) known += verb.name.substr(6);
  }
  throw Error(ErrorCode::bad_argument, fmt::format("no help on \"{}\"; there is{}", name, known));
}

std::string text_on(const std::vector<std::string>& words, const VerbEntry& program) {
  if (words.empty()) return help_text(program) + list_of_topics();
  if (words.size() == 1) {
    if (const Topic* topic = find_topic(words.front())) return topic->text();
  }
  if (const VerbEntry* verb = find_verb(program, typed_words(words))) return help_text(*verb);
  refuse(typed_words(words).substr(7), program);
}

std::string script_for(const std::string& shell, const VerbEntry& program) {
  std::string known;
  for (const Completion& completion : completions()) {
    if (shell == completion.shell) return completion.script(program);
    known += std::string(known.empty() ? "" : ", ") + completion.shell;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no completion for \"{}\"; there is one for {}", shell, known));
}

void write_below(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  write_file(path, text);
}

void write_pages(const fs::path& folder, const VerbEntry& verb) {
  write_below(folder / "man/man1" / (page_name(verb) + ".1"), man_page(verb, FATHOM_VERSION));
  for (const VerbEntry& child : verb.verbs) write_pages(folder, child);
}

/// Everything that other programs show of this one, below a folder that is laid out as share/ is.
void write_all(const fs::path& folder, const VerbEntry& program) {
  write_pages(folder, program);
  for (const Topic& topic : topics()) {
    write_below(folder / "man/man7" / fmt::format("fathom-{}.7", topic.name),
                man_page_of_topic(topic.name, topic.help, topic.text(), FATHOM_VERSION));
  }
  for (const Completion& completion : completions())
    write_below(folder / completion.file, completion.script(program));
}

int run(const Arguments& arguments, const VerbEntry& program) {
  if (!arguments.folder.empty()) {
    write_all(arguments.folder, program);
  } else if (!arguments.shell.empty()) {
    print_lines(script_for(arguments.shell, program));
  } else {
    print_lines(text_on(arguments.words, program));
  }
  return kDone;
}

}  // namespace

void add_help(Verb& program) {
  Verb verb = program.add_verb("help", "Tell of a verb or a topic: rigs, metrics, searches");
  verb.set_footer(
      "Examples:\n  fathom help rigs\n  fathom help focus\n"
      "  eval \"$(fathom help --completion bash)\"\n\n"
      "The pages of man and the files of shells that an installation has are written by --write.");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("TOPIC", arguments->words, "A topic, or a verb");
  verb.add_option("--completion", arguments->shell,
                  "Print what makes a shell complete fathom's words: bash, zsh or fish");
  verb.add_option("--write", arguments->folder,
                  "Folder for the pages of man and the completions, laid out as share/ is");
  verb.on_run([arguments, program] { return run(*arguments, program.manual()); });
}

}  // namespace fathom::cli
