// SPDX-License-Identifier: Apache-2.0
#include "base/report_name.hpp"

#include <gtest/gtest.h>

namespace delfront {
namespace {

TEST(ReportName, a_page_has_its_json_beside_it) {
  for (const char* page : {"run.html", "run.htm", "a.b/RUN.HTML", "run.v2.html"})
    EXPECT_TRUE(is_page_name(page)) << page;
  for (const char* other : {"", "run.json", "html", "run.html.json", "a.html/run"}) {
    EXPECT_FALSE(is_page_name(other)) << other;
    EXPECT_EQ(json_name(other), other);
  }
  EXPECT_EQ(json_name("out/run.v2.html"), "out/run.v2.json");
}

}  // namespace
}  // namespace delfront
