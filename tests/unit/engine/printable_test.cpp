// SPDX-License-Identifier: Apache-2.0
#include "engine/printable.hpp"

#include <gtest/gtest.h>

#include "engine/error.hpp"

namespace fathom {
namespace {

TEST(Printable, LeavesTextOfEveryLanguageAlone) {
  for (const char* text : {"", "stack 1.png", "Grünalge µm", "焦点", "\U0001F52C"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, NoByteCommandsATerminal) {
  EXPECT_EQ(printable("a\x1b[31m"), "a\\x1b[31m");
  EXPECT_EQ(printable("a\nb\t\x7f"), "a\\x0ab\\x09\\x7f");
  EXPECT_EQ(printable("\u009b2J"), "\\xc2\\x9b2J") << "eight-bit controls";
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J")
      << "the same without UTF-8";
  EXPECT_EQ(printable("gnp\u202e.exe"), "gnp\\xe2\\x80\\xae.exe") << "right to left";
  EXPECT_EQ(printable("\u2066a\u2028"), "\\xe2\\x81\\xa6a\\xe2\\x80\\xa8");
}

TEST(Printable, WhatIsNoUtf8IsSpelledOut) {
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "longer than it need be";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half a pair of UTF-16";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
}

TEST(Printable, ErrorsAreMadeSo) {
  EXPECT_STREQ(Error(ErrorCode::io, "cannot read \x1b[2J\u009b").what(),
               "cannot read \\x1b[2J\\xc2\\x9b");
}

}  // namespace
}  // namespace fathom
