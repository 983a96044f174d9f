#include "common/worldfile/build/types/model_types.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "common/worldfile/build/types/built_in_types.h"
#include "common/worldfile/text/quote.h"

namespace troupe {
namespace {

// In the order in which messages list them.
const auto& ModelTypes() {
  static const std::array types{
      PlainModelType(), PositionType(), RangerType(),   ActuatorType(), BlinkenlightType(),   BlobfinderType(),
      BumperType(),     CameraType(),   FiducialType(), GripperType(),  LightIndicatorType(),
  };
  return types;
}

// Types of older versions of Stage.
constexpr std::string_view kFormerTypes[] = {"charger", "laser", "map", "puck", "sonar", "wifi"};

}  // namespace

const ModelType* FindModelType(std::string_view name) {
  const auto& types = ModelTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const ModelType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

std::string UnknownTypeMessage(const std::string& type) {
  const bool former = std::find(std::begin(kFormerTypes), std::end(kFormerTypes), type) != std::end(kFormerTypes);
  std::string message = "found model type " + Quoted(type) + (former ? ", which Stage 4 no longer has" : "") +
                        ", expected the name of a define, or one of";
  for (const ModelType& known : ModelTypes()) message += " " + std::string(known.name);
  return message;
}

}  // namespace troupe
