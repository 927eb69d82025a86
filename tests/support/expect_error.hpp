// SPDX-License-Identifier: Apache-2.0
// An Error of the right kind, whose message is one line that names what matters.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "engine/error.hpp"

namespace fathom::test {

/// Expects that the call throws Error with this code, in house style (one line, no trailing
/// period), and that the message holds every one of the texts.
template <class Call>
void expect_error(ErrorCode code, Call&& call, std::initializer_list<const char*> texts = {}) {
  try {
    call();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.code(), code) << to_string(error.code()) << ": " << message;
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_FALSE(message.ends_with('.')) << message;
    for (const char* text : texts) {
      EXPECT_NE(message.find(text), std::string::npos) << "no \"" << text << "\" in: " << message;
    }
    return;
  }
  ADD_FAILURE() << "nothing was thrown, not even " << to_string(code);
}

}  // namespace fathom::test
