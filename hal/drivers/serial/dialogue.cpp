// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/dialogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::serial {
namespace {

constexpr int kTries = 3;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kQuiet_ns = kSecond_ns / 20;

std::int64_t ns_of(double seconds) { return static_cast<std::int64_t>(seconds * kSecond_ns); }

/// A text without its ends of lines and other bytes that nobody reads.
std::string readable(std::string text) {
  std::erase_if(text, [](unsigned char c) { return c < 0x20 || c >= 0x7f; });
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::string line;
  for (const char c : text + "\n") {
    if (c != '\n' && c != '\r') {
      line += c;
    } else if (!line.empty()) {
      lines.push_back(readable(std::exchange(line, {})));
    }
  }
  return lines;
}

}  // namespace

std::int64_t Dialogue::timeout_ns() const { return ns_of(profile_.timeout_s); }

void Dialogue::begin() {
  if (profile_.greeting) {
    // Not every board is reset by being opened: no greeting is no fault.
    const std::int64_t until_ns = monotonic_now_ns() + ns_of(profile_.wait_s);
    while (const auto line = port_.read_line(until_ns)) {
      if (profile_.greeting->is_in(*line)) break;
    }
  } else if (profile_.wait_s > 0) {
    sleep_until_ns(monotonic_now_ns() + ns_of(profile_.wait_s));
  }
  for (const Command& command : profile_.open) {
    if (order(command)) continue;
    fail_silent(command);
  }
}

void Dialogue::fail_silent(const Command& question) const {
  throw Error(ErrorCode::timeout,
              fmt::format("{} on {} does not answer \"{}\" within {} s; is it switched on, is it a "
                          "{}, and is baud = {} its speed?",
                          profile_.name, port_.path(), readable(question.text()),
                          profile_.timeout_s, profile_.name, profile_.baud));
}

void Dialogue::heed_troubles(const std::string& line) {
  for (const TroubleLine& trouble : profile_.troubles) {
    const auto found = trouble.match.find(line);
    if (!found) continue;
    const std::string what = fmt::format("{} says \"{}\": {}", profile_.name, line, trouble.words);
    if (trouble.trouble == Trouble::lost) {
      lost_ = what;
      throw Error(ErrorCode::device_lost, what);
    }
    if (!is_interrupting_) throw Error(ErrorCode::unsupported, what);
  }
}

/// The next line that is neither empty nor our own.
std::optional<std::string> Dialogue::next_line(std::int64_t until_ns) {
  while (auto line = port_.read_line(until_ns)) {
    if (line->empty()) continue;
    if (std::erase(sent_, *line) > 0) continue;
    heard_ns_ = monotonic_now_ns();
    heed_troubles(*line);
    return line;
  }
  return std::nullopt;
}

/// What has come unasked, or too late, is no answer to what is said now.
void Dialogue::send(const std::string& text) {
  while (next_line(0)) {
  }
  port_.write(text);
  sent_ = lines_of(text);
  asked_ns_ = monotonic_now_ns();
}

void Dialogue::say(const Command& command) { send(command.text()); }

std::optional<Answer> Dialogue::hear(const Command& command, std::int64_t until_ns) {
  std::optional<Answer> answer;
  while (const auto line = next_line(until_ns)) {
    if (!answer) {
      const auto found = command.answer->find(*line);
      if (!found) continue;
      answer = Answer{*line, *found, asked_ns_, heard_ns_};
      if (!command.done) return answer;
      continue;
    }
    if (command.done->is_in(*line)) return answer;
  }
  return answer;
}

Answer Dialogue::ask(const Command& question) {
  for (int i = 0; i < kTries; ++i) {
    send(question.text());
    if (auto answer = hear(question, asked_ns_ + timeout_ns())) return *std::move(answer);
  }
  fail_silent(question);
}

bool Dialogue::order(const Command& command, const Place& place) {
  send(command.text(place));
  if (!command.answer) return true;
  const auto answer = hear(command, asked_ns_ + timeout_ns());
  if (answer && command.good && !command.good->is_in(answer->line)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} refuses \"{}\" and says \"{}\"", profile_.name,
                            readable(command.text(place)), answer->line));
  }
  return answer.has_value();
}

void Dialogue::interrupt(const Command& command) {
  is_interrupting_ = true;
  try {
    send(command.text());
    while (next_line(monotonic_now_ns() + kQuiet_ns)) {
    }
  } catch (...) {
    is_interrupting_ = false;
    throw;
  }
  is_interrupting_ = false;
}

}  // namespace fathom::serial
