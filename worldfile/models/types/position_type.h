// The controllers that Stage's worlds name in `ctrl`, with the arguments after the name: their names and parameters
// here.
//
// A controller of Stage is a library with arguments in a text; here it is a name with JSON parameters. The table of
// names is a mapping, not a list of this program's controllers: a world for Stage must load with whatever controllers
// are built in, so that unknown names and refused arguments are warnings.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// A controller under the name that `ctrl` has for it.
struct StageControllerName {
  const char* stage_name;
  const char* name;
  std::vector<const char*> arguments;  // parameters, in the order of arguments without a name
  const char* rest = nullptr;          // the parameter that is a list of all further ones, as texts
};
std::span<const StageControllerName> StageControllerNames();

// `text`: "wander", "wander 0.5 1.2" or "wander speed=0.5". An argument with a '=' is a parameter by its name, with a
// JSON value; the others are the parameters that docs/controllers.md lists for that name, in order. Nothing for a name
// that is not known. What follows the name means in Stage whatever a library makes of it, so it never refuses a world:
// arguments that `check` (LoadOverrides) refuses are left out, with a warning.
using ControllerCheck = std::function<Status(const std::string& name, const std::string& parameters)>;
std::optional<StageController> ReadStageController(const std::string& text, const ControllerCheck& check);

// Gives a robot that carries units (fasr, fasr_plan) the places of the models "source" and "sink", unless its
// parameters say others. `X_EW`: the world in the frame of the robot's estimate.
void AddPlaces(const WorldDescription& world, const Pose& X_EW, ControllerDescription& controller);

}  // namespace troupe
