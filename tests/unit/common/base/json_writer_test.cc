#include "common/base/json_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

TEST(JsonWriterTest, WritesObjectsAndListsWithTheirSeparators) {
  std::string text;
  JsonWriter json(text);
  json.BeginObject().Member("a", 1).Key("b").BeginList().Value(true).Null().BeginList().EndList().EndList();
  json.Key("c").BeginObject().EndObject().Member("d", "e").Key("f").Raw("[7]").EndObject();
  EXPECT_EQ(text, R"({"a":1,"b":[true,null,[]],"c":{},"d":"e","f":[7]})");
}

TEST(JsonWriterTest, NumbersReadBackAsTheyWere) {
  std::string text;
  JsonWriter json(text);
  json.BeginList().Value(0.1).Value(-2.5e300).Value(std::numeric_limits<std::uint64_t>::max());
  json.Value(std::numeric_limits<std::int64_t>::min()).Value(std::array{1.0, 0.25}).Value(std::nan("")).EndList();
  EXPECT_EQ(text, "[0.1,-2.5e+300,18446744073709551615,-9223372036854775808,[1,0.25],null]");
}

TEST(JsonWriterTest, TextsAreEscaped) {
  for (const std::string value : {"plain", "a\"b\\c", "line\nend",
                                  "K\xC3\xBC"
                                  "che",
                                  "\x7f"}) {
    std::string text;
    JsonWriter(text).Value(value);
    EXPECT_EQ(nlohmann::json::parse(text), value);
  }
  std::string text;
  JsonWriter(text).Value("K\xFC");
  EXPECT_EQ(text, "\"K\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace troupe
