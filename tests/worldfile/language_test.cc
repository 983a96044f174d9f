// The language: comments, line ends, defines, includes, and the warnings about them.
#include "tests/worldfile/world_folder.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

WorldTree Parse(const std::string& text, const ParseOptions& options = {}) {
  Result<WorldTree> tree = ParseStageText(text, "w.world", options);
  if (!tree.ok()) {
    ADD_FAILURE() << tree.error().ToString();
    return {};
  }
  return std::move(tree).value();
}

double NumberOf(const WorldNode& node, const std::string& name) {
  const Property* property = node.Find(name);
  return property == nullptr ? -1.0 : std::get<Value::Number>(property->value.content).value;
}

TEST(Language, ReadsPropertiesOfTheWorldAnywhere) {
  const WorldTree tree = Parse("a 1 # comment ( [ \"\nmodel( )\nb \"text\" c [1 \"two\" 3] # the end");
  EXPECT_EQ(NumberOf(tree.world, "a"), 1.0);
  EXPECT_EQ(std::get<std::string>(tree.world.Find("b")->value.content), "text");
  EXPECT_EQ(std::get<std::vector<Value::Scalar>>(tree.world.Find("c")->value.content).size(), 3u);
  EXPECT_EQ(tree.world.children.size(), 1u);
}

TEST(Language, NumbersHaveSignsAndPoints) {
  const WorldTree tree = Parse("a -0.5 b +2 c .25 d 3.\n");
  EXPECT_EQ(NumberOf(tree.world, "a"), -0.5);
  EXPECT_EQ(NumberOf(tree.world, "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world, "c"), 0.25);
  EXPECT_EQ(NumberOf(tree.world, "d"), 3.0);
}

TEST(Language, AllLineEndsCountAsOneLine) {
  for (const char* end : {"\n", "\r", "\r\n", "\n\r"}) {
    const WorldTree tree = Parse(std::string("a 1") + end + end + "b 2" + end);
    EXPECT_EQ(tree.world.Find("b")->where.line, 3);
    EXPECT_EQ(tree.world.Find("b")->where.column, 1);
    EXPECT_EQ(tree.world.Find("b")->value.where.column, 3);
  }
}

TEST(Language, OpeningBracketMayBeOnALaterLine) {
  const WorldTree tree = Parse("define rob position # a robot\n\n(\n)\nrob # here\n\n(\n)\n");
  ASSERT_EQ(tree.world.children.size(), 1u);
  EXPECT_EQ(tree.world.children[0].type, "position");
  EXPECT_THAT(tree.world.children[0].macros, ElementsAre("rob"));
}

TEST(Language, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(NumberOf(Parse("\xef\xbb\xbf"
                           "a 1")
                         .world,
                     "a"),
            1.0);
}

TEST(Language, LongTokensAreRead) {
  const std::string name(5000, 'n');
  EXPECT_EQ(NumberOf(Parse(name + " 1 # " + name).world, name), 1.0);
}

TEST(Language, LaterPropertyReplacesEarlierOne) {
  const WorldTree tree = Parse("define m model( a 1 b 1 c 1 )\ndefine n m( b 2 c 2 )\nn( c 3 c 4 )\n");
  const WorldNode& node = tree.world.children[0];
  EXPECT_EQ(NumberOf(node, "a"), 1.0);
  EXPECT_EQ(NumberOf(node, "b"), 2.0);
  EXPECT_EQ(NumberOf(node, "c"), 4.0);
  EXPECT_EQ(node.properties.size(), 3u);
  EXPECT_THAT(node.macros, ElementsAre("n", "m"));
}

TEST(Language, ChildrenOfMacrosAreKeptAndPrecedeTheInstances) {
  const WorldTree tree = Parse("define m model( model( a 1 ) )\ndefine n m( model( a 2 ) )\nn( model( a 3 ) )\n");
  const WorldNode& node = tree.world.children[0];
  ASSERT_EQ(node.children.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(NumberOf(node.children[i], "a"), static_cast<double>(i + 1));
}

TEST(Language, MacrosMayBeUsedInsideOthersInAnyOrderOfDefines) {
  const WorldTree tree =
      Parse("define rob base( eye( a 1 ) )\ndefine base position( )\ndefine eye ranger( )\nrob( )\n");
  EXPECT_EQ(tree.world.children[0].type, "position");
  EXPECT_EQ(tree.world.children[0].children[0].type, "ranger");
}

TEST(Language, MacroMayContainItsBaseType) {
  const WorldTree tree = Parse("define part model( )\ndefine whole part( part( ) )\nwhole( part( whole( ) ) )\n");
  ASSERT_EQ(tree.world.children[0].children.size(), 2u);
  EXPECT_EQ(tree.world.children[0].children[1].children.size(), 1u);
}

TEST(Language, FirstDefineOfANameCounts) {
  const WorldTree tree = Parse("define m model( a 1 )\ndefine m model( a 2 )\nm( )\n");
  EXPECT_EQ(NumberOf(tree.world.children[0], "a"), 1.0);
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(),
            "w.world:2:8: warning: macro 'm' is already defined at w.world:1; this definition is ignored");
}

TEST(Language, RepeatedPropertyIsNamed) {
  const WorldTree tree = Parse("model( a 1\n a 2 )\n");
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:1:8: warning: property 'a' is given again at line 2, which counts");
}

TEST(Language, IncludesAreSplicedInAnywhere) {
  const std::map<std::string, std::string> files = {{"a.inc", "a 1"}, {"b.inc", "b 2\n"}, {"c.inc", ""}};
  ParseOptions options;
  options.memory_files = &files;
  const WorldTree tree =
      Parse("include \"a.inc\"\nmodel(\n include \"b.inc\"\n c 3\n)\ninclude \"c.inc\"\ninclude \"b.inc\"", options);
  EXPECT_EQ(NumberOf(tree.world, "a"), 1.0);
  EXPECT_EQ(NumberOf(tree.world, "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world.children[0], "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world.children[0], "c"), 3.0);
  EXPECT_EQ(tree.world.Find("b")->where.file, "b.inc");
  EXPECT_THAT(tree.files, ElementsAre("w.world", "a.inc", "b.inc", "c.inc", "b.inc"));
}

TEST(Language, RestOfTheLineOfAnIncludeIsIgnored) {
  const std::map<std::string, std::string> files = {{"a.inc", "a 1\n"}};
  ParseOptions options;
  options.memory_files = &files;
  EXPECT_THAT(Parse("include \"a.inc\" # a comment\n", options).warnings, IsEmpty());
  const WorldTree tree = Parse("include \"a.inc\" b 2\nc 3\n", options);
  EXPECT_EQ(tree.world.Find("b"), nullptr);
  EXPECT_EQ(NumberOf(tree.world, "c"), 3.0);
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:1:9: warning: the text after an include on its line is ignored");
}

TEST(Language, IncludesAreFoundBesideTheTopFileThenBesideTheNamingFileThenInStagepath) {
  const WorldFolder folder;
  folder.Write("sub/one.inc", "include \"two.inc\"\ninclude \"three.inc\"\ninclude \"else/four.inc\"\n");
  folder.Write("two.inc", "two 1\n");
  folder.Write("sub/two.inc", "two 2\n");
  folder.Write("sub/three.inc", "three 3\n");
  folder.Write("library/four.inc", "four 4\n");
  folder.Write("w.world", "include \"sub/one.inc\"\n");
  ASSERT_EQ(setenv("STAGEPATH", ("/nowhere:" + folder.Path("library")).c_str(), 1), 0);
  const Result<WorldTree> tree = ParseStageWorld(folder.Path("w.world"));
  unsetenv("STAGEPATH");
  ASSERT_TRUE(tree.ok()) << tree.error().ToString();
  EXPECT_EQ(NumberOf(tree.value().world, "two"), 1.0);
  EXPECT_EQ(NumberOf(tree.value().world, "three"), 3.0);
  EXPECT_EQ(NumberOf(tree.value().world, "four"), 4.0);
}

TEST(Language, CommentThatIsNotUtf8IsAWarning) {
  const WorldTree tree = Parse("a 1\n# S\xe3o Paulo\n");
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:2:4: warning: a comment is not UTF-8");
}

TEST(Language, InstantiateEqualsTheNodeOfAFile) {
  const WorldTree tree = Parse("define rob position( a 1 ranger( ) )\n");
  const Result<WorldNode> made = Instantiate(tree, "rob", {"s.json", 3, 4});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value().type, "position");
  EXPECT_EQ(NumberOf(made.value(), "a"), 1.0);
  EXPECT_EQ(made.value().children.size(), 1u);
  EXPECT_EQ(made.value().where.line, 3);
  EXPECT_EQ(Instantiate(tree, "position", {}).value().type, "position");
}

}  // namespace
}  // namespace troupe
