// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include <gtest/gtest.h>

#include "report/charts.hpp"
#include "report/html.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

TEST(Html, nothing_from_outside_is_markup) {
  EXPECT_EQ(html("<b a=\"1\" c='2'>&amp;"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;amp;");
  EXPECT_EQ(html(std::string("a\0b\x1b\x7f", 5)),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd\xef\xbf\xbd");
  EXPECT_EQ(html("Größe\n"), "Größe\n");
}

TEST(Html, numbers_are_as_in_the_terminal) {
  EXPECT_EQ(number_text(7.3170501), "7.317");
  EXPECT_EQ(number_text(1234567), "1,234,567");
  EXPECT_EQ(number_text(nullptr), "–");
  EXPECT_EQ(point_text({0.1234567, nullptr, -2}), "(0.123457, –, -2)");
  EXPECT_EQ(ids_text({1, 2, 3, 4, 5, 6, 7, 8, 9}), "1 2 3 4 5 6 7 8 …");
}

TEST(Histogram, one_in_a_million_is_seen_and_none_is_not) {
  const std::string svg =
      histogram_svg({{"low", 0}, {"high", 30}, {"counts", {1, 0, 1000000}}}, "deg", {.at_least = 10});
  EXPECT_EQ(fixtures::count_of(svg, "<rect"), 3u);
  EXPECT_EQ(fixtures::count_of(svg, "class=\"bar bad\""), 1u);  // 0 to 10
  EXPECT_EQ(fixtures::count_of(svg, "height=\"0.00\""), 1u);
  EXPECT_NE(svg.find("<title>20 to 30 and more: 1,000,000</title>"), std::string::npos);
  EXPECT_NE(svg.find(">1M<"), std::string::npos);
  EXPECT_EQ(histogram_svg({{"low", 0}, {"high", nullptr}, {"counts", {1}}}, "", {}), "");
  EXPECT_EQ(histogram_svg({{"low", 0}, {"high", 1}, {"counts", Json::array()}}, "", {}), "");
}

TEST(ReportPage, a_report_of_which_little_is_known_makes_a_page) {
  const std::string page = report_page(
      R"({"delfront": "1", "command": "a <b>", "outcome": "bad_input", "exit_code": 3, "error": "broken", "stage": ""})",
      "", Mesh());
  EXPECT_NE(page.find("a &lt;b&gt;"), std::string::npos);
  EXPECT_NE(page.find("No grid. broken."), std::string::npos);
  EXPECT_EQ(page.find("<b>a"), std::string::npos);
  EXPECT_TRUE(page.ends_with("</html>\n"));
}

TEST(ReportPage, a_grid_with_findings_is_not_called_valid) {
  const char* report =
      R"({"outcome": "done", "exit_code": 0, "error": null, "quality": {"num_cells": 5, "num_points": 8, "measures": {}},
          "grid_findings": [{"kind": "flat_cell", "severity": "error", "count": 7, "message": "cell 3 is flat", "remedy": "",
          "places": [{"at": [1, 2, 3], "ids": [3]}]}]})";
  const std::string page = report_page(report, "", Mesh());
  EXPECT_NE(page.find("The grid is not valid: 5 cells"), std::string::npos);
  EXPECT_NE(page.find("at (1, 2, 3), number 3"), std::string::npos);
  EXPECT_NE(page.find("and 6 more"), std::string::npos);
  EXPECT_EQ(page.find("Valid grid"), std::string::npos);
}

}  // namespace
}  // namespace delfront
