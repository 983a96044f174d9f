#include "common/worldfile/build/types/built_in_types.h"

namespace troupe {

ModelType PlainModelType() {
  return {.name = "model"};
}

ModelType BlinkenlightType() {
  return {.name = "blinkenlight", .size = {0.02, 0.02, 0.02}, .color = {0.0, 1.0, 0.0, 1.0}, .is_simulated = false};
}

ModelType BlobfinderType() {
  return {.name = "blobfinder", .has_body = false, .is_simulated = false};
}

ModelType BumperType() {
  return {.name = "bumper", .is_simulated = false};
}

ModelType CameraType() {
  return {.name = "camera", .size = {0.1, 0.07, 0.05}, .color = {0.0, 0.0, 0.0, 1.0}, .is_simulated = false};
}

ModelType FiducialType() {
  return {.name = "fiducial", .has_body = false, .size = {0.0, 0.0, 0.0}, .is_simulated = false};
}

ModelType LightIndicatorType() {
  return {.name = "lightindicator", .is_simulated = false};
}

}  // namespace troupe
