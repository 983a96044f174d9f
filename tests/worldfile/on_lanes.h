// Buildings whose robots drive along lanes.
#pragma once

#include <string>

#include "robot-agent/controller/create_controller.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "worldfile/load_world.h"

namespace troupe {

// A robot with parameters of `lanes`, as an entry of a scenario.
inline std::string OnLanes(const std::string& name, const std::string& parameters) {
  return R"({"name": ")" + name + R"(", "controller": {"name": "lanes", "parameters": )" + parameters + "}}";
}

// The building with such robots.
inline WorldDescription LoadOnLanes(const test::TemporaryFolder& folder, const std::string& building,
                                    const std::string& robots) {
  folder.Write("s.building.yaml", building);
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  return test::ValueOf(LoadWorld(folder.Write("s.json", R"({"world": "s.building.yaml", "robots": [)" + robots + "]}"),
                                 overrides))
      .world;
}

}  // namespace troupe
