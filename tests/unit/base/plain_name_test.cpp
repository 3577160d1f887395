// SPDX-License-Identifier: Apache-2.0
#include "base/plain_name.hpp"

#include <gtest/gtest.h>

namespace delfront {
namespace {

TEST(PlainName, text_stays_as_it_is) {
  for (const char* name :
       {"", "wing", "a b", "Flügel", "翼", "\U0001F6E9", "\xed\x9f\xbf", "\xee\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_EQ(plain_name(name), name);
}

TEST(PlainName, what_is_no_text_becomes_underlines) {
  EXPECT_EQ(plain_name("bad\xff\xfe"
                       "utf"),
            "bad__utf");
  EXPECT_EQ(plain_name("\x1b[31mred\n"), "_[31mred_");
  EXPECT_EQ(plain_name("\xc2\x85"
                       "a\x7f"),
            "_a_")
      << "C1";
  EXPECT_EQ(plain_name("\xc0\xaf"), "__") << "longer than need be";
  EXPECT_EQ(plain_name("\xe0\x9f\xbf"), "___");
  EXPECT_EQ(plain_name("\xed\xa0\x80"), "___") << "half of a pair";
  EXPECT_EQ(plain_name("\xf4\x90\x80\x80"), "____") << "beyond the last one";
  EXPECT_EQ(plain_name("\xe2\x82"), "__") << "cut short";
}

}  // namespace
}  // namespace delfront
