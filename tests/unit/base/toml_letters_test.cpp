// SPDX-License-Identifier: Apache-2.0
#include "base/toml_letters.hpp"

#include <gtest/gtest.h>

namespace delfront {
namespace {

TEST(TomlLetters, StandInTextsAndComments) {
  for (const char* good :
       {"", "a = 1\n", "a = \"é\" # ü\nb = 'é'\n", "a = \"\"\"é\n\"ü\" é\"\"\"\n", "a = '''é'é''' # é", "a = \"\\\"é\"",
        "\xEF\xBB\xBF"
        "a = 1",
        "a = \"é"})
    EXPECT_EQ(find_stray_letter(good), 0) << good;
}

TEST(TomlLetters, ElsewhereTheirLineIsFound) {
  EXPECT_EQ(find_stray_letter("é = 1"), 1);
  EXPECT_EQ(find_stray_letter("a = \"é\"\nb = 1 é\n"), 2);
  EXPECT_EQ(find_stray_letter("a = '\\'\nb = 'é'\n\nü"), 4);
  EXPECT_EQ(find_stray_letter("a = \"\"\"\n\\\"\"\"\n\"\"\"\xA0"), 3);
  EXPECT_EQ(find_stray_letter("a = 1\n[\"\"\"b = \\ﻳ\\\\]\n"), 2);  // found by fuzzing
  EXPECT_EQ(find_stray_letter("a = \"\"\"b\\\n  é\"\"\""), 2);
  EXPECT_EQ(find_stray_letter("# é\n\x80"), 2);
}

}  // namespace
}  // namespace delfront
