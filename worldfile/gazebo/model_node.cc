#include "worldfile/gazebo/model_node.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "common/geometry/limits.h"
#include "worldfile/gazebo/drive_guess.h"
#include "worldfile/gazebo/gripper_guess.h"
#include "worldfile/gazebo/sensor_nodes.h"
#include "worldfile/sites/node_maker.h"

namespace troupe {
namespace {

constexpr double kNotableError = 0.02;   // m: a larger one is a warning
constexpr double kLeastTravel = 0.01;    // m, of a joint that becomes an actuator
constexpr double kOnFloor = 5e-3;        // m: a robot that is this near to the floor stands on it
constexpr double kSettling = 0.5;        // m, from which a robot of Gazebo drops at the start
constexpr double kUsualLiftSpeed = 0.1;  // m/s
constexpr double kUpwards = 0.99;        // of the vertical part of a lift's axis

// A model that carries links: the root, or an actuator. Frame B: its own, upright.
struct Carrier {
  const JointPart* joint = nullptr;       // null: the root
  std::size_t parent = 0;                 // carrier
  const GripperGuess* gripper = nullptr;  // of which it is a finger
  const FingerGuess* finger = nullptr;
  Transform3 T_MB = {};
  std::vector<Block> blocks = {};
  Rectangle area = Rectangle::Nothing();
  ZRange z = {};
};

bool IsUprightTransform(const Transform3& T) {
  return IsVertical(T.z_axis()) && T.z_axis().z > 0.0;
}

bool IsNear(const Block& block) {
  const Rectangle box = BoundingBox(block.outline);
  return std::max({-box.min_x, -box.min_y, box.max_x, box.max_y, -block.z.min, block.z.max}) <= kMaxMagnitude;
}

class NodeBuilder {
 public:
  NodeBuilder(const RigidModel& model, bool is_robot, Diagnostics& diagnostics)
      : model_(model), is_robot_(is_robot), diagnostics_(diagnostics) {}

  std::optional<WorldNode> Build() {
    has_collisions_ = std::any_of(model_.links.begin(), model_.links.end(),
                                  [](const LinkPart& link) { return !link.collisions.empty(); });
    // The root's frame is upright, below the origin of M; a tilt is in the blocks.
    const Vec3& p = model_.T_PM.translation();
    const Transform3 T_PB = Transform3::FromRpy(p, 0, 0, model_.T_PM.yaw());
    carriers_.push_back({.T_MB = model_.T_PM.Inverse() * T_PB});
    if (is_robot_) Settle();
    // What nothing touches grips nothing.
    if (is_robot_ && has_collisions_) grippers_ = GuessGrippers(model_);
    FindCarriers();
    FindFingers();
    for (const LinkPart& link : model_.links) AddBody(link);
    if (diagnostics_.failed()) return std::nullopt;
    WarnOfErrors();
    const bool has_body =
        std::any_of(carriers_.begin(), carriers_.end(), [](const Carrier& carrier) { return !carrier.blocks.empty(); });
    if (!has_body && !is_robot_) return std::nullopt;
    NodeMaker maker = MakerOf(0, is_robot_ ? "position" : "model");
    maker.Text("name", model_.name);
    Pose pose = T_PB.ToPose();
    if (is_robot_) pose.z = FloorBelow(pose.z + T_MB().z);
    maker.At(pose);
    if (!has_collisions_) {
      maker.Number("obstacle_return", 0);
      if (has_body) {
        diagnostics_.Warn(model_.where, "model " + Quoted(model_.name) +
                                            " has no collision: sensors see its visuals, and nothing hits them");
      }
    }
    double mass = 0.0;
    for (const LinkPart& link : model_.links) mass += link.mass;
    if (!model_.is_static && mass > 0.0) maker.Number("mass", std::min(mass, kMaxMagnitude));
    if (is_robot_) {
      AddDrive(maker);
      maker.Number("gui_nose", 1);
    } else if (!model_.is_static && has_collisions_) {
      maker.Number("gripper_return", 1);
    }
    AddSensors(0, maker);
    AddActuators(0, maker);
    if (is_robot_) drafts_[0]->frames = Frames();
    maker.node.draft = std::make_shared<const PartDraft>(std::move(*drafts_[0]));
    return std::move(maker.node);
  }

 private:
  const Vec3& T_MB() const { return carriers_[0].T_MB.translation(); }

  // A robot that Gazebo lets drop a little onto the floor, or that its author has put a little into it, is on it.
  static double FloorBelow(double z) { return z > -kSettling && z < kSettling ? 0.0 : z; }

  // Moves the root frame down to the lowest collision.
  void Settle() {
    std::optional<double> lowest;
    const Transform3 T_BM = carriers_[0].T_MB.Inverse();
    for (const LinkPart& link : model_.links) {
      for (const SolidPart& part : link.collisions) {
        const double low = LowestPoint(part.solid, T_BM * link.T_ML * part.T_LS);
        lowest = std::min(lowest.value_or(low), low);
      }
    }
    lowest_ = lowest.value_or(0.0);
    if (std::fabs(lowest_) > kOnFloor) {
      carriers_[0].T_MB = carriers_[0].T_MB * Transform3::FromRpy({0, 0, lowest_}, 0, 0, 0);
    }
  }

  // The joints of a robot that move, and the links that they carry.
  void FindCarriers() {
    std::map<std::string, const JointPart*> above;  // by child
    for (const JointPart& joint : model_.joints) above.emplace(joint.child, &joint);
    std::map<std::size_t, std::size_t> known;  // carriers by their joints, numbered as in the model
    for (const LinkPart& link : model_.links) {
      std::vector<const JointPart*> moving;  // above the link, the lowest first
      std::set<std::string> seen;
      for (auto at = above.find(link.name); at != above.end() && seen.insert(at->first).second;
           at = above.find(at->second->parent)) {
        if (IsActuator(*at->second)) moving.push_back(at->second);
      }
      std::size_t carrier = 0;
      for (auto joint = moving.rbegin(); joint != moving.rend(); ++joint) {
        const auto number = static_cast<std::size_t>(*joint - model_.joints.data());
        const auto [entry, is_new] = known.emplace(number, carriers_.size());
        if (is_new) {
          // Upright, at the joint, with the heading of the root.
          const Transform3 T_BJ = carriers_[0].T_MB.Inverse() * (*joint)->T_MJ;
          const Transform3 at = Transform3::FromRpy(T_BJ.translation(), 0, 0, 0);
          carriers_.push_back({.joint = *joint, .parent = carrier, .T_MB = carriers_[0].T_MB * at});
        }
        carrier = entry->second;
      }
      carrier_of_[link.name] = carrier;
    }
    for (std::size_t i = 0; i < carriers_.size(); ++i) drafts_.push_back(std::make_unique<BodyDraft>());
  }

  bool IsActuator(const JointPart& joint) const {
    const auto number = static_cast<std::size_t>(&joint - model_.joints.data());
    const bool is_finger = std::any_of(grippers_.begin(), grippers_.end(), [number](const GripperGuess& gripper) {
      return gripper.left.joint == number || gripper.right.joint == number;
    });
    return is_finger || (is_robot_ && joint.type == "prismatic" && joint.mimic.empty() &&
                         joint.upper - joint.lower >= kLeastTravel && joint.upper - joint.lower < 100.0);
  }

  // The carriers of fingers. A gripper is mounted on one carrier.
  void FindFingers() {
    const auto carrier_of = [this](const FingerGuess& finger) {
      return std::find_if(carriers_.begin(), carriers_.end(),
                          [&](const Carrier& carrier) { return carrier.joint == &model_.joints[finger.joint]; });
    };
    for (const GripperGuess& gripper : grippers_) {
      const auto left = carrier_of(gripper.left);
      const auto right = carrier_of(gripper.right);
      if (left == carriers_.end() || right == carriers_.end() || left->parent != right->parent) continue;
      left->gripper = right->gripper = &gripper;
      left->finger = &gripper.left;
      right->finger = &gripper.right;
    }
  }

  // "gripper"; of several the links that carry them.
  std::string GripperName(const GripperGuess& gripper) const {
    std::string name = grippers_.size() == 1 ? "gripper" : model_.joints[gripper.left.joint].parent;
    const auto is_joint = [&](const JointPart& joint) { return joint.name == name; };
    while (std::any_of(model_.joints.begin(), model_.joints.end(), is_joint)) name += "_gripper";
    return name;
  }

  // The nearest carrier, from this one down to the root, that moves up.
  std::optional<std::size_t> LiftBelow(std::size_t index) const {
    for (; index != 0; index = carriers_[index].parent) {
      if (carriers_[index].joint->axis.z > kUpwards) return index;
    }
    return std::nullopt;
  }

  void AddBody(const LinkPart& link) {
    Carrier& carrier = carriers_[carrier_of_[link.name]];
    const Transform3 T_BL = carrier.T_MB.Inverse() * link.T_ML;
    const SolidUse use = model_.is_static ? SolidUse::kStatic : SolidUse::kMoving;
    for (const SolidPart& part : link.visuals) {
      if (!color_ && part.color) color_ = part.color;
    }
    if (!has_collisions_) {
      for (const Error& fault : link.visual_faults) {
        diagnostics_.Warn(fault.where, fault.message + "; this visual is left out");
      }
    }
    for (const SolidPart& part : has_collisions_ ? link.collisions : link.visuals) {
      SolidBlocks blocks = BlocksOf(part.solid, T_BL * part.T_LS, use);
      if (blocks.error > worst_error_) {
        worst_error_ = blocks.error;
        worst_ = &part;
      }
      if (blocks.is_hollow && hollow_ == nullptr) hollow_ = &part;
      block_count_ += blocks.blocks.size();
      for (Block& block : blocks.blocks) {
        if (!IsNear(block)) {
          return diagnostics_.Fail(part.where, "found a body that reaches beyond 1000 km, expected a smaller one");
        }
        carrier.area.Extend(BoundingBox(block.outline));
        const bool is_first = carrier.blocks.empty();
        carrier.z =
            is_first ? block.z : ZRange{std::min(carrier.z.min, block.z.min), std::max(carrier.z.max, block.z.max)};
        carrier.blocks.push_back(std::move(block));
      }
    }
  }

  void WarnOfErrors() {
    if (worst_ != nullptr && worst_error_ > kNotableError) {
      const bool is_mesh = worst_->solid.kind == SolidShape::Kind::kMesh;
      diagnostics_.Warn(worst_->where, "found " + std::string(is_mesh ? "a mesh" : "a shape that is not upright") +
                                           " in " + Quoted(model_.name) + ", which is shown by " +
                                           CountText(block_count_, "block") + ": at some heights it is up to " +
                                           NumberText(std::ceil(worst_error_ * 100.0) / 100.0) +
                                           " m larger than in Gazebo");
    }
    if (hollow_ != nullptr) {
      diagnostics_.Warn(hollow_->where, "found a mesh in " + Quoted(model_.name) +
                                            " whose surface is not closed: it is a shell of walls, free inside");
    }
  }

  NodeMaker MakerOf(std::size_t index, const std::string& type) {
    Carrier& carrier = carriers_[index];
    NodeMaker maker(type, carrier.joint != nullptr ? carrier.joint->where : model_.where);
    maker.Number("stack_children", 0);
    if (carrier.area.empty()) {
      maker.Numbers("size", {0.1, 0.1, 0.1}).Number("noblocks", 1);
    } else {
      maker.Numbers("size", {carrier.area.width(), carrier.area.height(), carrier.z.max - carrier.z.min});
    }
    if (color_) {
      maker.Numbers("color_rgba", {color_->r, color_->g, color_->b, color_->a});
    } else {
      maker.Text("color", is_robot_ ? "gray40" : "gray60");
    }
    drafts_[index]->blocks = std::move(carrier.blocks);
    return maker;
  }

  void AddDrive(NodeMaker& maker) {
    const DriveGuess drive = GuessDrive(model_, lowest_, diagnostics_);
    if (drive.type.empty()) {
      diagnostics_.Warn(model_.where, "found no wheels and no drive plugin on robot " + Quoted(model_.name) +
                                          ", expected one; it drives as a differential one");
    }
    maker.Text("drive", drive.type.empty() ? "diff" : drive.type);
    if (drive.type == "car" && drive.wheelbase > 1e-3) maker.Number("wheelbase", drive.wheelbase);
    const auto set = [&](const char* name, const std::optional<double>& linear, const std::optional<double>& turn) {
      if (!linear && !turn) return;
      const double x = linear.value_or(1.0);
      const double y = drive.type == "omni" ? x : 0.0;
      const double a = RadiansToDegrees(turn.value_or(0.5 * kPi));
      maker.Numbers(name, {-x, x, -y, y, 0, 0, -a, a});
    };
    set("velocity_bounds", drive.max_speed, drive.max_turn_rate);
    set("acceleration_bounds", drive.max_acceleration, drive.max_turn_acceleration);
  }

  void AddSensors(std::size_t index, NodeMaker& maker) {
    const Transform3 T_BM = carriers_[index].T_MB.Inverse();
    std::map<std::string, Transform3> frames;
    for (const auto& [name, T_MF] : model_.frames) frames.emplace(name, T_BM * T_MF);
    for (const LinkPart& link : model_.links) {
      if (carrier_of_[link.name] != index) continue;
      for (const SensorPart& sensor : link.sensors) {
        if (!is_robot_) {
          diagnostics_.Warn(XmlPlace(sensor.element, sensor.file),
                            "found a sensor on a model without a drive; it measures nothing, and is left out");
          continue;
        }
        const SensorAttachment mount{T_BM * link.T_ML * sensor.T_LS, link.name, &frames};
        if (std::optional<WorldNode> node = SensorNode(sensor, mount, diagnostics_)) maker.Child(std::move(*node));
      }
    }
  }

  void AddActuators(std::size_t parent, NodeMaker& maker) {
    for (std::size_t i = 1; i < carriers_.size(); ++i) {
      if (carriers_[i].parent != parent) continue;
      const GripperGuess* const gripper = carriers_[i].gripper;
      if (gripper == nullptr) {
        maker.Child(ActuatorNode(i));
      } else if (carriers_[i].finger == &gripper->left) {
        maker.Child(GripperNode(parent, *gripper));
      }
    }
  }

  // A frame of its own at that of the carrier, with the fingers on it.
  WorldNode GripperNode(std::size_t parent, const GripperGuess& gripper) {
    const JointPart& left = model_.joints[gripper.left.joint];
    const JointPart& right = model_.joints[gripper.right.joint];
    NodeMaker maker("gripper", left.where);
    maker.Text("name", GripperName(gripper)).Number("stack_children", 0).Number("noblocks", 1).At({});
    maker.Text("left_finger", left.name).Text("right_finger", right.name);
    if (const std::optional<std::size_t> lift = LiftBelow(parent)) maker.Text("lift", PartName(*lift));
    for (std::size_t i = 1; i < carriers_.size(); ++i) {
      if (carriers_[i].gripper == &gripper) maker.Child(ActuatorNode(i));
    }
    return std::move(maker.node);
  }

  WorldNode ActuatorNode(std::size_t index) {
    const Carrier& carrier = carriers_[index];
    const JointPart& joint = *carrier.joint;
    const Transform3 T_BC = carriers_[carrier.parent].T_MB.Inverse() * carrier.T_MB;
    Vec3 axis = carrier.T_MB.Inverse().Rotate(joint.axis);
    Interval position{joint.lower, joint.upper};
    if (carrier.finger != nullptr) {
      position = carrier.finger->position;
      // Fingers of Troupe close upwards.
      if (carrier.finger->closes_downwards) {
        axis = axis * -1.0;
        position = {-position.max, -position.min};
      }
    }
    NodeMaker maker = MakerOf(index, "actuator");
    maker.Text("name", joint.name).Text("type", "linear").At(T_BC.ToPose());
    maker.Numbers("axis", {axis.x, axis.y, axis.z});
    maker.Number("min_position", position.min).Number("max_position", position.max);
    maker.Number("start_position", std::clamp(0.0, position.min, position.max));
    maker.Number("max_speed", joint.velocity > 0.0 ? joint.velocity : kUsualLiftSpeed);
    AddSensors(index, maker);
    AddActuators(index, maker);
    maker.node.draft = std::make_shared<const PartDraft>(std::move(*drafts_[index]));
    return std::move(maker.node);
  }

  // The name of a carrier's model below the robot's.
  std::string PartName(std::size_t index) const {
    if (index == 0) return "";
    const std::string above = PartName(carriers_[index].parent);
    const std::string mount = carriers_[index].gripper != nullptr ? GripperName(*carriers_[index].gripper) + "." : "";
    return (above.empty() ? "" : above + ".") + mount + carriers_[index].joint->name;
  }

  // The base first: the root link if it is on the floor, else base_footprint, or a frame of the file there.
  std::vector<BodyDraft::Frame> Frames() const {
    std::vector<BodyDraft::Frame> frames;
    const auto frame_of = [&](const std::string& name, const Transform3& T_MF, std::size_t index) {
      const Transform3 T = carriers_[index].T_MB.Inverse() * T_MF;
      return BodyDraft::Frame{name, PartName(index), T.ToPose(), T.roll(), T.pitch()};
    };
    std::string base = "base_footprint";
    if (!model_.links.empty() && !model_.frames.contains(base)) {
      const Transform3 T = carriers_[0].T_MB.Inverse() * model_.links.front().T_ML;
      const bool is_here = Length(T.translation()) <= kOnFloor && IsUprightTransform(T) && std::fabs(T.yaw()) < 1e-3;
      if (is_here) base = model_.links.front().name;
    }
    frames.push_back({base, "", {}, 0.0, 0.0});
    for (const LinkPart& link : model_.links) {
      if (link.name == base) continue;
      frames.push_back(frame_of(link.name, link.T_ML, carrier_of_.at(link.name)));
    }
    return frames;
  }

  const RigidModel& model_;
  const bool is_robot_;
  Diagnostics& diagnostics_;
  bool has_collisions_ = false;
  double lowest_ = 0.0;  // m, of the collisions above the origin of M
  std::vector<GripperGuess> grippers_;
  std::vector<Carrier> carriers_;
  std::map<std::string, std::size_t> carrier_of_;   // by link
  std::vector<std::unique_ptr<BodyDraft>> drafts_;  // by carrier
  std::optional<Color> color_;
  double worst_error_ = 0.0;
  const SolidPart* worst_ = nullptr;
  const SolidPart* hollow_ = nullptr;
  std::size_t block_count_ = 0;
};

}  // namespace

std::optional<WorldNode> ModelNode(const RigidModel& model, ModelUse use, Diagnostics& diagnostics) {
  const bool is_robot = use == ModelUse::kRobot || (!model.is_static && HasDrivePlugin(model));
  return NodeBuilder(model, is_robot, diagnostics).Build();
}

}  // namespace troupe
