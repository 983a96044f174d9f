// Feeds any bytes to the reader of Stage worlds. Includes find a few files in memory; no file is read.
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "fuzz/checks.h"
#include "fuzz/targets.h"
#include "worldfile/models/build_world.h"
#include "worldfile/plans/floor_plan.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/sites/building_yaml.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/route_graph.h"
#include "worldfile/sites/site_tree.h"
#include "worldfile/stage/stage_world.h"

namespace troupe::fuzz {
namespace {

const std::map<std::string, std::string>& MemoryFiles() {
  static const auto* const files = new std::map<std::string, std::string>{
      {"a.inc", "define bot position( eye( ) )\ndefine eye ranger( sensor( samples 3 ) )\n"},
      {"b.inc", "include \"a.inc\"\ncolor \"blue\""},
      {"c.inc", "include \"c.inc\"\n"},
      {"d.inc", "model(\n"},
  };
  return *files;
}

// Feeds any bytes to the reader of scenarios. The world that they may name is a small one in memory; no file is read.

constexpr char kWorld[] = R"(
define room model ( size [ 8 8 1 ] boundary 1 noblocks 1 )
define crate model ( size [ 0.5 0.5 0.5 ] gripper_return 1 )
define eye ranger ( sensor ( range [ 0 5 ] fov 180 samples 9 ) )
define bot position ( size [ 0.4 0.4 0.3 ] eye ( pose [ 0 0 -0.1 0 ] ) )
room ( name "room" )
crate ( name "crate" pose [ 1 1 0 30 ] )
bot ( name "r0" ctrl "wander" )
bot ( pose [ -2 0 0 0 ] )
)";

ScenarioTools MakeTools() {
  ScenarioTools tools;
  tools.read_world = [world = ParseStageText(kWorld, "fuzz/w.world")](const std::string&, const AllowedPaths&) {
    return world;
  };
  tools.build.without_bitmaps = true;
  tools.max_spawned = 20;
  tools.max_spawn_draws = 50;
  return tools;
}

}  // namespace

void CheckError(const Error& error) {
  Check(!error.message.empty() && !error.where.file.empty());
  Check(error.message.find('\n') == std::string::npos);
}

void CheckMessage(const SourceLocation& where, const std::string& message) {
  CheckError({where, message});
  Check(where.line >= 1 && where.column >= 1);
}

void CheckBuilt(const WorldTree& tree, bool has_places) {
  const auto check = [has_places](const SourceLocation& where, const std::string& message) {
    has_places ? CheckMessage(where, message) : CheckError({where, message});
  };
  BuildOptions build;
  build.without_bitmaps = true;
  const Result<LoadedWorld> loaded = BuildWorld(tree, {}, build);
  if (!loaded.ok()) return check(loaded.error().where, loaded.error().message);
  for (const Warning& warning : loaded.value().warnings) check(warning.where, warning.message);
  Check(Validate(loaded.value().world).ok());  // a loaded world is valid
}

void World(Bytes bytes) {
  ParseOptions parse;
  parse.memory_files = &MemoryFiles();
  parse.max_items = 500;
  const Result<WorldTree> tree = ParseStageText(TextOf(bytes), "w.world", parse);
  if (!tree.ok()) return CheckMessage(tree.error().where, tree.error().message);
  CheckBuilt(tree.value());
}

namespace {

void CheckSite(Result<Site> site) {
  if (!site.ok()) return CheckMessage(site.error().where, site.error().message);
  const Result<WorldTree> tree = SiteTree(std::make_shared<const Site>(std::move(site).value()));
  if (!tree.ok()) return CheckMessage(tree.error().where, tree.error().message);
  CheckBuilt(tree.value());
}

}  // namespace

// Feeds any bytes to the readers of buildings and layouts.
void Building(Bytes bytes) {
  CheckSite(ReadBuildingText(TextOf(bytes), "fuzz/s.building.yaml"));
}

void Layout(Bytes bytes) {
  CheckSite(ReadLayoutText(TextOf(bytes), "fuzz/s.lif.json"));
}

void RouteGraph(Bytes bytes) {
  CheckSite(ReadRouteGraphText(TextOf(bytes), "fuzz/g.geojson"));
}

// Feeds any bytes to the readers of floor plans. The walls that come of a drawing are a valid world.
void FloorPlan(Bytes bytes) {
  const std::string text = TextOf(bytes);
  const Result<troupe::FloorPlan> plan =
      text.starts_with('<') ? ReadSvgPlan(text, "fuzz/p.svg", 0.001) : ReadDxfPlan(text, "fuzz/p.dxf", 0.001);
  if (!plan.ok()) return CheckMessage(plan.error().where, plan.error().message);
  for (const Warning& warning : plan.value().warnings) CheckMessage(warning.where, warning.message);
  std::size_t lines = 0;
  for (const PlanLayer& layer : plan.value().layers) lines += layer.lines.size();
  if (lines > 200) return;  // a world of them takes too long for an execution
  const Result<std::string> world = PlanWorldText(plan.value(), {}, "p.dxf");
  if (!world.ok()) return Check(!world.error().message.empty());
  const Result<WorldTree> tree = ParseStageText(world.value(), "w.world");
  Check(tree.ok());
  CheckBuilt(tree.value());
}

void Scenario(Bytes bytes) {
  static const ScenarioTools tools = MakeTools();
  const Result<LoadedWorld> loaded = LoadScenarioText(TextOf(bytes), "fuzz/scenario.json", {}, tools);
  if (loaded.ok()) {
    Check(Validate(loaded.value().world).ok());  // a loaded world is valid
  } else {
    Check(!loaded.error().message.empty() && !loaded.error().where.file.empty());
  }
}

}  // namespace troupe::fuzz
