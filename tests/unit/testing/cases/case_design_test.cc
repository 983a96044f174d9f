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
              HasSubstr("none of 100000 random cases meets"));
}

TEST(CaseDesign, EachCaseMeetsConditionsThatAreRarelyMet) {
  const std::string json = R"({"a": {"uniform": [0, 1]}, "b": {"uniform": [0, 1]}})";
  const CaseDesign design = Make(json, {"a + b <= 0.045"}, {DesignKind::kRandom, 20, 1}).value();  // one of 1000
  for (std::uint64_t i = 0; i < design.size(); ++i) EXPECT_TRUE(design.MeetsConstraints(design.At(i))) << i;
  EXPECT_THAT(Make(json, {"a + b <= 0.003"}, {DesignKind::kRandom, 100, 1}).error().message,
              testing::MatchesRegex("found constraints that (none|[0-9]) of 100000 random cases meets?, expected .*"));
}

TEST(CaseDesign, PairwiseDrawsTheNumbersOfEachCaseUntilTheyMeetTheConstraints) {
  const DesignSettings settings{DesignKind::kPairwise, 0, 0};
  const CaseDesign single =
      Make(R"({"t": [1, 2, 3, 4, 5, 6], "x": {"uniform": [0, 1]}})", {"x <= 0.2"}, settings).value();
  EXPECT_EQ(single.size(), 6U);
  const CaseDesign pairs = Make(R"({"a": [1, 2, 4, 8], "b": [1, 2, 4, 8], "x": {"uniform": [1, 10]}})",
                                {"a * x <= 10", "b + x >= 2"}, settings)
                               .value();
  EXPECT_EQ(pairs.size(), 16U);
  EXPECT_EQ(pairs.impossible_pairs(), 0U);
  for (const CaseDesign* const design : {&single, &pairs}) {
    for (std::uint64_t i = 0; i < design->size(); ++i) EXPECT_TRUE(design->MeetsConstraints(design->At(i))) << i;
  }
}

TEST(CaseDesign, PairwiseFindsTheOnlyCaseThatHasAPair) {
  const CaseDesign design = Make(R"({"a": [1, 2], "b": [1, 2], "c": {"range": [1, 300]}})",
                                 {"a == 1 and b == 1 -> c == 77", "a == 2 or c > 70"}, {DesignKind::kPairwise, 0, 0})
                                .value();
  std::set<std::string> pairs;
  for (std::uint64_t i = 0; i < design.size(); ++i) {
    EXPECT_TRUE(design.MeetsConstraints(design.At(i))) << i;
    pairs.insert(CaseText({design.At(i)[0], design.At(i)[1]}));
  }
  EXPECT_EQ(pairs.size(), 4U);
  EXPECT_EQ(design.impossible_pairs(), 70U) << "of a = 1 and the first values of c";
}

TEST(CaseDesign, RefusesConstraintsWithoutTryingAllPairs) {
  const DesignSettings settings{DesignKind::kPairwise, 0, 0};
  const std::string json = R"({"seed": {"range": [1, 1000]}, "n": {"range": [1, 1000]}})";
  EXPECT_THAT(Make(json, {"seed < 0"}, settings).error().message, HasSubstr("that no case meets"));
  // Bounds of the whole do not show it, those of each pair do.
  EXPECT_THAT(
      Make(R"({"a": {"range": [1, 50]}, "b": {"range": [1, 50]}})", {"a * 2 + b - 3 < 0"}, settings).error().message,
      HasSubstr("that no case meets"));
}

TEST(CaseDesign, TellsValuesThatCannotOccurFromThoseThatOccurRarely) {
  const std::string json = R"({"k": [0, 2], "x": {"uniform": [0, 1]}, "y": {"uniform": [0, 1]}})";
  for (const DesignKind kind : {DesignKind::kProduct, DesignKind::kPairwise}) {
    // x is at most y, and y at most x - 1 for k = 0.
    const CaseDesign design = Make(json, {"x <= y", "y <= x - 1.2 + k"}, {kind, 0, 0}).value();
    EXPECT_EQ(design.size(), 1U);
    EXPECT_TRUE(design.MeetsConstraints(design.At(0)));
    EXPECT_THAT(Make(json, {"k == 0 or x == 0.123"}, {kind, 0, 0}).error().message,
                HasSubstr("none of 50000 draws of random numbers beside k=2 meets"));
  }
}

TEST(Constraint, KnowsWhatCanHold) {
  const std::vector<std::string> names = {"a", "b", "word"};
  const std::vector<DrawBounds> draws = {{"0", {}}, {{}, Interval{1.0, 3.0}}, {}};
  for (const auto& [text, can_hold] : std::vector<std::pair<std::string, bool>>{{"b < 1", true},
                                                                                {"b < 0.99", false},
                                                                                {"b * b > 9.01", false},
                                                                                {"a > b - 1", true},
                                                                                {"-a >= b - 1", true},
                                                                                {"a > 0", false},
                                                                                {"not (a >= 0)", false},
                                                                                {"b == 2", true},
                                                                                {"b == 4", false},
                                                                                {"b != 4 -> a == 1", false},
                                                                                {"1 / (b - 2) > 100", true},
                                                                                {"word == 'x' and b > 2", true},
                                                                                {"word == 'x' and b > 4", false}}) {
    EXPECT_EQ(Constraint::Parse(text, names).value().CanHold(draws), can_hold) << text;
  }
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
