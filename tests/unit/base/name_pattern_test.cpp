// SPDX-License-Identifier: Apache-2.0
#include "base/name_pattern.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace delfront {
namespace {

TEST(MatchesPattern, knows_star_and_question_mark) {
  for (const auto& [name, pattern] : std::vector<std::pair<std::string, std::string>>{{"wing", "wing"},
                                                                                      {"wing", "*"},
                                                                                      {"wing", "w*g"},
                                                                                      {"wing", "w??g"},
                                                                                      {"wing", "*ng*"},
                                                                                      {"aXbXc", "a*X*c"},
                                                                                      {"abab", "*ab"},
                                                                                      {"", "*"},
                                                                                      {"", ""}})
    EXPECT_TRUE(matches_pattern(name, pattern)) << name << " " << pattern;
  for (const auto& [name, pattern] :
       std::vector<std::pair<std::string, std::string>>{{"wing", "Wing"},
                                                        {"wing", "win"},
                                                        {"wing", "wing?"},
                                                        {"wing", "w*x"},
                                                        {"wing", ""},
                                                        {"", "?"},
                                                        {"wing", "?wing"},
                                                        {"abc", "a*d"},
                                                        {std::string(3000, 'a'), "*a*a*a*a*a*a*a*a*b"}})
    EXPECT_FALSE(matches_pattern(name, pattern)) << name << " " << pattern;
}

}  // namespace
}  // namespace delfront
