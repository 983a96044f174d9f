// Maps of cells, problems of paths, and files of paths.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/source_text.h"
#include "robot-agent/controller/create_controller.h"
#include "tests/worldfile/world_folder.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kMap = "type octile\nheight 3\nwidth 4\nmap\n....\n.@T.\nW..E\n";
constexpr const char* kRows =
    "version 1\n"
    "0\troom.map\t4\t3\t0\t0\t3\t0\t3\n"
    "0\troom.map\t4\t3\t3\t2\t0\t0\t5\n";

class GridsTest : public testing::Test {
 protected:
  GridsTest() {
    folder_.Write("room.map", kMap);
    folder_.Write("room.scen", kRows);
  }
  // The message of the error of a problem, with the paths of a file.
  std::string ErrorOf(const std::string& problem, const std::string& paths = "") {
    GridOptions options;
    if (!paths.empty()) options.paths = folder_.Write("p.paths", paths);
    const Result<GridProblem> read = ReadGridProblem(folder_.Path(problem), options);
    return read.ok() ? "" : WithoutFolder(read.error().ToString());
  }
  std::string ErrorOfMap(const std::string& text) {
    folder_.Write("bad.map", text);
    return ErrorOf("bad.map");
  }
  std::string ErrorOfRows(const std::string& rows) {
    folder_.Write("bad.scen", "version 1\n" + rows);
    return ErrorOf("bad.scen");
  }
  std::string WithoutFolder(std::string text) const {
    for (std::size_t at = 0; (at = text.find(folder_.path() + "/")) != std::string::npos;) {
      text.erase(at, folder_.path().size() + 1);
    }
    return text;
  }
  GridProblem Read(const std::string& name, const GridOptions& options = {}) {
    const Result<GridProblem> read = ReadGridProblem(folder_.Path(name), options);
    EXPECT_TRUE(read.ok()) << read.error().ToString();
    return read.ok() ? read.value() : GridProblem();
  }

  WorldFolder folder_;
};

LoadOverrides WithGrid(const GridOptions& grid) {
  LoadOverrides overrides;
  overrides.grid = grid;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  return overrides;
}

TEST_F(GridsTest, AMapIsAWorldWithLanesBetweenFreeCells) {
  const LoadedWorld loaded = folder_.Load("room.map");
  ASSERT_THAT(loaded.world.lane_graphs, SizeIs(1));
  const LaneGraph& graph = loaded.world.lane_graphs[0];
  EXPECT_THAT(graph.vertices, SizeIs(9));
  EXPECT_THAT(graph.lanes, SizeIs(8));
  // Row 0 is the top one.
  ASSERT_TRUE(graph.Find("x0y0"));
  EXPECT_EQ(graph.vertices[*graph.Find("x0y0")].position, Vec2(0.5, 2.5));
  EXPECT_EQ(graph.vertices[*graph.Find("x3y2")].position, Vec2(3.5, 0.5));
  EXPECT_FALSE(graph.Find("x1y1"));
  ASSERT_THAT(loaded.world.models, SizeIs(1));
  const ModelDescription& map = loaded.world.models[0];
  EXPECT_EQ(map.size_x, 4.0);
  EXPECT_EQ(map.size_y, 3.0);
  EXPECT_EQ(map.map, (MapGrid{4, 3, 1.0}));
  std::vector<std::string> areas;
  for (const Rectangle& r : loaded.world.shape(map.shape).rectangles) {
    areas.push_back(NumberText(r.min_x) + " " + NumberText(r.min_y) + " " + NumberText(r.max_x) + " " +
                    NumberText(r.max_y));
  }
  EXPECT_THAT(areas, testing::UnorderedElementsAre("0 0 1 1", "1 1 3 2"));
}

TEST_F(GridsTest, AMapMayBeTheBodyOfAModelAndTheWorldOfAScenario) {
  const LoadedWorld loaded = folder_.LoadText("model( name \"m\" map_cells \"room.map\" cell_size 2 )\n");
  EXPECT_EQ(loaded.world.models[0].size_x, 8.0);
  EXPECT_THAT(loaded.world.lane_graphs, IsEmpty());
  folder_.Write("s.json", R"({"world": "room.map", "robots": [{"model": "CellRobot", "name": "a", "pose": [0.5, 2.5, 0],
    "controller": {"name": "lanes", "parameters": {"planned": true, "places": ["x3y0"]}}}]})");
  const LoadedWorld scenario = folder_.Load("s.json", WithGrid({}));
  EXPECT_THAT(scenario.world.robots, SizeIs(1));
  EXPECT_THAT(scenario.world.lane_graphs, SizeIs(1));
  folder_.Write("w.world", "model( map_cells \"room.png\" )");
  EXPECT_THAT(folder_.ErrorOf("w.world"), HasSubstr("w.world:1:18: error: found"));
}

TEST_F(GridsTest, TheAgentsOfRowsAreRobotsWithTrips) {
  const LoadedWorld loaded = folder_.Load("room.scen", WithGrid({.agents = 1, .cell = 2.0}));
  ASSERT_THAT(loaded.world.robots, SizeIs(1));
  const RobotDescription& robot = loaded.world.robots[0];
  EXPECT_EQ(robot.name, "r0");
  EXPECT_EQ(robot.controller.name, "lanes");
  const Pose& start = loaded.world.model(robot.root).X_PM;
  EXPECT_EQ(start.translation(), Vec2(1.0, 5.0));
  ASSERT_THAT(loaded.world.lane_trips, SizeIs(1));
  const std::uint32_t goal = loaded.world.lane_trips[0].goals.at(0);
  EXPECT_EQ(loaded.world.lane_graphs[0].vertices[goal].name, "x3y0");
  for (const Warning& warning : loaded.warnings) ADD_FAILURE() << warning.ToString();
  EXPECT_TRUE(loaded.settings.ticks);
  EXPECT_THAT(folder_.Load("room.scen", WithGrid({})).world.robots, SizeIs(2));
}

TEST_F(GridsTest, OptionsOfAgentsNeedAProblem) {
  folder_.Write("w.world", "model( )");
  LoadOverrides overrides;
  overrides.grid.agents = 1;
  const Result<LoadedWorld> loaded = LoadWorld(folder_.Path("w.world"), overrides);
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.error().message, HasSubstr("found no problem of paths for the options"));
}

TEST_F(GridsTest, ABadMapGivesOneLineWithItsPlace) {
  const std::pair<std::string, std::string> bad[] = {
      {"", "bad.map: error: found the end of the file, expected a line 'map' and the cells"},
      {"type tile\n", "bad.map:1:6: error: found a map of type 'tile', expected octile"},
      {"type octile\nsize 3\n", "bad.map:2:1: error: found 'size 3', expected type, height, width or map"},
      {"type octile\nwidth 3\nmap\n...\n",
       "bad.map:3:1: error: found no height of the map, expected a line 'height N' before 'map'"},
      {"height x\n", "bad.map:1:8: error: found 'x' for the height, expected a number of cells"},
      {"height 0\nwidth 1\nmap\n", "bad.map:3:1: error: found a map of 1 x 0 cells, expected 1 to 16000000 cells"},
      {"height 70000\nwidth 70000\nmap\n",
       "bad.map:3:1: error: found a map of 70000 x 70000 cells, expected 1 to 16000000 cells"},
      {"width 2\r\nheight 2\r\nmap\r\n..\r\n.\r\n", "bad.map:5:2: error: found 1 cell, expected 2"},
      {"width 2\nheight 2\nmap\n..\n...\n", "bad.map:5:3: error: found 3 cells, expected 2"},
      {"width 2\nheight 2\nmap\n..\n.x\n", "bad.map:5:2: error: found 'x' for a cell, expected one of . G S E @ O T W"},
      {"width 2\nheight 2\nmap\n..\n", "bad.map:4:1: error: found 1 line of cells, expected 2"},
      {"width 2\nheight 1\nmap\n..\n..\n", "bad.map:5:1: error: found more than 1 line of cells"},
  };
  for (const auto& [text, message] : bad) EXPECT_EQ(ErrorOfMap(text), message) << text;
}

TEST_F(GridsTest, BadRowsGiveOneLineWithTheirPlace) {
  const std::pair<std::string, std::string> bad[] = {
      {"0 room.map 4 3 0 0 3 0\n",
       "bad.scen:2:1: error: found 8 fields, expected 9: bucket, map, width, height, start x and y, goal x and y, "
       "length"},
      {"0 none.map 4 3 0 0 3 0 3\n",
       "bad.scen:2:3: error: cannot read 'none.map' (No such file or directory), expected a readable file"},
      {"0 room.map 4 3 4 0 3 0 3\n", "bad.scen:2:16: error: found '4' for x of the start, expected 0 to 3"},
      {"0 room.map 4 3 0 -1 3 0 3\n", "bad.scen:2:18: error: found '-1' for y of the start, expected 0 to 2"},
      {"0 room.map 4 3 0 0 1 1 3\n",
       "bad.scen:2:20: error: found the goal at the blocked cell (1, 1), expected a free one"},
      {"0 room.map 4 3 0 0 3 0 3\n0 other.map 4 3 0 0 3 0 3\n",
       "bad.scen:3:3: error: found the map 'other.map', expected 'room.map' as in the first row"},
      {"0 room.map 4 3 0 0 3 0 3\n0 room.map 4 3 0 0 2 0 3\n",
       "bad.scen:3:1: error: found the start (0, 0) of agent 0 again, expected another one"},
      {"0 room.map 4 3 0 0 3 0 3\n0 room.map 4 3 1 0 3 0 3\n",
       "bad.scen:3:1: error: found the goal (3, 0) of agent 0 again, expected another one"},
      {"", "bad.scen:1:1: error: found no row, expected one for each agent"},
  };
  for (const auto& [rows, message] : bad) EXPECT_EQ(ErrorOfRows(rows), message) << rows;
  folder_.Write("bad.scen", "room.map 1\n");
  EXPECT_EQ(ErrorOf("bad.scen"), "bad.scen:1:1: error: found 'room.map 1', expected 'version 1'");
  folder_.Write("split.map", "type octile\nheight 1\nwidth 3\nmap\n.@.\n");
  EXPECT_EQ(ErrorOfRows("0 split.map 3 1 0 0 2 0 2\n"),
            "bad.scen:2:1: error: found the goal (2, 0), expected one that can be reached from the start (0, 0)");
}

TEST_F(GridsTest, MoreAgentsThanRowsAreAnError) {
  const Result<GridProblem> read = ReadGridProblem(folder_.Path("room.scen"), {.agents = 3});
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().message, HasSubstr("found 2 agents, expected 3"));
}

TEST_F(GridsTest, PathsMayHaveStepsOrNotAndEitherOrder) {
  for (const char* text : {"Agent 0: (0,0,0)->(1,0,1)->(2,0,2)->(3,0,5)->\nAgent 1:(3,2,0)->(3,1,1)->(3,1,4)->(3,0,9)->"
                           "(3,0,10)->(2,0,12)->(1,0,13)->(0,0,14)->\n",
                           "Agent 1:(2,3)->(2,2)\n"}) {
    GridOptions options;
    options.paths = folder_.Write("p.paths", text);
    const Result<GridProblem> read = ReadGridProblem(folder_.Path("room.scen"), options);
    EXPECT_FALSE(read.ok());  // they meet, and one is missing
  }
  GridOptions options{.agents = 1};
  options.paths = folder_.Write("p.paths", "Agent 0: (0,0,0)->(1,0,1)->(1,0,2)->(2,0,3.0)->(3,0,5)->\r\n\r\n");
  const GridProblem steps = Read("room.scen", options);
  EXPECT_THAT(steps.agents[0].path, ElementsAre(GridCell{0, 0}, GridCell{1, 0}, GridCell{2, 0}, GridCell{3, 0}));
  EXPECT_THAT(steps.agents[0].steps, ElementsAre(0, 1, 3, 5));
  folder_.Write("one.scen", "version 1\n0 room.map 4 3 3 2 0 0 5\n");
  options.paths = folder_.Write("p.paths", "Agent 0:(2,3)->(1,3)->(0,3)->(0,2)->(0,1)->(0,0)");
  const GridProblem rows_first = Read("one.scen", options);
  EXPECT_EQ(rows_first.agents[0].path.size(), 6u);
  EXPECT_EQ(rows_first.agents[0].path[1], (GridCell{3, 1}));
  EXPECT_THAT(rows_first.agents[0].steps, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST_F(GridsTest, BadPathsGiveOneLineWithTheirPlace) {
  const std::string first = "Agent 0:(0,0)->(1,0)->(2,0)->(3,0)\n";
  const std::pair<std::string, std::string> bad[] = {
      {"Robot 0:(0,0)\n", "p.paths:1:1: error: found 'Robot 0:(0,0)', expected 'Agent N:' and its path"},
      {"Agent x:(0,0)\n", "p.paths:1:7: error: found no number of an agent, expected a whole number from 0"},
      {"Agent 7:(0,0)\n", "p.paths: error: found no path of r0, expected one"},
      {"Agent 0 (0,0)\n", "p.paths:1:9: error: found '(0,0)', expected ':'"},
      {"Agent 0:(0,0)(1,0)\n", "p.paths:1:14: error: found '(1,0)', expected '->'"},
      {"Agent 0:(0,0)->(1,a)\n",
       "p.paths:1:19: error: found 'a)', expected a place (a,b) or (a,b,step) of whole numbers"},
      {"Agent 0:(0,0,0)->(1,0,0)\n", "p.paths:1:23: error: found step 0, expected more than 0"},
      {first + first, "p.paths:2:7: error: found agent 0 again, expected each once"},
      {first, "p.paths: error: found no path of r1, expected one"},
      {"Agent 0:(1,0)->(0,0)\n", "p.paths:1:9: error: found the place (1, 0), expected the start (0, 0) of r0"},
      {"Agent 0:(0,0)->(2,0)\n",
       "p.paths:1:16: error: found a jump to (2, 0), expected the cell before or one beside it"},
      {"Agent 0:(0,0)->(0,-1)\n", "p.paths:1:16: error: found the place (0, -1) outside of the map of 4 x 3 cells"},
      {"Agent 0:(0,0)->(0,1)->(1,1)\n", "p.paths:1:23: error: found the blocked cell (1, 1), expected a free one"},
      {"Agent 0:(0,0)->(1,0)\n",
       "p.paths:1:16: error: found the end (1, 0) of the path of r0, expected its goal (3, 0)"},
      {first + "Agent 1:(3,2)->(3,1)->(3,0)->(2,0)->(1,0)->(0,0)\n",
       "p.paths:2:30: error: found r0 and r1 changing places at (2, 0) in step 3, expected paths that do not meet"},
      {first + "Agent 1:(3,2)->(3,1)->(3,0)->(3,0)->(2,0)->(1,0)->(0,0)\n",
       "p.paths:1:30: error: found r1 and r0 at (3, 0) in step 3, expected paths that do not meet"},
  };
  for (const auto& [text, message] : bad) EXPECT_EQ(ErrorOf("room.scen", text), message) << text;
}

TEST_F(GridsTest, PogemaStringsHaveStartsAndTargets) {
  folder_.Write("p.pogema", "\n  a..B\n  .##.  \n  @.$! b..A\n");
  EXPECT_EQ(ErrorOf("p.pogema"), "");
  const GridProblem problem = Read("p.pogema");
  EXPECT_EQ(problem.map.width, 4u);
  EXPECT_EQ(problem.map.height, 4u);
  ASSERT_THAT(problem.agents, SizeIs(2));
  EXPECT_EQ(problem.agents[0].name, "a");
  EXPECT_EQ(problem.agents[0].start, (GridCell{0, 0}));
  EXPECT_THAT(problem.agents[0].goals, ElementsAre(GridCell{3, 3}));
  EXPECT_FALSE(problem.map.IsFree({1, 1}));
  const std::pair<std::string, std::string> bad[] = {
      {"", "p.pogema: error: found a map of 0 x 0 cells, expected 1 to 16000000 cells"},
      {"..\n...\n", "p.pogema:2:3: error: found a row of 3 cells, expected 2 as in the first one"},
      {"aA\na.\n", "p.pogema:2:1: error: found 'a' for a second time, expected each start once"},
      {"a.\n", "p.pogema:1:1: error: found 'a' without 'A', expected a start and a target of each agent"},
      {".?\n", "p.pogema:1:2: error: found '?' for a cell, expected one of . # ! @ $ or a letter"},
  };
  for (const auto& [text, message] : bad) {
    folder_.Write("p.pogema", text);
    EXPECT_EQ(ErrorOf("p.pogema"), message) << text;
  }
}

TEST_F(GridsTest, TasksOfTheLeagueAreListsOfGoals) {
  folder_.Write("maps/room.map", kMap);
  folder_.Write("l.agents", "# version for LoRR 2026\n2\n0\n11\n");
  folder_.Write("l.tasks", "# version\n4\n3\n8\n1,2\n3,3,7\n");
  folder_.Write("l.json", R"({"mapFile": "maps/room.map", "agentFile": "l.agents", "taskFile": "l.tasks", "teamSize": 2,
    "agentCounter": 4, "delayConfig": {"minDelay": 2, "maxDelay": 8, "pDelay": 0.01}})");
  // Place 8 is water.
  EXPECT_EQ(ErrorOf("l.json"), "l.tasks:4:1: error: found the blocked cell (0, 2), expected a free one");
  folder_.Write("l.tasks", "# version\n4\n3\n9\n1,2\n3,3,7\n");
  const GridProblem problem = Read("l.json");
  ASSERT_THAT(problem.agents, SizeIs(2));
  EXPECT_EQ(problem.agents[1].start, (GridCell{3, 2}));
  ASSERT_THAT(problem.tasks, SizeIs(4));
  // The first task goes to the nearest of the free agents, the others to those that are free first.
  EXPECT_EQ(problem.tasks[0].agent, 1u);
  EXPECT_EQ(problem.tasks[1].agent, 0u);
  std::size_t places = 0;
  for (const GridTask& task : problem.tasks) places += task.goals.size();
  EXPECT_EQ(places, 7u);
  ASSERT_TRUE(problem.delays);
  EXPECT_DOUBLE_EQ(problem.delays->probability, 0.04);
  EXPECT_DOUBLE_EQ(problem.delays->max_seconds, 2.0);
  EXPECT_THAT(folder_.Load("l.json", WithGrid({})).world.lane_trips, SizeIs(2));
  folder_.Write("l.json", R"({"mapFile": "maps/room.map", "agentFile": "l.agents"})");
  EXPECT_EQ(ErrorOf("l.json"), "l.json:1:1: error: found no 'taskFile', expected the name of a file");
}

TEST_F(GridsTest, PathsOfTheLeagueAreActions) {
  folder_.Write("one.scen", "version 1\n0 room.map 4 3 0 0 3 0 3\n");
  GridOptions options;
  // Three ticks a move, and a wait in the middle of one.
  options.paths = folder_.Write(
      "p.json",
      R"({"agentMaxCounter": 3, "actualPaths": ["[(0,0,0,0,0):(F 2,W 4,F 1,F 3,R 3)][(13,0,2,1,0):(C 3,F 3)]"]})");
  const GridProblem segments = Read("one.scen", options);
  EXPECT_THAT(segments.agents[0].path, ElementsAre(GridCell{0, 0}, GridCell{1, 0}, GridCell{2, 0}, GridCell{3, 0}));
  EXPECT_THAT(segments.agents[0].steps, ElementsAre(0, 7, 10, 19));
  options.paths = folder_.Write("p.json", R"({"start": [[0, 0, "S"]], "actualPaths": ["C,F,W,F,F"]})");
  EXPECT_THAT(Read("one.scen", options).agents[0].steps, ElementsAre(0, 2, 4, 5));
  const std::pair<std::string, std::string> bad[] = {
      {"{}", "p.paths:1:1: error: found no list 'actualPaths', expected one as in an output of the League"},
      {R"({"actualPaths": []})", "p.paths:1:17: error: found 0 paths, expected one for each of 1 agent"},
      {R"({"start": [[0, 0, "E"]], "actualPaths": ["F,X"]})",
       "p.paths:1:42: error: found the action 'X', expected F, R, C or W"},
      {R"({"actualPaths": ["[(0,0):(F 1)]"]})",
       "p.paths:1:18: error: found '[(0,0):(F 1)]' in a path, expected '[(t,row,column,orientation,counter):(ACTION "
       "N,...)]'"},
      {R"({"start": [[0, 0, "N"]], "actualPaths": ["F"]})",
       "p.paths:1:42: error: found the place (-1, 0) outside of the map of 4 x 3 cells"},
  };
  for (const auto& [text, message] : bad) EXPECT_EQ(ErrorOf("one.scen", text), message) << text;
}

TEST_F(GridsTest, ProblemsForPlannersAreJson) {
  EXPECT_EQ(
      ProblemJson(Read("room.scen", {.agents = 1})),
      R"({"width":4,"height":3,"map":["....",".@@.","@..."],"agents":[{"name":"r0","start":[0,0],"goals":[[3,0]]}]})");
}

TEST(ParseMoveDelays, ReadsOneOrThreeNumbers) {
  EXPECT_EQ(ParseMoveDelays("0.25").value(), (MoveDelays{0.25, 1.0, 5.0}));
  EXPECT_EQ(ParseMoveDelays("0.1,0.5,2").value(), (MoveDelays{0.1, 0.5, 2.0}));
  for (const char* bad : {"", "x", "2", "-1", "0.1,1", "0.1,2,1", "0.1,1,2,3", "0.1,1,2,"}) {
    EXPECT_FALSE(ParseMoveDelays(bad).ok()) << bad;
  }
}

}  // namespace
}  // namespace troupe
