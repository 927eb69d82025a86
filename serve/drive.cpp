// SPDX-License-Identifier: Apache-2.0
#include "serve/drive.hpp"

#include <algorithm>

#include "engine/error.hpp"

namespace fathom::serve {

bool Drive::is_gone() const {
  return !pages_.contains(*driver_) && clock_.wall_s() - last_sign_s_ > kGone_s;
}

void Drive::hand_to(const std::string& client) {
  driver_ = client;
  last_sign_s_ = clock_.wall_s();
  std::erase_if(questions_, [&](const Question& one) { return one.client == client; });
}

bool Drive::may_command(const std::string& client) {
  if (!driver_ || *driver_ == client || is_gone()) hand_to(client);
  return *driver_ == client;
}

void Drive::ask(const std::string& client) {
  if (driver() == client) return;
  const auto is_same = [&](const Question& one) { return one.client == client; };
  if (std::ranges::any_of(questions_, is_same)) return;
  constexpr std::size_t kMost = 64;
  if (questions_.size() == kMost)
    throw Error(ErrorCode::unavailable, "too many ask to drive already");
  questions_.push_back({client, clock_.wall_s()});
}

bool Drive::has_waited(const std::string& client) const {
  return std::ranges::any_of(questions_, [&](const Question& one) {
    return one.client == client && clock_.wall_s() - one.since_s >= kAnswer_s;
  });
}

void Drive::take(const std::string& client) {
  if (driver_ && *driver_ != client && !is_gone() && !has_waited(client)) {
    throw Error(ErrorCode::unavailable,
                "somebody else drives; ask first, and take it 10 s later if nobody answers");
  }
  hand_to(client);
}

void Drive::require_driver(const std::string& client) const {
  if (driver_ == client) return;
  throw Error(ErrorCode::bad_argument, "this client does not drive");
}

void Drive::give(const std::string& client) {
  require_driver(client);
  if (questions_.empty()) {
    driver_.reset();
  } else {
    hand_to(std::string(questions_.front().client));
  }
}

void Drive::refuse(const std::string& client) {
  require_driver(client);
  questions_.clear();
  last_sign_s_ = clock_.wall_s();
}

void Drive::closed(const std::string& client) {
  const auto pages = pages_.find(client);
  if (pages == pages_.end() || --pages->second > 0) return;
  pages_.erase(pages);
  if (driver_ == client) last_sign_s_ = clock_.wall_s();
}

std::optional<std::string> Drive::driver() const {
  return driver_ && is_gone() ? std::nullopt : driver_;
}

std::vector<std::string> Drive::asking() const {
  std::vector<std::string> clients;
  for (const Question& one : questions_) clients.push_back(one.client);
  return clients;
}

}  // namespace fathom::serve
