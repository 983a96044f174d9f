// Loading worlds: any file that names a world, to a WorldDescription and the settings of a run.
//
// The one entrance for programs; everything else in this folder is behind it. The ending of a file decides on its
// language, but for layouts, which are JSON like scenarios (IsLayoutPath). Equal files and overrides give equal worlds.
// Warnings are returned, not printed; errors have a place. Files are read within `overrides.allowed`, also all that
// they include. Any thread; a large map takes seconds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/models/build_world.h"

namespace troupe {

// Loads a Stage world (.world), a JSON scenario (.json), a building of Open-RMF (.building.yaml), a ROS map (.yaml), or
// a world, model or robot of Gazebo and ROS (.sdf, .world, .urdf, .xacro), by the file's ending; a .world that begins
// with XML is Gazebo's.
Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides = {});

// Whether the file is a world in a format that other tools write: Gazebo, Open-RMF, LIF, ROS maps, cells.
bool IsForeignWorld(const std::string& path);

// The file of a world, or the text of a scenario.
struct WorldSource {
  std::string path;
  std::optional<std::string> scenario = {};  // in place of the content of the file; `path` is then for messages
};
Result<LoadedWorld> LoadWorld(const WorldSource& source, const LoadOverrides& overrides = {});

// Models that can be added to a running world: models of its world file, and files with one model.

// A type or define that gives a model.
struct Spawnable {
  std::string name;
  std::string type;  // the base type of the define; the name itself for a type
};

// The robots and plain models that `world_file` and its includes define, by name; and the types of these two.
Result<std::vector<Spawnable>> ListSpawnables(const std::string& world_file, const LoadOverrides& overrides = {});

// A world with only the model to be spawned. `world`: where its models are defined. `source`: a name as above, a file
// (.world, .inc, .json, .sdf, .urdf) that has one model with its parts, or "FILE#NAME": a model that this file defines.
// Robots have the controller that they would have in the world file.
Result<LoadedWorld> LoadSpawnable(const WorldSource& world, const std::string& source,
                                  const LoadOverrides& overrides = {});

// Gives the robots of a spawned world another controller. The error is one that `overrides` refuse, or a world without
// robots.
Status SetController(const ControllerDescription& controller, const LoadOverrides& overrides,
                     WorldDescription& spawned);

}  // namespace troupe
