#include "abbe/formats/text/json_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "abbe/formats/text/not_finite.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

TEST(JsonText, IsStableAndReadable) {
  Json value;
  value["zebra"] = 0.1;
  value["apple"] = {1, 2.5, nullptr, true};
  value["empty"] = Json::object();
  value["none"] = Json::array();
  value["tables"] = {{{"name", "a \"b\"\n"}}, {{"name", "c"}}};
  EXPECT_EQ(json_text(value),
            "{\n  \"zebra\": 0.1,\n  \"apple\": [1, 2.5, null, true],\n  \"empty\": {},\n  \"none\": [],\n"
            "  \"tables\": [\n    {\n      \"name\": \"a \\\"b\\\"\\n\"\n    },\n    {\n      \"name\": \"c\"\n    }\n "
            " ]\n}\n");
}

TEST(JsonText, WhatATerminalWouldObeyIsEscapedAndReadsBack) {
  const std::string hostile = "a\x1b[31m\x7f\u0085\u202e\u2028\n\u00b5";
  Json value;
  value[hostile] = {hostile};
  const std::string text = json_text(value);
  EXPECT_NE(text.find("a\\u001b[31m\\u007f\\u0085\\u202e\\u2028\\n\u00b5"), std::string::npos) << text;
  EXPECT_EQ(Json::parse(text), value);
  Json broken;
  broken["\xff"] = "\xe2\x80";
  EXPECT_EQ(json_text(broken), "{\n  \"\ufffd\": \"\ufffd\"\n}\n");
}

TEST(JsonText, NumbersReadBackToTheSameBits) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> normal;
  std::vector<double> numbers;
  for (int i = 0; i < 1000; ++i)
    numbers.push_back(std::ldexp(normal(generator), static_cast<int>(generator() % 200) - 100));
  EXPECT_EQ(Json::parse(json_text(numbers)).get<std::vector<double>>(), numbers);
}

TEST(JsonText, NeverWritesNanAsANumber) {
  EXPECT_THROW(json_text({{"a", std::numeric_limits<double>::quiet_NaN()}}), NotFinite);
  EXPECT_THROW(json_text({{"a", {1.0, std::numeric_limits<double>::infinity()}}}), NotFinite);
}

}  // namespace
}  // namespace abbe
