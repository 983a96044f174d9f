// Feeds any bytes to the reader of scenarios. The world that they may name is a small one in memory; no file is read.
#include "worldfile/scenario/scenario.h"

#include <string>

#include "fuzz/check.h"
#include "fuzz/targets.h"
#include "worldfile/stage/stage_world.h"

namespace troupe::fuzz {
namespace {

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
