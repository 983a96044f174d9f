// `gripper`: two fingers that close on an object: paddles of its own, or models that the file names.
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/gripper_builder.h"
#include "worldfile/models/types/gripper_settings.h"

namespace troupe {
namespace {

class GripperReader : public ModelReader {
 public:
  Shape ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) override {
    settings_ = ReadSettings(reader, draft, context.world);
    if (!settings_ || draft.map) return ModelReader::ReadShape(reader, draft, context);
    // Without paddles the blocks are all of its body.
    if (!settings_->paddles) return ReadModelShape(reader, false, draft.size, draft.X_MD, context);
    const PaddleSettings& paddles = *settings_->paddles;
    const bool has_back = paddles.size.x < draft.size.x;
    return ReadModelShape(reader, has_back, BackSize(draft.size, paddles), BackPose(draft.X_MD, paddles), context);
  }

  void AddParts(const ModelDraft& draft, BuildContext& context) override {
    if (!settings_) return;
    gripper_ = GripperDraft{draft.node.where, draft.id, *draft.robot, std::move(*settings_), std::nullopt};
    if (!gripper_->settings.paddles) return;
    gripper_->own = AddPaddles(*gripper_->settings.paddles, draft.size, draft.X_MD, gripper_->where, draft.id,
                               *draft.robot, context);
    for (const ModelId part : gripper_->own->models) {
      context.names.AddPart(draft.node.where, context.world.model(part).name, context.diagnostics);
    }
  }

  void Complete(BuildContext& context) override {
    if (gripper_) GripperBuilder(context).Describe(*gripper_);
  }

 private:
  // Nothing for a gripper on no robot, which is only a body.
  static std::optional<GripperSettings> ReadSettings(PropertyReader& reader, const ModelDraft& draft,
                                                     const WorldDescription& world) {
    const double base = draft.robot ? world.model(world.robot(*draft.robot).root).X_PM.z : draft.X_WM.z;
    const GripperSettings settings = ReadGripper(reader, draft.size, draft.X_WM.z - base);
    if (draft.robot) return settings;
    reader.diagnostics().Warn(draft.node.where, "this gripper is on no robot, so it is only a body");
    return std::nullopt;
  }

  std::optional<GripperSettings> settings_;
  std::optional<GripperDraft> gripper_;
};

}  // namespace

ModelType GripperType() {
  return {.name = "gripper", .size = {0.2, 0.3, 0.2}, .make_reader = MakeReader<GripperReader>};
}

}  // namespace troupe
