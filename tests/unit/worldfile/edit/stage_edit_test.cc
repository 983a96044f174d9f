// Edits of Stage files change the bytes that they concern, and no others.
#include "worldfile/edit/stage_edit.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/support/stage_worlds.h"
#include "tests/support/values.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

const char* const kYard = R"(# A yard.
include "things.inc"   # all of them

define crate model      # a kind of model
(
  size [0.5 0.5 0.4]    # metres
  color "brown"
)

crate( name "left" pose [ 1.0 2.000 0 30 ] )  # the first one
crate( pose [3 2 0 0] color "blue" )

model
(
  # inside
  name "gate"	pose [0 0 0 0]
  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] )
)
)";

StageTree Read(const std::string& text) {
  Result<StageTree> syntax = ParseStage(text, "yard.world");
  EXPECT_TRUE(syntax.ok()) << (syntax.ok() ? "" : syntax.error().ToString());
  return syntax.ok() ? std::move(syntax).value() : StageTree{};
}

const Statement& Entry(const StageTree& syntax, std::size_t index) {
  for (const Statement& statement : syntax.statements) {
    if (statement.kind == StatementKind::kEntry && index-- == 0) return statement;
  }
  ADD_FAILURE() << "no such entry";
  return syntax.statements.front();
}

Value ValueOf(const std::string& text) {
  Result<Value> value = ReadValueText(text);
  EXPECT_TRUE(value.ok()) << text;
  return value.ok() ? value.value() : Text("");
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(StageEditTest, OneTokenOfATupleChangesAlone) {
  const StageTree syntax = Read(kYard);
  const std::string moved = WithProperty(kYard, BodyOf(Entry(syntax, 0)), "pose", ValueOf("[1 2.5 0.0 30]"));
  EXPECT_EQ(moved, Replaced(kYard, "[ 1.0 2.000 0 30 ]", "[ 1.0 2.5 0 30 ]"));
}

TEST(StageEditTest, AValueThatIsTheSameChangesNothing) {
  const StageTree syntax = Read(kYard);
  EXPECT_EQ(WithProperty(kYard, BodyOf(Entry(syntax, 0)), "pose", ValueOf("[1 2 0 30.0]")), kYard);
  EXPECT_EQ(WithProperty(kYard, BodyOf(Entry(syntax, 0)), "name", ValueOf("\"left\"")), kYard);
}

TEST(StageEditTest, ANewPropertyFollowsTheOthersOfItsLine) {
  const StageTree syntax = Read(kYard);
  EXPECT_EQ(WithProperty(kYard, BodyOf(Entry(syntax, 1)), "name", ValueOf("\"right\"")),
            Replaced(kYard, "color \"blue\" )", "color \"blue\" name \"right\" )"));
}

TEST(StageEditTest, ANewPropertyOfSeveralLinesHasALineOfItsOwnBehindTheComment) {
  const StageTree syntax = Read(kYard);
  EXPECT_EQ(WithProperty(kYard, BodyOf(*FindDefine(syntax, "crate")), "gripper_return", ValueOf("1")),
            Replaced(kYard, "  color \"brown\"\n", "  color \"brown\"\n  gripper_return 1\n"));
  const std::string commented = "model\n(\n  size [1 1 1] # big\n)\n";
  EXPECT_EQ(WithProperty(commented, BodyOf(Entry(Read(commented), 0)), "color", ValueOf("\"red\"")),
            "model\n(\n  size [1 1 1] # big\n  color \"red\"\n)\n");
}

TEST(StageEditTest, AnEmptyBodyReceivesItsFirstProperty) {
  for (const auto& [before, after] : std::vector<std::pair<std::string, std::string>>{
           {"model()", "model( color \"red\" )"},
           {"model( )", "model( color \"red\" )"},
           {"model\n(\n)\n", "model\n(\n  color \"red\"\n)\n"},
           {"model\r\n(\r\n)\r\n", "model\r\n(\r\n  color \"red\"\r\n)\r\n"},
           {"model( # nothing\n)\n", "model( # nothing\n  color \"red\"\n)\n"}}) {
    EXPECT_EQ(WithProperty(before, BodyOf(Entry(Read(before), 0)), "color", ValueOf("\"red\"")), after);
  }
}

TEST(StageEditTest, TheLastOfTwoPropertiesCounts) {
  const std::string twice = "model( size [1 1 1] size [2 2 2] )\n";
  EXPECT_EQ(WithProperty(twice, BodyOf(Entry(Read(twice), 0)), "size", ValueOf("[2 2 3]")),
            "model( size [1 1 1] size [2 2 3] )\n");
}

TEST(StageEditTest, RemovalLeavesTheCommentsOfTheLine) {
  const StageTree syntax = Read(kYard);
  EXPECT_EQ(WithoutProperty(kYard, BodyOf(*FindDefine(syntax, "crate")), "color"),
            Replaced(kYard, "  color \"brown\"\n", ""));
  EXPECT_EQ(WithoutStatement(kYard, Entry(syntax, 0)),
            Replaced(kYard, "crate( name \"left\" pose [ 1.0 2.000 0 30 ] )  # the", "# the"));
  EXPECT_EQ(WithoutStatement(kYard, Entry(syntax, 1)), Replaced(kYard, "crate( pose [3 2 0 0] color \"blue\" )\n", ""));
}

TEST(StageEditTest, AddedEntriesAndDefinesLoad) {
  WrittenModel crate{"crate", {}, {}};
  crate.Set("name", Text("new"));
  crate.Set("pose", Tuple({1.25, -2.0, 0.0, 90.0}));
  const std::string text = Replaced(kYard, "include \"things.inc\"   # all of them\n", "");
  const std::string added = WithEntry(text, Read(text).body(), crate);
  EXPECT_EQ(added, text + "crate( name \"new\" pose [1.25 -2 0 90] )\n");

  WrittenModel shelf{"crate", {}, {WrittenBlock({{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}}, 0.4, 0.6)}};
  shelf.Set("size", Tuple({1, 0.5, 0.2}));
  const std::string defined = WithDefine(added, Read(added), "shelf", shelf);
  EXPECT_TRUE(test::ValueOf(ParseStageText(defined, "yard.world")).defines.contains("shelf"));
  // Before the first entry, behind the defines that it is made from.
  EXPECT_LT(defined.find("define shelf crate"), defined.find("crate( name \"left\""));
  EXPECT_GT(defined.find("define shelf crate"), defined.find("define crate"));
}

TEST(StageEditTest, BlocksChangeOneByOne) {
  const std::string text = R"(define step model
(
  # the lower one
  block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 0.5] )  # kept
  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [0.5 1] )
)
)";
  const std::vector<Vec2> triangle{{0, 0}, {1, 0}, {1, 1}};
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const auto edited = [&](const std::vector<WrittenModel>& blocks) {
    StageBodyEdit edit(text, "step.inc", 1, 8);
    EXPECT_TRUE(edit.SetBlocks(blocks).ok());
    return edit.text();
  };
  EXPECT_EQ(edited({WrittenBlock(square, 0, 0.5), WrittenBlock(triangle, 0.5, 1)}), text);
  EXPECT_EQ(edited({WrittenBlock(square, 0, 0.75), WrittenBlock(triangle, 0.5, 1)}),
            Replaced(text, "z [0 0.5] )  # kept", "z [0 0.75] )  # kept"));
  // A corner less.
  EXPECT_EQ(edited({WrittenBlock(triangle, 0, 0.5), WrittenBlock(triangle, 0.5, 1)}),
            Replaced(Replaced(text, "points 4", "points 3"), " point[3] [0 1]", ""));
  // A block less, and one more.
  EXPECT_EQ(edited({WrittenBlock(square, 0, 0.5)}),
            Replaced(text, "  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [0.5 1] )\n", ""));
  const std::string more =
      edited({WrittenBlock(square, 0, 0.5), WrittenBlock(triangle, 0.5, 1), WrittenBlock(triangle, 1, 2)});
  EXPECT_EQ(more, Replaced(text, "z [0.5 1] )\n",
                           "z [0.5 1] )\n  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [1 2] )\n"));
}

TEST(StageEditTest, BrokenTextHasItsPlace) {
  const Result<StageTree> syntax = ParseStage("model(\n  pose [0 0\n)", "bad.world");
  ASSERT_FALSE(syntax.ok());
  EXPECT_EQ(syntax.error().where.line, 2);
}

TEST(StageEditTest, ValuesAreOneValue) {
  for (const char* bad : {"", "red", "1 2", "[1 2] 3", "1 # c", "1\nname \"x\"", "( )", "\"a\" ) model(", "1e5"}) {
    EXPECT_FALSE(ReadValueText(bad).ok()) << bad;
  }
  EXPECT_EQ(ToJson(ValueOf("[.5 +1 -.25 \"a\"]")), "[0.5, 1, -0.25, \"a\"]");
}

// Files that people have written: each is read to its end, and one pose that changes is one token that changes.
TEST(StageEditTest, StageWorldsChangeByOneToken) {
  namespace fs = std::filesystem;
  const std::string folder = test::StageWorldsFolder();
  if (!fs::is_directory(folder)) GTEST_SKIP() << "no Stage worlds at " << folder;
  int changed_files = 0;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (file.path().extension() != ".world" && file.path().extension() != ".inc") continue;
    const std::string text = test::TextOf(file.path());
    const Result<StageTree> syntax = ParseStage(text, file.path().string());
    if (!syntax.ok()) continue;  // of a version of the language that is not read
    for (const Statement& statement : syntax.value().statements) {
      if (statement.kind != StatementKind::kEntry) continue;
      const Statement* const pose = FindProperty(BodyOf(statement), "pose");
      if (pose == nullptr || pose->elements.size() != 4) continue;
      std::string tuple = "[";
      for (std::size_t i = 0; i < 4; ++i)
        tuple += " " + (i == 1 ? "123.5" : std::string(pose->elements[i].span.Of(text)));
      const std::string after = WithProperty(text, BodyOf(statement), "pose", ValueOf(tuple + " ]"));
      const TextSpan& token = pose->elements[1].span;
      EXPECT_EQ(after, text.substr(0, token.begin) + "123.5" + text.substr(token.end)) << file.path();
      EXPECT_TRUE(ParseStage(after, "after").ok());
      ++changed_files;
      break;
    }
  }
  EXPECT_GE(changed_files, 3);
}

// Edits of JSON text change the bytes that they concern, and no others.

const char* const kScenario = R"({
  "name": "demo",   
  "robots": [
    {"name": "anna", "pose": [-8, 0.0, 0],  "controller": "wander"},
    {
      "name": "b\u00e9la",
      "pose": [0, -0.4, 180]
    }
  ],
  "empty": [], "none": {}
}
)";

JsonNode ReadJson(const std::string& text) {
  const Result<JsonTree> tree = JsonTree::Parse(text, "demo.json");
  EXPECT_TRUE(tree.ok()) << (tree.ok() ? "" : tree.error().ToString());
  return tree.ok() ? tree.value().root() : JsonNode{};
}

std::string WithText(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(JsonEditTest, OneElementOfAnArrayChangesAlone) {
  const JsonNode root = ReadJson(kScenario);
  EXPECT_EQ(WithMember(kScenario, root.Find("robots")->items[0], "pose", "[-8, 0, 90]"),
            WithText(kScenario, "[-8, 0.0, 0]", "[-8, 0.0, 90]"));
  EXPECT_EQ(WithMember(kScenario, root.Find("robots")->items[0], "pose", "[-8, 0, 0]"), kScenario);
}

TEST(JsonEditTest, AValueIsSetAtItsPath) {
  const auto with = [](const std::string& text, const JsonPath& path, const std::optional<std::string>& value) {
    const Result<std::string> changed = WithValueAt(text, ReadJson(text), path, value);
    return changed.ok() ? changed.value() : changed.error().message;
  };
  const std::size_t first = 0;
  const std::size_t second = 1;
  EXPECT_EQ(with(R"({"a": [{"b": 1}]})", {"a", first, "b"}, "2"), R"({"a": [{"b": 2}]})");
  EXPECT_EQ(with(R"({"a": [{"b": 1}]})", {"a", second}, "3"), R"({"a": [{"b": 1}, 3]})");
  EXPECT_EQ(with(R"({"a": [1, 2]})", {"a", first}, std::nullopt), R"({"a": [2]})");
  EXPECT_EQ(with(R"({"a": {"b": 1}})", {"a", "c", "d"}, "5"), R"({"a": {"b": 1, "c": {"d": 5}}})");
  // What is missing is made, an entry of a list of the file on a line of its own.
  EXPECT_EQ(with("{\n  \"a\": 1\n}", {"p", first, "n"}, "5"), "{\n  \"a\": 1,\n  \"p\": [\n    {\"n\": 5}\n  ]\n}");
  EXPECT_EQ(with(R"({"a": 1})", {"b", "c"}, std::nullopt), R"({"a": 1})");
  // Steps that lead nowhere.
  EXPECT_EQ(with(R"({"a": 1})", {"a", "b"}, "5"), "found the number 1, expected an object with b");
  EXPECT_EQ(with(R"({"a": [1]})", {"a", std::size_t{7}}, "5"),
            "found an array of 1, expected a list with an element 7");
}

TEST(JsonEditTest, MembersAndElementsAreAddedInTheFormOfTheOthers) {
  const JsonNode root = ReadJson(kScenario);
  const JsonNode& robots = *root.Find("robots");
  EXPECT_EQ(WithMember(kScenario, robots.items[0], "x", "1"),
            WithText(kScenario, "\"controller\": \"wander\"}", "\"controller\": \"wander\", \"x\": 1}"));
  EXPECT_EQ(WithMember(kScenario, robots.items[1], "x", "1"), WithText(kScenario, "180]\n", "180],\n      \"x\": 1\n"));
  EXPECT_EQ(WithElement(kScenario, robots, "{}"), WithText(kScenario, "    }\n  ]", "    },\n    {}\n  ]"));
  EXPECT_EQ(WithElement(kScenario, *root.Find("empty"), "5"), WithText(kScenario, "[],", "[\n    5\n  ],"));
  EXPECT_EQ(WithMember(kScenario, *root.Find("none"), "a", "5"), WithText(kScenario, "{}", "{\"a\": 5}"));
  EXPECT_EQ(WithMember("{}", ReadJson("{}"), "a", "5"), "{\n  \"a\": 5\n}");
}

TEST(JsonEditTest, RemovalKeepsTheTextValid) {
  const JsonNode root = ReadJson(kScenario);
  for (const auto& [holder, index] :
       std::vector<std::pair<const JsonNode*, std::size_t>>{{&root, 0},
                                                            {&root, 1},
                                                            {&root, 3},
                                                            {root.Find("robots"), 0},
                                                            {root.Find("robots"), 1},
                                                            {&root.Find("robots")->items[0], 0}}) {
    const std::string after = WithoutItem(kScenario, *holder, index);
    EXPECT_TRUE(nlohmann::json::accept(after)) << after;
    EXPECT_EQ(ReadJson(after).items.size() + (holder == &root ? 1 : 0), root.items.size());
  }
  EXPECT_EQ(WithoutItem("[ 5 ]", ReadJson("[ 5 ]"), 0), "[]");
}

TEST(JsonEditTest, MembersAreRemovedByName) {
  const JsonNode root = ReadJson(kScenario);
  EXPECT_EQ(WithoutMember(kScenario, root, "none"), WithText(kScenario, "[], \"none\": {}", "[]"));
  EXPECT_EQ(WithoutMember(kScenario, root, "nothing"), kScenario);
}

}  // namespace
}  // namespace troupe
