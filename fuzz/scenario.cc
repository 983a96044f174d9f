// Feeds any bytes to the reader of scenarios. The world that they may name is a small one in memory; no file is read.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/worldfile/scenario/scenario.h"
#include "common/worldfile/stage/stage_parser.h"

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

troupe::ScenarioTools MakeTools() {
  troupe::ScenarioTools tools;
  tools.read_world = [world = troupe::ParseStageText(kWorld, "fuzz/w.world")](
                         const std::string&, const troupe::AllowedPaths&) { return world; };
  tools.build.without_bitmaps = true;
  tools.max_spawned = 20;
  tools.max_spawn_draws = 50;
  return tools;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const troupe::ScenarioTools tools = MakeTools();
  const std::string text(reinterpret_cast<const char*>(data), size);
  const troupe::Result<troupe::LoadedWorld> loaded = troupe::LoadScenarioText(text, "fuzz/scenario.json", {}, tools);
  if (loaded.ok()) {
    if (!troupe::Validate(loaded.value().world).ok()) __builtin_trap();  // a loaded world is valid
  } else if (loaded.error().message.empty() || loaded.error().where.file.empty()) {
    __builtin_trap();  // every error has a message and a place
  }
  return 0;
}
