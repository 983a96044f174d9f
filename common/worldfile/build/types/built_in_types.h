// The model types, each defined in a file of its own; the ones without a reader are in body_types.cc. Private to this
// folder.
#pragma once

#include "common/worldfile/build/types/model_type.h"

namespace troupe {

ModelType ActuatorType();
ModelType GripperType();
ModelType PositionType();
ModelType RangerType();

// Bodies, without properties of their own.
ModelType PlainModelType();

// Bodies, too: Stage's other types are not simulated yet.
ModelType BlinkenlightType();
ModelType BlobfinderType();
ModelType BumperType();
ModelType CameraType();
ModelType FiducialType();
ModelType LightIndicatorType();

}  // namespace troupe
