#include "worldfile/models/types/model_type.h"

namespace troupe {

Shape ModelReader::ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) {
  if (draft.map) return RosMapShape(reader, *draft.map, draft.size, draft.X_MD);
  return ReadModelShape(reader, draft.type.has_body, draft.size, draft.X_MD, context);
}

void ModelReader::ReadProperties(PropertyReader&, ModelDraft&, BuildContext&) {}

void ModelReader::AddParts(const ModelDraft&, BuildContext&) {}

void ModelReader::Complete(BuildContext&) {}

std::string NameOnRobot(const WorldDescription& world, RobotId robot, const std::string& name) {
  const std::string prefix = world.robot(robot).name + ".";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

}  // namespace troupe
