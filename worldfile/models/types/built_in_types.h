// The model types, each defined in a file of its own, or beside its relatives. Private to this
// folder.
#pragma once

#include "worldfile/models/types/model_type.h"

namespace troupe {

ModelType ActuatorType();
ModelType BlinkenlightType();
ModelType BlobfinderType();
ModelType BumperType();
ModelType CameraType();
ModelType ContactType();
ModelType FiducialType();
ModelType GripperType();
ModelType ImuType();
ModelType LightIndicatorType();
ModelType PositionType();
ModelType RadioType();
ModelType RangerType();

// Bodies, without properties of their own.
ModelType PlainModelType();

}  // namespace troupe
