#include "common/base/json_tree.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/values.h"

namespace troupe {
namespace {

std::string ParseError(const std::string& text) {
  const Result<JsonTree> tree = JsonTree::Parse(text, "s.json");
  return tree.ok() ? "" : tree.error().ToString();
}

TEST(JsonTreeTest, HasTheLineAndColumnOfEveryValue) {
  const std::string text =
      "{\n"
      "  \"a\" : [1, -2.5e3 , true,{\"x\\\"y\": null}],\n"
      "  \"b\": {}, \"c\": [ ]\n"
      "}";
  const JsonTree tree = test::ValueOf(JsonTree::Parse(text, "s.json"));
  const JsonNode& root = tree.root();
  const auto place = [&](const JsonNode& value) {
    const SourceLocation where = tree.Where(value);
    return std::to_string(where.line) + ":" + std::to_string(where.column);
  };
  EXPECT_EQ(place(root), "1:1");
  const JsonNode& a = root.Member("a");
  EXPECT_EQ(place(a), "2:9");
  EXPECT_EQ(place(a.items[0]), "2:10");
  EXPECT_EQ(place(a.items[1]), "2:13");
  EXPECT_EQ(place(a.items[2]), "2:22");
  EXPECT_EQ(place(a.items[3]), "2:27");
  EXPECT_EQ(place(a.items[3].Member("x\"y")), "2:36");
  EXPECT_EQ(place(root.Member("b")), "3:8");
  EXPECT_EQ(place(root.Member("c")), "3:17");
  EXPECT_EQ(tree.WhereKey(root.Member("c")).column, 12);
  EXPECT_EQ(tree.WhereKey(a.items[1]).column, 13);
  EXPECT_EQ(tree.Where(root).file, "s.json");
}

TEST(JsonTreeTest, FindsTheNodesAtAPlace) {
  const std::string text = "{\n  \"robots\": [\n    {\"name\": \"b\\u00e9la\"}]}";
  const JsonTree parsed = test::ValueOf(JsonTree::Parse(text, "s.json"));
  const auto path = parsed.PathTo(parsed.OffsetOf({"s.json", 3, 7}));
  ASSERT_EQ(path.size(), 4U);
  EXPECT_EQ(path[1]->key, "robots");
  EXPECT_EQ(path[2]->Find("name"), path[3]);
  EXPECT_EQ(path[3]->text, "b\xc3\xa9la");
  EXPECT_EQ(path[3]->span.Of(text), "\"b\\u00e9la\"");
  EXPECT_TRUE(parsed.PathTo(text.size()).empty());
}

// The values are those that the library reads from the text.
TEST(JsonTreeTest, HasTheValuesOfTheText) {
  for (const char* text :
       {"[0, -0, 7, -7, 18446744073709551615, 18446744073709551616, -9223372036854775808, 1e3, -2.5E-2, 0.1]",
        "[1e-400, -0.0000001e-999999999999, 4.9e-324, 1.7976931348623157e308]",
        R"(["", "a\"b\\\/\b\f\n\r\t", "\u0041\u00e9\u20ac\uD83D\uDE00", "\u0000"])", "[\"\xc3\xa9\"]",
        R"({"b": [{}, [], {"c": null}], "a": true, "": false})", " \t\r\n3 "}) {
    EXPECT_EQ(ToJson(test::ValueOf(JsonTree::Parse(text, "s.json")).root()), nlohmann::json::parse(text)) << text;
  }
}

// Whatever is broken in a text, the library refuses it, too, and reads what is left.
TEST(JsonTreeTest, RefusesWhatTheLibraryRefuses) {
  const std::string good = R"([{"a": -1.5e+3, "b\u00e9": "x\n"}, [true, false, null], 10, ""])";
  const std::string odd = "{}[],:\"\\ -+.eE0n\x01\xc3u";
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::vector<std::string> texts = {good.substr(0, at), good.substr(0, at) + good.substr(at + 1)};
    for (const char c : odd) {
      texts.push_back(good.substr(0, at) + c + good.substr(at));
      texts.push_back(good.substr(0, at) + c + good.substr(at + 1));
    }
    for (const std::string& text : texts) {
      const Result<JsonTree> tree = JsonTree::Parse(text, "s.json");
      const nlohmann::json read = nlohmann::json::parse(text, nullptr, false);
      EXPECT_EQ(tree.ok(), !read.is_discarded()) << text << (tree.ok() ? "" : tree.error().ToString());
      if (!tree.ok()) continue;
      EXPECT_EQ(ToJson(tree.value().root()), read) << text;
    }
  }
}

TEST(JsonTreeTest, SkipsAByteOrderMark) {
  const JsonTree parsed = test::ValueOf(JsonTree::Parse("\xEF\xBB\xBF[7]", "s.json"));
  EXPECT_EQ(parsed.Where(parsed.root().items[0]).column, 5);
}

TEST(JsonTreeTest, NamesThePlaceOfBrokenSyntax) {
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

TEST(JsonTreeTest, RefusesADuplicateKey) {
  EXPECT_EQ(ParseError("{\"a\": [1, 2], \"b\": 0,\n \"\\u0061\": 3}"),
            "s.json:2:2: error: found the key 'a' again, expected it once");
  EXPECT_EQ(ParseError("[{\"a\": {\"b\": 1}, \"c\": {\"b\": 1, \"b\": 1}}]"),
            "s.json:1:32: error: found the key 'b' again, expected it once");
}

TEST(JsonTreeTest, RefusesTextsThatAreTooDeepOrTooLarge) {
  EXPECT_EQ(ParseError(std::string(100'000, '[')),
            "s.json:1:65: error: found deeper nesting, expected at most 64 objects and arrays inside each other");
  std::string many = "[1";
  for (std::size_t i = 0; i < JsonLimits().values; ++i) many += ",1";
  EXPECT_EQ(ParseError(many + "]"), "s.json:1:499999: error: found more values, expected at most 250000");
  EXPECT_EQ(ParseError(std::string(JsonLimits().bytes + 1, ' ')),
            "s.json: error: found 16777217 bytes, expected at most 16777216");
}

TEST(JsonTreeTest, AcceptsTheDeepestNesting) {
  const std::string text = std::string(64, '[') + std::string(64, ']');
  EXPECT_EQ(ParseError(text), "");
}

}  // namespace
}  // namespace troupe
