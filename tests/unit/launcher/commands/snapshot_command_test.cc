#include "launcher/commands/snapshot_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "command_line/exclusive_options.h"
#include "common/spatial/occupancy_grid.h"
#include "launcher/commands/commands.h"
#include "launcher/supervise/run_ways.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "troupe/simulation.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr char kWorld[] = R"(
define box model ( size [1 1 1] )
box( pose [3 0 0 0] name "box" )
define robot position
(
  size [0.4 0.4 0.3]
  velocity_bounds [-1 1 0 0 0 0 -90 90]
  acceleration_bounds [-1 1 0 0 0 0 -90 90]
  ranger( sensor( range [0 4] fov 180 samples 31 ) )
  camera( name "eye" resolution [30 20] )
)
robot( pose [0 0 0 0] name "r0" ctrl "wander" )
robot( pose [0 2 0 90] name "r1" ctrl "wander" )
)";

class SnapshotCommandTest : public ::testing::Test, public test::TemporaryFolder {
 protected:
  SnapshotCommandTest() { Write("good.world", kWorld); }

  SnapshotOptions Good(const std::string& output) const { return {.file = Path("good.world"), .output = Path(output)}; }
  // The exit status, and in `message` the text that was printed for the user.
  int Run(const SnapshotOptions& options) {
    ::testing::internal::CaptureStderr();
    const int status = SnapshotCommand(options);
    message_ = ::testing::internal::GetCapturedStderr();
    return status;
  }
  // The same from a command line.
  int RunLine(const std::string& arguments) {
    CLI::App app;
    int status = -1;
    AddSnapshotCommand(app, status);
    ExcludeOptions(*app.get_subcommand("snapshot"), "snapshot");
    message_.clear();
    ::testing::internal::CaptureStderr();
    try {
      app.parse("snapshot " + arguments);
      message_ = ::testing::internal::GetCapturedStderr();
    } catch (const CLI::ParseError& error) {
      ::testing::internal::GetCapturedStderr();
      message_ = error.what();
      return 2;
    }
    return status;
  }

  std::string message_;
};

TEST_F(SnapshotCommandTest, DrawsBothKindsOfFileAndBothViews) {
  EXPECT_EQ(Run(Good("top.png")), 0) << message_;
  EXPECT_THAT(Read("top.png"), StartsWith("\x89PNG"));
  SnapshotOptions side = Good("side.svg");
  side.view = "side";
  side.rays = true;
  EXPECT_EQ(Run(side), 0) << message_;
  EXPECT_THAT(Read("side.svg"), StartsWith("<?xml"));
}

TEST_F(SnapshotCommandTest, TheSameTickGivesTheSamePictureAndAnotherTickAnother) {
  for (const char* output : {"a.png", "b.png", "c.png"}) {
    SnapshotOptions options = Good(output);
    options.tick = output[0] == 'c' ? 21 : 20;
    options.rays = true;
    EXPECT_EQ(Run(options), 0) << message_;
  }
  EXPECT_EQ(Read("a.png"), Read("b.png"));
  EXPECT_NE(Read("a.png"), Read("c.png"));
}

TEST_F(SnapshotCommandTest, WritesTheViewOfACamera) {
  const std::string file = Path("good.world") + " -o ";
  EXPECT_EQ(RunLine(file + Path("first.png") + " --camera r0"), 0) << message_;
  EXPECT_EQ(RunLine(file + Path("named.png") + " --camera r0/eye"), 0) << message_;
  EXPECT_EQ(RunLine(file + Path("later.png") + " --camera r0/eye --tick 9"), 0) << message_;
  EXPECT_EQ(RunLine(file + Path("depths.png") + " --camera r0/eye --depth"), 0) << message_;
  EXPECT_THAT(Read("first.png"), StartsWith("\x89PNG"));
  EXPECT_EQ(Read("first.png").substr(16, 8), std::string("\0\0\0\x1e\0\0\0\x14", 8)) << "30 by 20 pixels";
  EXPECT_EQ(Read("first.png"), Read("named.png"));
  EXPECT_NE(Read("first.png"), Read("later.png"));
  EXPECT_NE(Read("first.png"), Read("depths.png"));
}

// The picture of a world without what is above.
TEST_F(SnapshotCommandTest, DrawsOnlyModelsAtTheGivenHeights) {
  const std::string below =
      "name \"w\"\nmodel( size [1 1 1] color \"red\" pose [2 0 0 0] )\n"
      "position( name \"r\" size [0.4 0.4 0.3] color \"blue\" pose [0 1 0 0] )\n";
  Write("below.world", below);
  Write("both.world",
        below +
            "model( size [1 1 1] color \"red\" pose [0 0 5 0] model( size [0.2 0.2 0.2] color \"green\" ) )\n"
            "position( name \"up\" size [0.4 0.4 0.3] color \"blue\" pose [1 1 5 0] )\n");
  const std::string part = " --center 1 0 --meters 6 --width 300";
  EXPECT_EQ(RunLine(Path("below.world") + " -o " + Path("below.png") + part), 0) << message_;
  EXPECT_EQ(RunLine(Path("both.world") + " -o " + Path("both.png") + part), 0) << message_;
  EXPECT_EQ(RunLine(Path("both.world") + " -o " + Path("cut.png") + " --heights -1 3" + part), 0) << message_;
  EXPECT_EQ(Read("cut.png"), Read("below.png"));
  EXPECT_NE(Read("both.png"), Read("below.png"));
  // A storey above is drawn as one on the ground.
  Write("lowered.world",
        "name \"w\"\n"
        "model( size [1 1 1] color \"red\" pose [0 0 0 0] model( size [0.2 0.2 0.2] color \"green\" ) )\n"
        "position( name \"up\" size [0.4 0.4 0.3] color \"blue\" pose [1 1 0 0] )\n");
  EXPECT_EQ(RunLine(Path("lowered.world") + " -o " + Path("lowered.png") + part), 0) << message_;
  EXPECT_EQ(RunLine(Path("both.world") + " -o " + Path("storey.png") + " --heights 3 9" + part), 0) << message_;
  EXPECT_EQ(Read("storey.png"), Read("lowered.png"));
  EXPECT_EQ(RunLine(Path("good.world") + " -o " + Path("eye.png") + " --camera r0 --heights 0 1"), 2);
}

TEST_F(SnapshotCommandTest, ReadsItsOptionsFromTheCommandLine) {
  const std::string files = Path("good.world") + " -o " + Path("part.png");
  EXPECT_EQ(RunLine(files + " --tick 5 --view side --rays --center 0 -1 --meters 3 --width 300 --seed 7"), 0)
      << message_;
  EXPECT_THAT(Read("part.png"), StartsWith("\x89PNG"));
}

TEST_F(SnapshotCommandTest, RefusesBadCommandLines) {
  const std::string files = Path("good.world") + " -o " + Path("x.png") + " ";
  const struct {
    std::string arguments;
    std::string message;
  } cases[] = {
      {"", "FILE"},
      {Path("good.world"), "--output is required"},
      {files + "--tick -1", "found '-1', expected a whole number from 0"},
      {files + "--tick 1.5", "found '1.5', expected a whole number from 0"},
      {files + "--tick many", "found 'many'"},
      {files + "--view bottom", "found 'bottom', expected one of top, side"},
      {files + "--width 0", "expected a whole number from 200 to 4096"},
      {files + "--width 5000", "expected a whole number from 200 to 4096"},
      {files + "--center 1", "--center"},
      {files + "--center nan 0", "found a picture centre that is not a place"},
      {files + "--meters 0", "found a picture 0 m wide"},
      {files + "--meters -3", "found a picture -3 m wide"},
      {files + "--meters wide", "--meters"},
      {files + "--seed x", "found 'x'"},
      {files + "--camera missing", "found no robot 'missing'"},
      {files + "--camera r0/nose", "found no camera 'r0/nose', expected one of: eye"},
      {files + "--camera r0 --rays", "--camera excludes --rays"},
      {files + "--depth", "--depth requires --camera"},
      {Path("good.world") + " -o " + Path("x.svg") + " --camera r0", "found a camera's picture as .svg"},
      {files + "--colour red", "--colour"},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(RunLine(c.arguments), 2) << c.arguments;
    EXPECT_THAT(message_, HasSubstr(c.message)) << c.arguments;
    EXPECT_FALSE(std::filesystem::exists(Path("x.png"))) << c.arguments;
  }
}

TEST_F(SnapshotCommandTest, RefusesBadFiles) {
  Write("bad.world", "model(\n  pose [0 0");
  const struct {
    std::string file;
    std::string output;
    std::string message;
  } cases[] = {
      {"good.world", "x.gif", "x.gif: error: found the file ending '.gif', expected .png or .svg"},
      {"good.world", "x", "x: error: found no file ending, expected .png or .svg"},
      {"good.world", "x.PNG", "found the file ending '.PNG'"},
      {"good.world", "no/such/folder/x.png", "x.png: error: cannot write: No such file or directory"},
      {"missing.world", "x.png", "missing.world"},
      {"bad.world", "x.png", "bad.world:2:"},
      {"good.worlds", "x.png", "good.worlds"},
  };
  for (const auto& c : cases) {
    SnapshotOptions options{.file = Path(c.file), .output = Path(c.output)};
    EXPECT_EQ(Run(options), 2) << c.message;
    EXPECT_THAT(message_, HasSubstr("error: ")) << c.message;
    EXPECT_THAT(message_, HasSubstr(c.message));
    EXPECT_FALSE(std::filesystem::exists(Path("x.png"))) << c.message;
  }
}

TEST_F(SnapshotCommandTest, LeavesAnOlderPictureAloneWhenTheWorldIsBad) {
  Write("old.png", "old");
  Write("bad.world", "model(");
  SnapshotOptions options = Good("old.png");
  options.file = Path("bad.world");
  EXPECT_EQ(Run(options), 2);
  EXPECT_EQ(Read("old.png"), "old");
}

TEST_F(SnapshotCommandTest, ADiskThatIsFullIsAFailure) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this host";
  std::filesystem::create_symlink("/dev/full", Path("full.png"));
  EXPECT_EQ(Run(Good("full.png")), 3);
  EXPECT_THAT(message_, HasSubstr("cannot write: No space left on device"));
}

TEST_F(SnapshotCommandTest, ReachesTheStateOfARunWithServiceAndAgents) {
  RunOptions options{.file = Path("good.world"), .in_process = true};
  options.network.session = "snapshot-test-" + std::to_string(getpid());
  options.headless = true;
  options.run.speed.emplace(std::nullopt);
  options.run.ticks = 40;
  options.hash_log = Path("hashes");
  RunEnd run;
  ASSERT_EQ(RunInProcess(options, nullptr,
                         [&run](const RunEnd& end) {
                           run = end;
                           return end.exit_status;
                         }),
            0);

  Result<Simulation> simulation = Simulation::Load(options.file);
  ASSERT_TRUE(simulation.ok());
  simulation.value().Step(40);
  EXPECT_TRUE(simulation.value().failures().empty());
  EXPECT_EQ(simulation.value().state_hash(), run.outcome->run.state_hash);
}

int Export(std::vector<std::string> words) {
  CLI::App app;
  int exit_status = -1;
  AddExportMapCommand(app, exit_status);
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return exit_status;
}

// The written map, loaded as a world, gives the same map again.
TEST(ExportMap, WritesAMapThatGivesTheSameMapWhenItIsRead) {
  test::TemporaryFolder folder;
  std::ofstream(folder.Path("a.world")) << "model ( name \"l\" pose [ 1 0.5 0 0 ] size [ 2 1 1 ] )\n"
                                           "model ( name \"r\" pose [ 3.5 2.75 0 0 ] size [ 1 0.5 1 ] )\n";
  ASSERT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map"), "--resolution", "0.25"}), 0);
  const LoadedWorld read = test::ValueOf(LoadWorld(folder.Path("map.yaml"), {}));
  const LoadedWorld original = test::ValueOf(LoadWorld(folder.Path("a.world"), {}));
  const OccupancyGrid expected = MakeOccupancyGrid(Scene(original.world), 0.25, 0.1);
  const OccupancyGrid found = MakeOccupancyGrid(Scene(read.world), 0.25, 0.1);
  EXPECT_EQ(found.width, expected.width);
  EXPECT_EQ(found.height, expected.height);
  EXPECT_NEAR(found.origin_x, expected.origin_x, 1e-9);
  EXPECT_NEAR(found.origin_y, expected.origin_y, 1e-9);
  EXPECT_EQ(found.occupied, expected.occupied);
}

void WriteMap(const test::TemporaryFolder& folder, const std::string& pixels, const std::string& more = "") {
  std::ofstream(folder.Path("in.pgm")) << "P2 4 3 255\n" << pixels;
  std::ofstream(folder.Path("in.yaml")) << "image: in.pgm\nresolution: 0.25\norigin: [-1.0, 2.5, 0]\nnegate: 0\n"
                                           "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
                                        << more;
}

TEST(ExportMap, KeepsSizeOriginResolutionAndPixelsOfAMap) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 0 254 254  254 254 0 254\n");
  ASSERT_EQ(Export({"export-map", folder.Path("in.yaml"), "-o", folder.Path("out")}), 0);
  std::stringstream yaml;
  yaml << std::ifstream(folder.Path("out.yaml")).rdbuf();
  EXPECT_THAT(yaml.str(), testing::HasSubstr("resolution: 0.25\norigin: [-1, 2.5, 0]\n"));
  std::stringstream image;
  image << std::ifstream(folder.Path("out.pgm")).rdbuf();
  const std::string light(1, '\xfe');
  const std::string row = light + light + light + light;
  EXPECT_EQ(image.str(), "P5\n4 3\n255\n" + row + light + std::string(1, '\0') + light + light + light + light +
                             std::string(1, '\0') + light);
}

TEST(ExportMap, WritesAMapWithoutAnOccupiedCell) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 254 254 254  254 205 205 254\n");
  ASSERT_EQ(Export({"export-map", folder.Path("in.yaml"), "-o", folder.Path("out"), "--resolution", "0.1"}), 0);
  const Result<LoadedWorld> read = LoadWorld(folder.Path("out.yaml"), {});
  ASSERT_TRUE(read.ok()) << read.error().ToString();
  EXPECT_EQ(read.value().map_width, 10);
  EXPECT_EQ(read.value().map_height, 8);
}

TEST(ExportMap, EnlargesAMapByWholeCellsForBodiesBesideIt) {
  const test::TemporaryFolder folder;
  WriteMap(folder, "254 254 254 254  254 254 254 254  254 254 254 254\n");
  std::ofstream(folder.Path("a.world"))
      << "model( map_yaml \"in.yaml\" )\nmodel( pose [-1.6 3 0 0] size [0.1 0.1 1] )\n";
  ASSERT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("out")}), 0);
  const Result<LoadedWorld> read = LoadWorld(folder.Path("out.yaml"), {});
  ASSERT_TRUE(read.ok()) << read.error().ToString();
  EXPECT_EQ(read.value().map_width, 7);  // from -1.75, a whole number of cells before -1, to 0
  EXPECT_EQ(read.value().map_height, 3);
  EXPECT_EQ(read.value().world.models[0].X_PM, (Pose{-1.75, 2.5, 0, 0}));
}

TEST(ExportMap, WritesABuildingThatIsTheSameWorld) {
  const test::TemporaryFolder folder;
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse.building.yaml";
  ASSERT_EQ(Export({"export-map", path, "-o", folder.Path("copy"), "--building"}), 0);
  const LoadedWorld read = test::ValueOf(LoadWorld(folder.Path("copy.building.yaml"), {}));
  EXPECT_TRUE(read.world == test::ValueOf(LoadWorld(path, {})).world);
  std::ofstream(folder.Path("a.world")) << "model ( name \"l\" size [ 2 1 1 ] )\n";
  EXPECT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map"), "--building"}), 2);
}

TEST(ExportMap, RefusesAWorldWithoutStaticBodies) {
  test::TemporaryFolder folder;
  std::ofstream(folder.Path("a.world")) << "position ( name \"r\" )\n";
  EXPECT_EQ(Export({"export-map", folder.Path("a.world"), "-o", folder.Path("map")}), 2);
  EXPECT_EQ(Export({"export-map", folder.Path("no.world"), "-o", folder.Path("map")}), 2);
}

}  // namespace
}  // namespace troupe
