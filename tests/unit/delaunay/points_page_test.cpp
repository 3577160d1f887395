// SPDX-License-Identifier: Apache-2.0
// The page on point sets shows the example that the tests compile and run, word for word.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace delfront {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(DELFRONT_SOURCE_DIR) + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(PointsPage, shows_the_example_as_it_is) {
  std::string example = text_of("/examples/points.cpp");
  ASSERT_NE(example.find("#include"), std::string::npos);
  example.erase(0, example.find("#include"));
  EXPECT_NE(text_of("/docs/points.md").find("```cpp\n" + example + "```"), std::string::npos);
}

}  // namespace
}  // namespace delfront
