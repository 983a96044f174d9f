// `door`: a doorway with leaves that turn or slide: objects that only the door moves.
//
// The door itself has no body; its leaves are objects without a parent, so that robots collide with them and sensors
// see them like any moving thing, and the door (world-service/core) sets their poses by its opening from 0 to 1. Frame
// D: the middle of the doorway on the floor, x along it to the right, y to the back; a leaf has a frame H at its hinge.
// Lengths in m, angles in rad.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "worldfile/models/types/field_properties.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr double kLeastSeconds = 1e-3;  // of a door from closed to open
constexpr double kLeafGap = 0.01;       // m, between the widths of a leaf and of its part of the doorway

// A leaf in frame D of the doorway: at its middle on the floor, x along it to the right, y to the back.
struct LeafPlan {
  double hinge = 0.0;  // m, x of the origin of its frame H while it is closed
  Interval x;          // m, in H
  double turn = 0.0;   // rad, to open
  double shift = 0.0;  // m, to open
};

// Turns about its hinge at x = `hinge`; `width` is negative for one that extends to the left.
LeafPlan HingedLeaf(double hinge, double width, double turn) {
  const double near = std::copysign(0.5 * kLeafGap, width);
  const double far = std::copysign(std::max(std::fabs(width) - 0.5 * kLeafGap, kLeafGap), width);
  return {hinge, {std::min(near, far), std::max(near, far)}, turn, 0.0};
}

LeafPlan SlidingLeaf(double middle, double width, double shift) {
  const double half = 0.5 * std::max(width - kLeafGap, kLeafGap);
  return {middle, {-half, half}, 0.0, shift};
}

class DoorReader : public ModelReader {
 public:
  Shape ReadShape(PropertyReader& /*reader*/, const ModelDraft& /*draft*/, BuildContext& /*context*/) override {
    return {};
  }

  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    DoorDraft door = draft.node.DraftOf<DoorDraft>();
    const auto has = [&](const char* property) { return reader.node().Find(property) != nullptr; };
    if (has("kind")) door.kind = reader.Choice<DoorKind>("kind");
    if (has("side")) door.at_left = reader.Choice<DoorSide>("side") == DoorSide::kLeft;
    if (has("swing"))
      door.swing = reader.units().Angle(reader.Number("swing", reader.units().degrees ? 90.0 : 0.5 * kPi));
    const bool is_double = door.kind == DoorKind::kDoubleHinged || door.kind == DoorKind::kDoubleSliding;
    const bool is_hinged = door.kind == DoorKind::kHinged || door.kind == DoorKind::kDoubleHinged;
    const bool at_left = door.at_left;
    const double swing = door.swing;
    const double ratio = reader.Number("ratio", door.ratio, 1e-3, 1e3);
    const double width = draft.size.x;
    const double right = is_double ? ratio / (1.0 + ratio) * width : width;
    const double left = width - right;
    if (is_hinged) {
      if (is_double) {
        leaves_ = {HingedLeaf(0.5 * width, -right, -swing), HingedLeaf(-0.5 * width, left, swing)};
      } else {
        leaves_ = {at_left ? HingedLeaf(-0.5 * width, width, swing) : HingedLeaf(0.5 * width, -width, -swing)};
      }
    } else if (is_double) {
      leaves_ = {SlidingLeaf(0.5 * (width - right), right, right), SlidingLeaf(0.5 * (left - width), left, -left)};
    } else {
      leaves_ = {SlidingLeaf(0.0, width, at_left ? -width : width)};
    }
    if (door.speed > 0.0) {
      double way = 0.0;  // m or rad, of the leaf that has most of it
      for (const LeafPlan& leaf : leaves_) way = std::max({way, std::fabs(leaf.turn), std::fabs(leaf.shift)});
      door_.seconds = std::max(way / door.speed, kLeastSeconds);
    }
    door_.opening = door.opening;
    door_.is_operated = door.is_operated;
    ReadFields(reader, door_);
    if (door_.sensor_depth > 0.0 && door_.sensor_width == 0.0) door_.sensor_width = width;
    if (door_.sensor_width > 0.0 && door_.sensor_depth == 0.0) {
      context.diagnostics.Fail(reader.Where("sensor_width"),
                               "found a 'sensor_width' alone, expected a 'sensor_depth' above 0, too");
    }
    if (draft.robot || draft.model.gripper_return) {
      context.diagnostics.Fail(
          draft.node.where, "found a 'door' on a robot, or that can be gripped, expected one at a place of the world");
    } else if (!(width > 2.0 * kLeafGap) || !(draft.size.y > 0.0) || !(draft.size.z > 0.0)) {
      context.diagnostics.Fail(
          reader.Where("size"),
          "found a 'door' without extent, expected a width of at least 0.02 m, a thickness and a height");
    } else if (std::fabs(swing) > 2.0 * kPi) {
      context.diagnostics.Fail(reader.Where("swing"),
                               "found a 'door' that turns by more than 360 degrees, expected less");
    }
  }

  void AddParts(const ModelDraft& draft, BuildContext& context) override {
    if (context.diagnostics.failed()) return;
    door_.model = draft.id;
    for (std::size_t i = 0; i < leaves_.size(); ++i) AddLeaf(leaves_[i], i == 0 ? "right" : "left", draft, context);
    context.world.doors.push_back(std::move(door_));
  }

 private:
  void AddLeaf(const LeafPlan& plan, const std::string& name, const ModelDraft& draft, BuildContext& context) {
    const Pose X_WD = draft.X_WM * draft.X_MD;
    const double half = 0.5 * draft.size.y;
    const DoorLeaf leaf{ObjectId(context.world.objects.size()), X_WD * Pose{plan.hinge, 0.0, 0.0, 0.0}, plan.turn,
                        plan.shift};
    ModelDescription model = draft.model;
    model.name = draft.model.name + "." + name;
    model.type = "door_leaf";
    model.parent.reset();
    // By the function that the state of tick 0 uses, too (PlacedState).
    model.X_PM = leaf.X_WH_at(door_.opening);
    model.size_x = plan.x.max - plan.x.min;
    model.shape = context.shapes.Add({.blocks = {BoxBlock({plan.x.min, -half, plan.x.max, half}, {0.0, draft.size.z})},
                                      .rectangles = {},
                                      .rectangles_z = {}});
    // A leaf is a copy of the door's model for its look: stores of energy and fiducials would be there twice.
    model.power = {};
    model.fiducial_return = 0;
    const ModelId id(context.world.models.size());
    context.names.AddPart(draft.node.where, model.name, context.diagnostics);
    context.world.models.push_back(std::move(model));
    context.world.objects.push_back(id);
    door_.leaves.push_back(leaf);
  }

  std::vector<LeafPlan> leaves_;
  DoorDescription door_;
};

}  // namespace

ModelType DoorType() {
  ModelType type;
  type.name = "door";
  type.has_body = false;
  type.size = {1.0, 0.04, 2.0};
  type.color = {0.8, 0.52, 0.25, 1.0};
  type.make_reader = MakeReader<DoorReader>;
  return type;
}

}  // namespace troupe
