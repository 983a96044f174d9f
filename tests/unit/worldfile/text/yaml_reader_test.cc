#include "worldfile/text/yaml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace troupe {
namespace {

using testing::HasSubstr;

// The place and the message of the error of a text; empty: it has none.
std::string ErrorOf(const std::string& text) {
  Diagnostics diagnostics;
  YamlReader yaml("f.yaml", diagnostics);
  yaml.Read(text, "levels");
  return diagnostics.failed() ? diagnostics.error()->ToString() : "";
}

TEST(YamlReaderTest, HasThePlacesOfValuesAndOfTheirFaults) {
  Diagnostics diagnostics;
  YamlReader yaml("f.yaml", diagnostics);
  const YamlNode& root = yaml.Read("a: [1, x, ~]\nb:\n  c: Yes\n  d: [3, 2.5]\n", "a");
  EXPECT_EQ(YamlReader::Find(root, "a").size(), 3u);
  EXPECT_EQ(yaml.Number(YamlReader::Find(root, "a")[0], "a", 0.0), 1.0);
  EXPECT_EQ(yaml.Number(YamlReader::Find(root, "a")[2], "a", 7.0), 7.0);
  EXPECT_FALSE(YamlReader::Find(root, "a")[3]);
  const YamlNode& b = YamlReader::Find(root, "b");
  EXPECT_TRUE(yaml.Flag(YamlReader::Find(b, "c"), "c", false));
  EXPECT_EQ(yaml.Number(YamlReader::Parameter(b, "d"), "d", 0.0), 2.5);
  EXPECT_FALSE(YamlReader::Find(b, "e"));
  ASSERT_FALSE(yaml.failed());
  yaml.Number(YamlReader::Find(root, "a")[1], "the second", 0.0);
  EXPECT_EQ(diagnostics.error()->ToString(), "f.yaml:1:8: error: found 'x' for the second, expected a number");
}

TEST(YamlReaderTest, OfTwoEntriesWithOneKeyTheFirstCounts) {
  Diagnostics diagnostics;
  YamlReader yaml("f.yaml", diagnostics);
  const YamlNode& root = yaml.Read("a: 1\na: 2\n", "a");
  EXPECT_EQ(root.items.size(), 2u);
  EXPECT_EQ(yaml.Number(YamlReader::Find(root, "a"), "a", 0.0), 1.0);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_EQ(diagnostics.warnings()[0].ToString(),
            "f.yaml:2:1: warning: found key 'a' twice, expected it once; the first one counts");
}

TEST(YamlReaderTest, AliasesAreTheValueOfTheirAnchor) {
  Diagnostics diagnostics;
  YamlReader yaml("f.yaml", diagnostics);
  const YamlNode& root = yaml.Read("a: &one [1, 2]\nb: *one\nc: [*one, *one]\n", "a");
  EXPECT_EQ(&YamlReader::Find(root, "b"), &YamlReader::Find(root, "a"));
  EXPECT_EQ(YamlReader::Find(root, "c")[1].size(), 2u);
}

TEST(YamlReaderTest, AliasesCountAsCopies) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i <= 9; ++i) {
    const std::string last = "*a" + std::to_string(i - 1) + ", ";
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int n = 0; n < 10; ++n) text += last;
    text += "]\n";
  }
  EXPECT_EQ(ErrorOf(text),
            "f.yaml:6:45: error: found more values, with those that aliases repeat, expected at most 1000000");
  std::string texts = "a: &a \"" + std::string(1'000'000, 'x') + "\"\nb: [";
  for (int i = 0; i < 20; ++i) texts += "*a, ";
  EXPECT_THAT(ErrorOf(texts + "]\n"), HasSubstr("f.yaml:2:65: error: found more text, with that which aliases repeat"));
}

TEST(YamlReaderTest, NoValueContainsItself) {
  EXPECT_EQ(ErrorOf("a: &a [1, *a]\n"),
            "f.yaml:1:11: error: found a value that contains itself, expected an end of it");
}

TEST(YamlReaderTest, SizeAndDepthAreLimited) {
  EXPECT_EQ(ErrorOf(std::string(YamlReader::kMaxBytes + 1, ' ')),
            "f.yaml: error: found 16777217 bytes, expected at most 16777216");
  std::string many = "a: [";
  for (std::size_t i = 0; i < YamlReader::kMaxValues; ++i) many += "0, ";
  EXPECT_THAT(ErrorOf(many + "]\n"), HasSubstr("found more values"));
  EXPECT_THAT(ErrorOf("a: " + std::string(100'000, '[') + "\n"),
              HasSubstr("found text nested too deeply, expected keys such as 'levels'"));
  EXPECT_EQ(ErrorOf("a: b\n~: 5\n"), "f.yaml:2:1: error: found nothing as a key, expected a word");
}

}  // namespace
}  // namespace troupe
