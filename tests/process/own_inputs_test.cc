// No command overwrites a file that it reads, by whatever path the output leads to it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

class OwnInputsTest : public testing::Test {
 protected:
  OwnInputsTest() {
    folder_.Write("own.inc", "define box model ( size [1 1 1] )\n");
    folder_.Write("own.world", "include \"own.inc\"\nposition ( name \"a\" )\nbox ( pose [3 0 0 0] )\n");
    folder_.Write("own.json", R"({"world": "own.world", "ticks": 5})");
    folder_.Write("own.test.json", R"~({"scenario": "own.json", "ticks": 3,
      "expect": ["forall r: always speed(r) < 1 m/s"], "metrics": {"top": "max of speed(r)"}})~");
    folder_.Write("second.world", "position ( name \"a\" )\n");
    folder_.Write("worlds.test.json", R"~({"scenario": "own.json", "ticks": 3,
      "vary": {"world": ["own.world", "second.world"]}, "expect": ["forall r: always speed(r) < 1 m/s"]})~");
    folder_.Write("map.yaml",
                  "image: map.pgm\nmode: trinary\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
                  "occupied_thresh: 0.65\nfree_thresh: 0.25\n");
    folder_.Write("map.pgm", std::string("P5\n2 2\n255\n") + std::string("\0\376\376\376", 4));
    folder_.Write("flat.building.yaml",
                  "coordinate_system: cartesian_meters\nlevels:\n  L1:\n    elevation: 0\n    vertices:\n"
                  "      - [0, 0, 0, a]\n      - [4, 0, 0, b]\n      - [4, -4, 0, c]\n    lanes:\n"
                  "      - [0, 1, {graph_idx: [2, 0], bidirectional: [4, true]}]\n"
                  "    walls:\n      - [0, 1, {}]\n      - [1, 2, {}]\nname: flat\n");
    std::filesystem::create_directory(folder_.Path("bag"));
    OutputOf(Troupe(
        {"run", folder_.Path("own.json"), "--in-process", "--headless", "--record", folder_.Path("bag/bag_0.mcap")}));
    std::filesystem::copy(folder_.Path("bag/bag_0.mcap"), folder_.Path("run.mcap"));
    std::filesystem::create_directory(folder_.Path("tables"));
    std::filesystem::create_symlink("../run.mcap", folder_.Path("tables/people.csv"));
    OutputOf(Troupe({"sweep", folder_.Path("own.test.json"), "-o", folder_.Path("sweep")}));
    std::filesystem::create_hard_link(folder_.Path("own.inc"), folder_.Path("picture.png"));
    std::filesystem::create_hard_link(folder_.Path("map.pgm"), folder_.Path("other.pgm"));
    std::filesystem::create_symlink("own.world", folder_.Path("link.html"));
    std::filesystem::create_symlink("flat.building.yaml", folder_.Path("lanes.lif.json"));
    std::filesystem::create_symlink("../own.inc", folder_.Path("sweep/old.csv"));
    before_ = Contents();
  }

  std::map<std::string, std::string> Contents() const {
    std::map<std::string, std::string> contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      if (entry.is_regular_file()) contents[entry.path().string()] = TextOf(entry.path().string());
    }
    return contents;
  }

  // "@NAME" is the path of a file in the folder.
  void ExpectRefused(std::vector<std::string> words, const std::string& program = "troupe") {
    const std::string text = testing::PrintToString(words);
    for (std::string& word : words) {
      if (word.starts_with("@")) word = folder_.Path(word.substr(1));
    }
    words.insert(words.begin(), ProgramPath(program));
    const std::string printed = OutputOf(Program(words), 2);
    EXPECT_THAT(printed, HasSubstr("which the command reads")) << text;
    EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), 1) << printed;
    EXPECT_EQ(Contents(), before_) << text;
  }

  TemporaryFolder folder_;
  std::map<std::string, std::string> before_;
};

TEST_F(OwnInputsTest, OfMapsPicturesAndPages) {
  ExpectRefused({"export-map", "@map.yaml", "-o", "@map"});
  ExpectRefused({"export-map", "@map.yaml", "-o", "@other"});
  ExpectRefused({"export-map", "@flat.building.yaml", "-o", "@flat", "--building"});
  ExpectRefused({"export-map", "@flat.building.yaml", "-o", "@flat.building"});
  ExpectRefused({"export-map", "@flat.building.yaml", "-o", "@lanes", "--lanes"});
  ExpectRefused({"snapshot", "@own.json", "-o", "@picture.png"});
  ExpectRefused({"view", "@own.json", "--static", "-o", "@link.html"});
  ExpectRefused({"view", "@run.mcap", "--static", "-o", "@bag/../run.mcap"});
}

TEST_F(OwnInputsTest, OfRecordings) {
  for (const char* option : {"--hash-log", "--poses", "--scans"}) {
    ExpectRefused({"replay", "@run.mcap", option, "@tables/people.csv"});
  }
  ExpectRefused({"export", "@run.mcap", "--format", "foxglove", "-o", "@tables/../run.mcap"});
  ExpectRefused({"export", "@run.mcap", "--format", "csv", "-o", "@tables"});
  ExpectRefused({"export", "@bag/bag_0.mcap", "--format", "ros2", "-o", "@bag"});
  ExpectRefused({"run", "@run.mcap", "--in-process", "--record", "@tables/people.csv"});
}

TEST_F(OwnInputsTest, OfTests) {
  for (const char* input : {"own.test.json", "own.json", "own.world", "own.inc"}) {
    ExpectRefused({"test", "@own.test.json", "--junit", std::string("@bag/../") + input});
  }
  ExpectRefused({"test", "@worlds.test.json", "--junit", "@second.world"});
  ExpectRefused({"test", "@own.test.json", "--report", "@sweep"});
  ExpectRefused({"sweep", "@own.test.json", "-o", "@sweep"});
  ExpectRefused({"sweep", "--merge", "@sweep", "-o", "@sweep"});
  const std::string same = OutputOf(Troupe({"test", folder_.Path("own.test.json"), "--junit",
                                            folder_.Path("report/index.html"), "--report", folder_.Path("report")}),
                                    2);
  EXPECT_THAT(same, HasSubstr("--junit and the report name the same file"));
}

TEST_F(OwnInputsTest, OfAServiceThatIsStartedByHand) {
  for (const char* option : {"--hash-log", "--poses", "--record", "--trace", "--journal"}) {
    ExpectRefused({"@own.json", option, "@own.inc", "--domain", std::to_string(TestDomain())}, "world-service");
  }
}

}  // namespace
}  // namespace troupe::test
