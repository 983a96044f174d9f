// Loading worlds: any file that names a world, to a WorldDescription and the settings of a run.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/model/world_description.h"

namespace troupe {

enum class Mode : std::uint8_t { kLockstep, kRealtime };
enum class OnAgentLoss : std::uint8_t { kFreeze, kPause, kAbort };

// How to run a world; a scenario sets these, the command line overrides them.
struct RunSettings {
  std::optional<std::uint64_t> ticks;        // nothing: until stopped
  Mode mode = Mode::kLockstep;
  std::optional<double> speed;               // multiple of real time; nothing: as fast as possible
  OnAgentLoss on_agent_loss = OnAgentLoss::kFreeze;
  std::uint32_t robots_per_process = 1;
  double agent_deadline_seconds = 10.0;      // wall time that the barrier waits for a silent agent before it is lost
  bool ros = false;                          // show the robots to ROS 2
};

struct LoadedWorld {
  WorldDescription world;
  RunSettings settings;
  std::vector<Warning> warnings;             // in the order of the file
  std::vector<std::string> files;            // every file that was read
  std::map<ModelId, ModelId> placed_alone;   // models without a parent, and what the file has them below
  int map_width = 0;                         // pixels of the largest bitmap; 0 without one
  int map_height = 0;
};

// Things a command line can change before the description is built.
struct LoadOverrides {
  std::optional<std::uint64_t> seed;
  std::optional<std::string> controller;     // for robots without one
  // Asked about the name and the parameters of every controller that a scenario names: "" if they are good, else what is
  // wrong. Nothing: they are not checked. Which controllers there are is not for this library to know.
  std::function<std::string(const std::string& name, const std::string& parameters)> check_controller;
};

// Loads a Stage world (.world), a JSON scenario (.json) or a ROS map (.yaml), by the file's ending.
Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides = {});

}  // namespace troupe
