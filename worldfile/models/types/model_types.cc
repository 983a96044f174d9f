#include "worldfile/models/types/model_types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// In the order in which messages list them.
const auto& ModelTypes() {
  // Made at the first use: before main the order of initialization across files is not defined.
  static const std::array types{
      PlainModelType(), PositionType(), RangerType(),         ActuatorType(), BlinkenlightType(), BlobfinderType(),
      BumperType(),     CameraType(),   ContactType(),        DoorType(),     FiducialType(),     GripperType(),
      ImuType(),        LiftType(),     LightIndicatorType(), RadioType(),
  };
  return types;
}

// Types of older versions of Stage, and what they are made of today.
struct FormerType {
  std::string_view name;
  std::string_view today;
};
constexpr FormerType kFormerTypes[] = {
    {"audio", "a 'radio'"},
    {"charger", "a 'model' with 'give_watts'"},
    {"fiducialfinder", "a 'fiducial'"},
    {"laser", "a 'ranger' with a 'sensor ( range [min max] fov degrees samples number )'"},
    {"laserbeacon", "a 'model' with 'fiducial_return'"},
    {"map", "a 'model' with a 'bitmap'"},
    {"omnicam", "a 'blobfinder' or a 'camera'"},
    {"ptz", "a 'camera'"},
    {"puck", "a 'model' with 'gripper_return 1'"},
    {"sonar", "a 'ranger' with a 'sensor ( ... )' for each transducer"},
    {"speech", "a 'radio'"},
    {"wifi", "a 'radio'"},
};

constexpr std::size_t kMaxListed = 40;  // names in a message

// " (chair, scout)"; "" without a name.
std::string ListText(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxListed); ++i) text += (i == 0 ? " (" : ", ") + names[i];
  if (names.size() > kMaxListed) text += " and " + std::to_string(names.size() - kMaxListed) + " more";
  return text.empty() ? "" : text + ")";
}

// `blinkenlight`: a light that blinks. `lightindicator`: a light that a controller switches.

class BlinkenlightReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& /*context*/) override {
    const double period_ms = reader.Number("period", 1000.0, 1e-3, 1e6);
    const double duty_cycle = reader.Number("dutycycle", 1.0, 0.0, 1.0);
    const bool enabled = reader.Flag("enabled", true);
    Blinking& blinking = draft.model.blinking;
    blinking.period_ns = std::llround(period_ms * 1e6);
    blinking.on_ns = std::llround(period_ms * duty_cycle * 1e6);
    blinking.is_switched_on = enabled;
  }
};

class LightIndicatorReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& /*reader*/, ModelDraft& draft, BuildContext& /*context*/) override {
    // On for the whole period: whether it is lit is the controller's switch alone.
    constexpr std::int64_t kAnyPeriod = 1'000'000'000;  // ns
    draft.model.blinking = {kAnyPeriod, kAnyPeriod, false};
  }
};

}  // namespace

const ModelType* FindModelType(std::string_view name) {
  const auto& types = ModelTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const ModelType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

std::string UnknownTypeMessage(const std::string& type, const std::map<std::string, Define>& defines) {
  const auto former = std::find_if(std::begin(kFormerTypes), std::end(kFormerTypes),
                                   [&](const FormerType& entry) { return entry.name == type; });
  const std::string hint = former != std::end(kFormerTypes)
                               ? ", which Stage 4 no longer has; today it is " + std::string(former->today)
                               : std::string();
  std::vector<std::string> names;
  for (const auto& [name, define] : defines) names.push_back(name);
  std::string message =
      "found model type " + Quoted(type) + hint + ", expected the name of a define" + ListText(names) + ", or one of";
  for (const ModelType& known : ModelTypes()) {
    message += " " + std::string(known.name);
    names.emplace_back(known.name);
  }
  return message + DidYouMean(type, names);
}

Shape ModelReader::ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) {
  if (draft.map) return RosMapShape(reader, *draft.map, draft.size, draft.X_MD);
  if (const auto* const body = std::get_if<BodyDraft>(draft.node.draft.get()); draft.node.draft && body != nullptr) {
    reader.Use("noblocks");
    Shape shape;
    shape.blocks = body->blocks;
    return Moved(std::move(shape), draft.X_MD);
  }
  return ReadModelShape(reader, draft.type.has_body, draft.size, draft.X_MD, context);
}

void ModelReader::ReadProperties(PropertyReader&, ModelDraft&, BuildContext&) {}

void ModelReader::AddParts(const ModelDraft&, BuildContext&) {}

void ModelReader::Complete(BuildContext&) {}

std::string NameOnRobot(const WorldDescription& world, RobotId robot, const std::string& name) {
  const std::string prefix = world.robot(robot).name + ".";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

ModelType PlainModelType() {
  return {.name = "model"};
}

ModelType BlinkenlightType() {
  return {.name = "blinkenlight",
          .size = {0.02, 0.02, 0.02},
          .color = {0.0, 1.0, 0.0, 1.0},
          .make_reader = MakeReader<BlinkenlightReader>};
}

ModelType LightIndicatorType() {
  return {.name = "lightindicator", .make_reader = MakeReader<LightIndicatorReader>};
}

}  // namespace troupe
