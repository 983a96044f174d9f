#include "worldfile/models/types/break_beams.h"

#include <algorithm>
#include <map>

#include "common/model/model_poses.h"

namespace troupe {
namespace {

// The box around a pad of an open gripper, frame G.
struct PadBox {
  Rectangle area = Rectangle::Nothing();
  ZRange z;
};

class BeamMaker {
 public:
  BeamMaker(const WorldDescription& world, const GripperDescription& gripper) : world_(world), gripper_(gripper) {
    for (const JointDescription& joint : world.joints) joints_.emplace(joint.model, &joint);
  }

  PadBox BoxOf(ModelId pad) const {
    Pose X_GM;
    for (ModelId at = pad; at != gripper_.model; at = *world_.model(at).parent) {
      Pose X_PM = world_.model(at).X_PM;
      if (const auto found = joints_.find(at); found != joints_.end()) {
        const bool is_finger = at == world_.joint(gripper_.left).model || at == world_.joint(gripper_.right).model;
        X_PM = X_PM * JointMotion(*found->second, is_finger ? found->second->position.min : found->second->start);
      }
      X_GM = X_PM * X_GM;
    }
    const Transform2 move(X_GM);
    const Shape& shape = world_.shape(world_.model(pad).shape);
    PadBox box;
    bool is_first = true;
    const auto extend = [&](const Polygon& outline, const ZRange& z) {
      for (const Vec2& corner : outline) box.area.Extend(move * corner);
      const ZRange z_G = z + X_GM.z;
      box.z = is_first ? z_G : ZRange{std::min(box.z.min, z_G.min), std::max(box.z.max, z_G.max)};
      is_first = false;
    };
    for (const Block& block : shape.blocks) extend(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) {
      extend({{r.min_x, r.min_y}, {r.max_x, r.min_y}, {r.max_x, r.max_y}, {r.min_x, r.max_y}}, shape.rectangles_z);
    }
    return box;
  }

 private:
  const WorldDescription& world_;
  const GripperDescription& gripper_;
  std::map<ModelId, const JointDescription*> joints_;
};

double Middle(double min, double max) {
  return 0.5 * (min + max);
}

// Between two intervals: from where `a` ends towards `b`, to where `b` ends towards `a`.
struct Gap {
  double from = 0.0;
  double to = 0.0;
  double width = 0.0;  // negative where they overlap
};

Gap GapBetween(const Interval& a, const Interval& b) {
  if (Middle(a.min, a.max) > Middle(b.min, b.max)) return {a.min, b.max, a.min - b.max};
  return {a.max, b.min, b.min - a.max};
}

}  // namespace

std::vector<BreakBeam> BreakBeamsOf(const WorldDescription& world, const GripperDescription& gripper) {
  const BeamMaker maker(world, gripper);
  const PadBox left = maker.BoxOf(gripper.left_pad);
  const PadBox right = maker.BoxOf(gripper.right_pad);
  const Gap gap_x = GapBetween({left.area.min_x, left.area.max_x}, {right.area.min_x, right.area.max_x});
  const Gap gap_y = GapBetween({left.area.min_y, left.area.max_y}, {right.area.min_y, right.area.max_y});
  const double z = Middle(std::max(left.z.min, right.z.min), std::min(left.z.max, right.z.max));
  const bool along_y = gap_y.width >= gap_x.width;  // the pads face each other
  std::vector<BreakBeam> beams;
  for (const double part : {0.25, 0.75}) {
    if (along_y) {
      const double min = std::max(left.area.min_x, right.area.min_x);
      const double max = std::min(left.area.max_x, right.area.max_x);
      const double x = min + part * (max - min);
      beams.push_back({{x, gap_y.from}, {x, gap_y.to}, z});
    } else {
      const double min = std::max(left.area.min_y, right.area.min_y);
      const double max = std::min(left.area.max_y, right.area.max_y);
      const double y = min + part * (max - min);
      beams.push_back({{gap_x.from, y}, {gap_x.to, y}, z});
    }
  }
  return beams;
}

}  // namespace troupe
