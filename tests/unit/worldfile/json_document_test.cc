#include "worldfile/scenario/json_document.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace troupe {
namespace {

std::string ParseError(const std::string& text) {
  const Result<JsonDocument> document = JsonDocument::Parse(text, "s.json");
  return document.ok() ? "" : document.error().ToString();
}

TEST(JsonDocument, HasTheLineAndColumnOfEveryValue) {
  const std::string text =
      "{\n"
      "  \"a\" : [1, -2.5e3 , true,{\"x\\\"y\": null}],\n"
      "  \"b\": {}, \"c\": [ ]\n"
      "}";
  const Result<JsonDocument> parsed = JsonDocument::Parse(text, "s.json");
  ASSERT_TRUE(parsed.ok()) << parsed.error().ToString();
  const JsonDocument& document = parsed.value();
  const nlohmann::json& root = document.root();
  const auto place = [&](const nlohmann::json& value) {
    const SourceLocation where = document.Where(value);
    return std::to_string(where.line) + ":" + std::to_string(where.column);
  };
  EXPECT_EQ(place(root), "1:1");
  EXPECT_EQ(place(root["a"]), "2:9");
  EXPECT_EQ(place(root["a"][0]), "2:10");
  EXPECT_EQ(place(root["a"][1]), "2:13");
  EXPECT_EQ(place(root["a"][2]), "2:22");
  EXPECT_EQ(place(root["a"][3]), "2:27");
  EXPECT_EQ(place(root["a"][3]["x\"y"]), "2:36");
  EXPECT_EQ(place(root["b"]), "3:8");
  EXPECT_EQ(place(root["c"]), "3:17");
  EXPECT_EQ(document.WhereKey(root["c"]).column, 12);
  EXPECT_EQ(document.WhereKey(root["a"][1]).column, 13);
  EXPECT_EQ(document.Where(root).file, "s.json");
}

TEST(JsonDocument, SkipsAByteOrderMark) {
  const Result<JsonDocument> parsed = JsonDocument::Parse("\xEF\xBB\xBF[7]", "s.json");
  ASSERT_TRUE(parsed.ok());
  EXPECT_EQ(parsed.value().Where(parsed.value().root()[0]).column, 5);
}

TEST(JsonDocument, NamesThePlaceOfBrokenSyntax) {
  EXPECT_EQ(ParseError(""),
            "s.json:1:1: error: not valid JSON: syntax error while parsing value - unexpected end of input; expected "
            "'[', '{', or a literal");
  EXPECT_EQ(ParseError("{\n  \"a\": 1,\n}"),
            "s.json:3:1: error: not valid JSON: syntax error while parsing object key - unexpected '}'; expected "
            "string literal");
  EXPECT_EQ(ParseError("{\"a\": 12 345}"),
            "s.json:1:10: error: not valid JSON: syntax error while parsing object - unexpected number literal; "
            "expected '}'");
  EXPECT_EQ(ParseError("{\"a\": nul}"),
            "s.json:1:7: error: not valid JSON: syntax error while parsing value - invalid literal");
  EXPECT_EQ(ParseError("[1e999]"), "s.json:1:2: error: found a number that is too large, expected at most 1.8e308");
  EXPECT_EQ(ParseError("[NaN]"),
            "s.json:1:2: error: not valid JSON: syntax error while parsing value - invalid literal");
  EXPECT_EQ(ParseError("[\"ab\xff\"]"),
            "s.json:1:5: error: not valid JSON: syntax error while parsing value - invalid string: ill-formed UTF-8 "
            "byte");
  EXPECT_EQ(ParseError("[1] x"),
            "s.json:1:5: error: not valid JSON: syntax error while parsing value - invalid literal; expected end of "
            "input");
}

TEST(JsonDocument, RefusesADuplicateKey) {
  EXPECT_EQ(ParseError("{\"a\": [1, 2], \"b\": 0,\n \"\\u0061\": 3}"),
            "s.json:2:2: error: found the key 'a' again, expected it once");
  EXPECT_EQ(ParseError("[{\"a\": {\"b\": 1}, \"c\": {\"b\": 1, \"b\": 1}}]"),
            "s.json:1:32: error: found the key 'b' again, expected it once");
}

TEST(JsonDocument, RefusesTextsThatAreTooDeepOrTooLarge) {
  EXPECT_EQ(ParseError(std::string(100'000, '[')),
            "s.json:1:65: error: found deeper nesting, expected at most 64 objects and arrays inside each other");
  std::string many = "[1";
  for (std::size_t i = 0; i < JsonDocument::kMaxValues; ++i) many += ",1";
  EXPECT_EQ(ParseError(many + "]"), "s.json:1:499999: error: found more values, expected at most 250000");
  EXPECT_EQ(ParseError(std::string(JsonDocument::kMaxBytes + 1, ' ')),
            "s.json: error: found 16777217 bytes, expected at most 16777216");
}

TEST(JsonDocument, AcceptsTheDeepestNesting) {
  const std::string text = std::string(64, '[') + std::string(64, ']');
  EXPECT_EQ(ParseError(text), "");
}

}  // namespace
}  // namespace troupe
