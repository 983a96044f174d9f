// A small world to try a model in: a room with the model, and with a plain robot that drives towards it if the model is
// none itself.
#pragma once

#include <string>

#include "troupe/result.h"
#include "viewer/editor/editable_world.h"
#include "worldfile/models/loaded_world.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

inline constexpr const char* kProbe = "probe";  // name of the plain robot

// `tree`: that defines the model. `probe_height`: m, of the plain robot.
Result<LoadedWorld> MakeTestWorld(const WorldTree& tree, const std::string& model, double probe_height,
                                  const NamedFiles& files);

}  // namespace troupe
