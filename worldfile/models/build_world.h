// From a WorldTree to a world: gives every property its meaning, in SI units, with Stage's defaults.
//
// A node becomes a model by a fixed sequence: common properties, the body, the properties of its type, the warnings for
// the rest, its own parts; then its children. Models are numbered in the order of the file, parents before children, so
// that ids, random colours and drawn odometry errors are functions of the file and the seed. Descriptions with
// references to models further down (grippers, lifts, places of a controller) are added after the last model.
//
// Rule for faults: a file that Stage reads is read here, with a warning that quotes the odd value; an error is kept for
// what has no sensible reading. Every property is honoured or named in a warning, because a silent fault is hard to
// find.
//
// Robots and movable objects have no parent in the world: a parent is a rigid mount. Where the file puts them inside
// another model they are placed alone, and `placed_alone` keeps the parent of the file for code that moves the whole
// (place_spawns.h, edits).
//
// One thread per call; the images come from the disk or from ImageSource, within `allowed`.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "common/image/image_file.h"
#include "common/run/ros_lockstep.h"
#include "common/run/run_settings.h"
#include "troupe/named_expectation.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "worldfile/grids/grid_problem.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// LoadedWorld: the result of reading a file that names a world.
struct LoadedWorld {
  WorldDescription world;
  RunSettings settings;
  std::vector<Warning> warnings;            // in the order of the file
  std::vector<std::string> files;           // every file that was read
  std::map<ModelId, ModelId> placed_alone;  // models without a parent, with their parent in the file
  int map_width = 0;                        // pixels of the largest bitmap; 0 without one
  int map_height = 0;
  // The first ROS domain of a model whose spawn rule gives each robot one: that of the rule's first robot.
  std::optional<std::uint32_t> ros_domains_from = {};
  RosLockstep ros_lockstep = {};  // of a scenario
  std::vector<NamedRegion> regions = {};
  std::vector<NamedExpectation> expectations = {};
  std::shared_ptr<const Site> site = {};  // of a building; null for other files
};

// Settings of the program that loads a world.
struct LoadOverrides {
  std::optional<std::uint64_t> seed;
  std::optional<std::string> controller;  // for robots without one
  // Checks the name and the parameters of every controller that a file names; this library has no controllers. A fault
  // is an error of a scenario, and a warning of a Stage world. Nothing: they are not checked.
  std::function<Status(const std::string& name, const std::string& parameters)> check_controller;
  // Checks that the world has what the controllers of the robots need. Nothing: that is not checked.
  std::function<Status(const WorldDescription& world, std::span<const RobotId> robots)> check_in_world = {};
  AllowedPaths allowed = AllowedPaths::All();  // the files that may be read: the world, its includes, its images
  GridOptions grid = {};                       // of a file with cells; an error for others
  // Robots that are added to the world: FILE or FILE@X,Y[,HEADING] (worldfile/gazebo/added_robots.h).
  std::vector<std::string> robots = {};
};

struct BuildOptions {
  bool without_bitmaps = false;  // a bitmap is an error; for input that must not touch the disk
  ImageSource images = nullptr;  // of images that are not read from their files
  std::shared_ptr<KnownBitmaps> known_bitmaps = nullptr;  // of files that are not read again; null: none
};

// Every property of every node is either honoured or named in a warning with its place.
Result<LoadedWorld> BuildWorld(const WorldTree& tree, const LoadOverrides& overrides = {},
                               const BuildOptions& options = {});

// Of a world whose robots have their controllers: warns of narrow lanes, and adds waiting points to lanes of planned
// traffic.
void PrepareLanes(LoadedWorld& loaded, const std::string& file);

// The error of the first robot whose controller lacks something in the world, by the check of `overrides`.
Status CheckControllersInWorld(const LoadedWorld& loaded, const std::string& file, const LoadOverrides& overrides);

// Warnings about the places of things in the whole world of a file: starts inside other models, and the like.
void AppendPlacementWarnings(const std::string& file, LoadedWorld& loaded);

}  // namespace troupe
