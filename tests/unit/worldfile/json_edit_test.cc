// Edits of JSON text change the bytes that they concern, and no others.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "worldfile/edit/stage_edit.h"

namespace troupe {
namespace {

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
