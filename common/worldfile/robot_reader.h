// Reads what makes a `position` model a robot: drive, localization, controller. Private to this folder.
#pragma once

#include "common/worldfile/build_context.h"

namespace troupe {

DriveDescription ReadDrive(PropertyReader& reader);

// `X_WR` is where the robot starts; `robot` picks its random numbers.
LocalizationDescription ReadLocalization(PropertyReader& reader, const Pose& X_WR, RobotId robot, std::uint64_t seed);

// The controller that `ctrl` stands for; nothing if there is none, or none that is known.
std::optional<ControllerDescription> ReadController(PropertyReader& reader);

}  // namespace troupe
