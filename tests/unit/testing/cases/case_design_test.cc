// Designs of cases and their constraints.
#include "testing/cases/case_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "common/base/json_tree.h"

namespace troupe {
namespace {

using testing::HasSubstr;

std::vector<Variation> VariationsOf(const std::string& json) {
  const JsonTree tree = JsonTree::Parse(json, "t").value();
  std::vector<Variation> variations;
  for (const JsonNode& entry : tree.root().items) {
    variations.push_back(Variation::Read(tree, entry, ValuePath::Parse(entry.key).value()).value());
  }
  return variations;
}

Result<CaseDesign> Make(const std::string& json, const std::vector<std::string>& where,
                        const DesignSettings& settings) {
  std::vector<Variation> variations = VariationsOf(json);
  std::vector<std::string> names;
  for (const Variation& variation : variations) names.push_back(variation.path());
  std::vector<Constraint> constraints;
  for (const std::string& text : where) constraints.push_back(Constraint::Parse(text, names).value());
  return CaseDesign::Make(std::move(variations), std::move(constraints), settings);
}

std::set<std::string> CasesOf(const CaseDesign& design) {
  std::set<std::string> cases;
  for (std::uint64_t i = 0; i < design.size(); ++i) cases.insert(CaseText(design.At(i)));
  return cases;
}

TEST(CaseDesign, TheProductHasEachCombinationOnce) {
  const CaseDesign design = Make(R"({"a": [1, 2], "b": {"range": [1, 3]}, "c": ["x"]})", {}, {}).value();
  EXPECT_EQ(design.size(), 6U);
  EXPECT_EQ(CasesOf(design).size(), 6U);
  EXPECT_EQ(CaseText(design.At(0)), "a=1,b=1,c=\"x\"");
  EXPECT_EQ(CaseText(design.At(5)), "a=2,b=3,c=\"x\"");
}

TEST(CaseDesign, TheProductHasTheCasesThatMeetTheConstraints) {
  const CaseDesign design =
      Make(R"({"a": {"range": [1, 9]}, "b": {"range": [1, 9]}})", {"a * 2 <= b", "not (a == 2)"}, {}).value();
  for (const std::string& text : CasesOf(design)) {
    const TestCase draws = ParseCase(text).value();
    EXPECT_LE(2 * NumberIn(draws[0].value), NumberIn(draws[1].value));
    EXPECT_NE(draws[0].value, "2");
  }
  EXPECT_EQ(design.size(), 8U + 4U + 2U);  // a of 1, 3 and 4
}

TEST(CaseDesign, PairwiseHasEachPairInFewCases) {
  DesignSettings settings;
  settings.kind = DesignKind::kPairwise;
  const std::string json =
      R"({"a": {"range": [1, 5]}, "b": {"range": [1, 5]}, "c": {"range": [1, 5]}, "d": {"range": [1, 5]}})";
  const CaseDesign design = Make(json, {"a != b or a > 2"}, settings).value();
  EXPECT_LT(design.size(), 60U);  // of 625
  std::set<std::string> pairs;
  for (std::uint64_t i = 0; i < design.size(); ++i) {
    const TestCase draws = design.At(i);
    EXPECT_TRUE(design.MeetsConstraints(draws));
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a + 1; b < 4; ++b) pairs.insert(CaseText({draws[a], draws[b]}));
    }
  }
  EXPECT_EQ(pairs.size(), 6U * 25U - 2U);  // a and b are not both 1, nor both 2
  EXPECT_EQ(design.impossible_pairs(), 2U);
}

TEST(CaseDesign, RandomCasesMeetTheConstraintsAndAreRepeatable) {
  DesignSettings settings{DesignKind::kRandom, 200, 7};
  const std::string json = R"({"a": {"uniform": [0, 1]}, "b": {"normal": [0, 1]}})";
  const CaseDesign design = Make(json, {"a > b"}, settings).value();
  EXPECT_EQ(design.size(), 200U);
  EXPECT_GT(CasesOf(design).size(), 190U);
  for (std::uint64_t i = 0; i < design.size(); ++i) {
    EXPECT_TRUE(design.MeetsConstraints(design.At(i)));
    EXPECT_EQ(design.At(i), design.At(i));
  }
  settings.seed = 8;
  EXPECT_NE(design.At(3), Make(json, {"a > b"}, settings).value().At(3));
}

TEST(CaseDesign, RefusesWhatHasNoCasesOrTooMany) {
  EXPECT_THAT(Make(R"({"a": [1, 2]})", {"a > 2"}, {}).error().message, HasSubstr("that no case meets"));
  EXPECT_THAT(Make(R"({"a": {"range": [1, 100000]}, "b": {"range": [1, 100000]}})", {}, {}).error().message,
              HasSubstr("more than 10000000 combinations"));
  EXPECT_THAT(Make(R"({"a": {"uniform": [0, 1]}})", {"a > 2"}, {DesignKind::kRandom, 5, 0}).error().message,
              HasSubstr("none of 1000 random cases"));
}

TEST(Constraint, ReadsTextsTruthsAndNumbers) {
  const std::vector<std::string> names = {"controller", "robots[a b].ros", "spawn[0].count"};
  const TestCase draws = {{"controller", "\"wander\""}, {"robots[a b].ros", "true"}, {"spawn[0].count", "20"}};
  for (const auto& [text, holds] :
       std::vector<std::pair<std::string, bool>>{{"controller == 'wander'", true},
                                                 {"controller != \"wander\"", false},
                                                 {"robots[a b].ros and spawn[0].count >= 20", true},
                                                 {"not robots[a b].ros or spawn[0].count - 1 == 19", true},
                                                 {"-spawn[0].count / 4 < -5", false},
                                                 {"2 + 3 * 4 == 14", true},
                                                 {"controller < 3 or controller == 3", false},
                                                 {"controller == 'stand' -> spawn[0].count < 20", true},
                                                 {"(2 + 3) * 4 == 20", true}}) {
    const Result<Constraint> constraint = Constraint::Parse(text, names);
    ASSERT_TRUE(constraint.ok()) << text << ": " << constraint.error().message;
    EXPECT_EQ(constraint.value().Holds(draws), holds) << text;
  }
}

}  // namespace
}  // namespace troupe
