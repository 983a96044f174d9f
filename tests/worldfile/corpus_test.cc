// Findings of fuzzing stay fixed: each file of the corpus is an error with a place, or a valid world.
#include <cstdlib>
#include <filesystem>

#include "common/worldfile/build/build_world.h"
#include "common/worldfile/stage/stage_parser.h"
#include "common/worldfile/text/text_file.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

TEST(Corpus, EveryFileIsRefusedWithAPlaceOrMakesASoundWorld) {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  const std::map<std::string, std::string> no_files;
  ParseOptions parse;
  parse.memory_files = &no_files;
  BuildOptions build;
  build.without_bitmaps = true;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(source) + "/fuzz/corpus/world")) {
    const Result<std::string> text = ReadTextFile(entry.path().string(), {});
    ASSERT_TRUE(text.ok());
    ++count;
    const Result<WorldTree> tree = ParseStageText(text.value(), "w.world", parse);
    if (!tree.ok()) {
      EXPECT_GT(tree.error().where.line, 0) << entry.path();
      continue;
    }
    const Result<LoadedWorld> loaded = BuildWorld(tree.value(), {}, build);
    if (loaded.ok()) {
      EXPECT_TRUE(Validate(loaded.value().world).ok()) << entry.path();
    } else {
      EXPECT_GT(loaded.error().where.line, 0) << entry.path();
    }
  }
  EXPECT_GE(count, 9);
}

}  // namespace
}  // namespace troupe
