#include "worldfile/models/types/model_types.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "common/base/closest_name.h"
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

// In the order in which messages list them.
const auto& ModelTypes() {
  static const std::array types{
      PlainModelType(), PositionType(), RangerType(),         ActuatorType(), BlinkenlightType(),
      BlobfinderType(), BumperType(),   CameraType(),         ContactType(),  FiducialType(),
      GripperType(),    ImuType(),      LightIndicatorType(), RadioType(),
  };
  return types;
}

// Types of older versions of Stage.
constexpr std::string_view kFormerTypes[] = {"charger", "laser", "map", "puck", "sonar", "wifi"};

constexpr std::size_t kMostListed = 40;  // names in a message

// " (chair, scout)"; "" without a name.
std::string ListText(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostListed); ++i) text += (i == 0 ? " (" : ", ") + names[i];
  if (names.size() > kMostListed) text += " and " + std::to_string(names.size() - kMostListed) + " more";
  return text.empty() ? "" : text + ")";
}

}  // namespace

const ModelType* FindModelType(std::string_view name) {
  const auto& types = ModelTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const ModelType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

std::string UnknownTypeMessage(const std::string& type, const std::map<std::string, Define>& defines) {
  const bool former = std::find(std::begin(kFormerTypes), std::end(kFormerTypes), type) != std::end(kFormerTypes);
  std::vector<std::string> names;
  for (const auto& [name, define] : defines) names.push_back(name);
  std::string message = "found model type " + Quoted(type) + (former ? ", which Stage 4 no longer has" : "") +
                        ", expected the name of a define" + ListText(names) + ", or one of";
  for (const ModelType& known : ModelTypes()) {
    message += " " + std::string(known.name);
    names.emplace_back(known.name);
  }
  return message + DidYouMean(type, names);
}

}  // namespace troupe
