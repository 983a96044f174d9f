// Controllers by name: a built-in one ("wander"), the path of a shared library (it contains a slash or ends in ".so"),
// or a class in Python ("patrol.py:Patrol"), which runs in the package troupe for Python
// (python/native/controller_host.cc): that library, and the interpreter, are opened only for such a controller.
//
// A library runs in the process of its agent with all of the agent's rights, so that only libraries that the owner of
// the run has allowed are opened (AllowedPaths), whatever a world file or a peer asks for. A library stays open until
// the program ends, because objects of its types may live as long.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/controller.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

class Manipulator;
class Scene;

// Names of the built-in controllers, sorted.
std::vector<std::string> BuiltInControllers();

// The error names the controller: its name is unknown, its parameters are wrong, or its library cannot be used or is
// not among the `libraries`.
Result<std::unique_ptr<Controller>> CreateController(const RobotInfo& info, const AllowedPaths& libraries = {});

// Checks name and parameters without making a controller; a library is not opened.
Status CheckController(const std::string& name, const std::string& parameters);

// The part of a controller's information that follows from the description alone: without sensors, and without the
// places of doors and lifts. `manipulator`, `lights`: of the robot. The world outlives the result.
RobotInfo InfoInWorld(const WorldDescription& world, RobotId robot, const Manipulator& manipulator,
                      std::span<const LightPlace> lights);

// Checks that each robot and the world have the parts that the controller of the robot needs, as joints, lanes and
// places. The error names the robot and the controller.
Status CheckControllerNeeds(const WorldDescription& world, std::span<const RobotId> robots);

// Checks that the built-in controller of the robot knows a way to the goal from its pose: along lanes, or on its level
// around static bodies. Success for a library, which alone knows. The error is the reason.
Status CheckGoalOfController(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal);

}  // namespace troupe
