#include "common/base/json_reader.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "tests/support/values.h"

namespace troupe {
namespace {

enum class Side : std::uint8_t { kLeft, kRight };
constexpr auto NamesOf(Side) {
  return std::array{"left", "right"};
}

struct Spot {
  double x = 0.0;
  double y = 0.0;
  bool operator==(const Spot&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"x", &Spot::x}, Field{"y", &Spot::y}}; }
};

struct Entry {
  std::string name = "none";
  std::uint8_t count = 3;
  Side side = Side::kLeft;
  std::optional<bool> on = {};
  std::vector<Spot> spots = {};
  bool operator==(const Entry&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Field{"name", &Entry::name}, Field{"count", &Entry::count}, Field{"side", &Entry::side},
                      Field{"on", &Entry::on}, Field{"spots", &Entry::spots}};
  }
};

std::string ErrorOf(const Status& status) {
  return status.ok() ? "" : status.error().ToString();
}

TEST(JsonReaderTest, ReadsARowByItsFields) {
  const Result<Entry> all = RowFromJson<Entry>(
      R"({"name": "a", "count": 255, "side": "right", "on": true, "spots": [[1, 2], {"y": 3}], "other": 7})");
  EXPECT_EQ(test::ValueOf(all), (Entry{"a", 255, Side::kRight, true, {{1.0, 2.0}, {0.0, 3.0}}}));
  EXPECT_EQ(test::ValueOf(RowFromJson<Entry>(R"({"on": null})")), Entry()) << "missing members keep their values";
  for (const char* whole : {"200", "200.0", "2e2"}) {
    EXPECT_EQ(test::ValueOf(RowFromJson<Entry>(std::string(R"({"count": )") + whole + "}")).count, 200) << whole;
  }
}

TEST(JsonReaderTest, NamesTheValueItsPathAndTheExpectation) {
  const std::pair<const char*, const char*> cases[] = {
      {R"([])", "error: found an empty array, expected an object"},
      {R"({"name": 5})", "error: found the number 5 as 'name', expected a text"},
      {R"({"count": 256})", "error: found the number 256 as 'count', expected a whole number"},
      {R"({"count": 1.5})", "error: found the number 1.5 as 'count', expected a whole number"},
      {R"({"side": "up"})", "error: found the string 'up' as 'side', expected one of left, right"},
      {R"({"on": 1})", "error: found the number 1 as 'on', expected true or false"},
      {R"({"spots": {}})", "error: found an empty object as 'spots', expected a list"},
      {R"({"spots": [[1]]})", "error: found an array of 1 as 'spots[0]', expected a list of 2 numbers"},
      {R"({"spots": [[1, 2], {"x": "1"}]})", "error: found the string '1' as 'spots[1].x', expected a number"},
  };
  for (const auto& [text, error] : cases) EXPECT_EQ(RowFromJson<Entry>(text).error().ToString(), error) << text;
}

TEST(JsonReaderTest, HasThePlaceInAFile) {
  const JsonReader file(test::ValueOf(JsonTree::Parse("{\n  \"a\": {\"b\": [1, true]}\n}", "f.json")));
  std::vector<double> numbers;
  EXPECT_FALSE(file.Find("a")->Read("b", numbers));
  file.Fail("another, which comes too late");
  EXPECT_EQ(ErrorOf(file.status()), "f.json:2:18: error: found true as 'a.b[1]', expected a number");
}

TEST(JsonReaderTest, MembersThatAreMissingOrNotKnownAreErrors) {
  const JsonReader missing = JsonReader::OfText(R"({"a": {}})", "wander");
  EXPECT_EQ(missing.Find("a")->Get<double>("speed"), 0.0);
  EXPECT_EQ(ErrorOf(missing.status()), "error: wander: found no 'speed' in 'a', expected a number");
  const JsonReader unknown = JsonReader::OfText(R"({"sped": 1})");
  EXPECT_EQ(unknown.Optional<double>("speed"), std::nullopt);
  EXPECT_TRUE(unknown.ok());
  EXPECT_EQ(ErrorOf(unknown.Finish()), "error: found the key 'sped', expected one of speed; did you mean 'speed'?");
}

TEST(JsonReaderTest, GoesOnSafelyAfterAnError) {
  const JsonReader broken = JsonReader::OfText("{\"a\": ");
  EXPECT_FALSE(broken.ok());
  EXPECT_TRUE(broken.ItemsOf("a").empty());
  EXPECT_TRUE(broken.Members().empty());
  EXPECT_EQ(broken.Number("a", 0.0, 1.0), std::nullopt);
  EXPECT_EQ(broken.Get<Entry>("a"), Entry());
  EXPECT_EQ(ErrorOf(broken.Finish()),
            "error: 1:7: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', "
            "'{', or a literal");
}

TEST(JsonReaderTest, NumbersMayHaveNames) {
  const JsonReader reader = JsonReader::OfText(R"({"lift": "up", "speed": 2, "hash": "00ff"})");
  EXPECT_EQ(reader.Number("lift", 0.0, 100.0, {{"up", 100.0}, {"down", 0.0}}), 100.0);
  std::uint64_t hash = 0;
  EXPECT_TRUE(reader.ReadHash("hash", hash));
  EXPECT_EQ(hash, 255U);
  EXPECT_EQ(reader.Number("speed", 0.0, 1.0, {{"max", 1.0}}), std::nullopt);
  EXPECT_EQ(ErrorOf(reader.status()),
            "error: found the number 2 as 'speed', expected a number between 0 and 1 or \"max\"");
}

}  // namespace
}  // namespace troupe
