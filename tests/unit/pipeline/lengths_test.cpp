// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "delfront/errors.hpp"
#include "pipeline/quantities.hpp"

namespace delfront {
namespace {

TEST(ParseLength, reads_every_unit_with_and_without_a_blank) {
  EXPECT_EQ(parse_length("0.5").value, 0.5);
  EXPECT_EQ(parse_length("0.5").unit, "");
  for (const char* unit : {"m", "mm", "in", "ft", "%", "c"}) {
    for (const char* blank : {"", " ", "\t "}) {
      const Length length = parse_length(" 2.5e-1" + std::string(blank) + unit + " ");
      EXPECT_EQ(length.value, 0.25) << unit;
      EXPECT_EQ(length.unit, unit);
    }
  }
}

TEST(ParseLength, refuses_what_is_no_length) {
  for (const char* text : {"", " ", "m", "5 km", "5%%", "1,5", "nan", "inf", "-inf", "1e999", "0x10", "5 m m", "++1"})
    EXPECT_THROW(parse_length(text), UsageError) << "'" << text << "'";
}

TEST(ParseLength, text_of_a_length_reads_back_as_the_same_length) {
  for (const char* text : {"0.1", "5%", "20c", "2 mm", "0.30000000000000004 in", "1e-300"}) {
    const Length length = parse_length(text);
    const Length again = parse_length(to_text(length));
    EXPECT_EQ(again.value, length.value);
    EXPECT_EQ(again.unit, length.unit);
  }
}

TEST(ResolveLength, refers_to_the_box_or_to_the_unit) {
  const LengthScale scale{.diagonal = 10, .longest_side = 4, .metres_per_unit = 0.001};
  EXPECT_DOUBLE_EQ(resolve_length({7, ""}, scale), 7);
  EXPECT_DOUBLE_EQ(resolve_length({5, "%"}, scale), 0.5);
  EXPECT_DOUBLE_EQ(resolve_length({20, "c"}, scale), 80);
  EXPECT_DOUBLE_EQ(resolve_length({1, "m"}, scale), 1000);
  EXPECT_DOUBLE_EQ(resolve_length({3, "mm"}, scale), 3);
  EXPECT_DOUBLE_EQ(resolve_length({1, "in"}, scale), 25.4);
  EXPECT_DOUBLE_EQ(resolve_length({1, "ft"}, scale), 304.8);
}

TEST(ResolveLength, asks_for_the_unit_of_the_model_where_it_is_needed) {
  const LengthScale scale{.diagonal = 10, .longest_side = 4, .metres_per_unit = 0};
  try {
    resolve_length({2, "mm"}, scale);
    FAIL() << "resolved without a unit";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("--units"), std::string::npos) << e.what();
  }
}

TEST(ParseDuration, knows_seconds_to_days) {
  EXPECT_EQ(parse_duration("90"), 90);
  EXPECT_EQ(parse_duration("90 s"), 90);
  EXPECT_EQ(parse_duration("1.5min"), 90);
  EXPECT_EQ(parse_duration("2h"), 7200);
  EXPECT_EQ(parse_duration("1d"), 86400);
  for (const char* text : {"-1s", "2 hours", "", "h"}) EXPECT_THROW(parse_duration(text), UsageError) << text;
}

TEST(ParseMemory, knows_decimal_and_binary_prefixes) {
  EXPECT_EQ(parse_memory("1000000"), 1000000u);
  EXPECT_EQ(parse_memory("20GB"), 20000000000u);
  EXPECT_EQ(parse_memory("0.5 MB"), 500000u);
  EXPECT_EQ(parse_memory("1 KiB"), 1024u);
  EXPECT_EQ(parse_memory("2GiB"), 2147483648u);
  for (const char* text : {"-1GB", "20 gigabytes", "", "1e30TB"}) EXPECT_THROW(parse_memory(text), UsageError) << text;
}

}  // namespace
}  // namespace delfront
