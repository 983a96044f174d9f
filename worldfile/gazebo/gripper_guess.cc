#include "worldfile/gazebo/gripper_guess.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/geometry/limits.h"

namespace troupe {
namespace {

constexpr double kLeastFingerTravel = 2e-3;   // m
constexpr double kLargestFingerTravel = 2.0;  // m: what travels farther is no finger
constexpr double kHorizontal = 0.05;          // of the vertical part of an axis
constexpr double kParallel = 0.99;            // of the cosine between the axes of two fingers

struct Finger {
  std::size_t joint = 0;
  Interval position;
  std::vector<const LinkPart*> links;  // the child and all that it carries
};

// How far the collisions of a finger reach along a direction, m in M, at position 0.
Interval ExtentAlong(const Finger& finger, const Vec3& direction) {
  const double yaw = Atan2(direction.y, direction.x);
  const double slope = Atan2(direction.z, std::sqrt(direction.x * direction.x + direction.y * direction.y));
  // The direction becomes z: first into the plane of x and z, then up.
  const Transform3 up = Transform3::FromRpy({}, 0, slope - 0.5 * kPi, 0) * Transform3::FromRpy({}, 0, 0, -yaw);
  const Transform3 down = Transform3::FromRpy({}, kPi, 0, 0) * up;
  Interval extent{kMaxMagnitude, -kMaxMagnitude};
  for (const LinkPart* const link : finger.links) {
    for (const SolidPart& part : link->collisions) {
      const Transform3 T_MS = link->T_ML * part.T_LS;
      extent.min = std::min(extent.min, LowestPoint(part.solid, up * T_MS));
      extent.max = std::max(extent.max, -LowestPoint(part.solid, down * T_MS));
    }
  }
  return extent;
}

double Middle(const Interval& interval) {
  return 0.5 * (interval.min + interval.max);
}

bool Overlap(const Interval& a, const Interval& b) {
  return a.min <= b.max && b.min <= a.max;
}

class GripperFinder {
 public:
  explicit GripperFinder(const RigidModel& model) : model_(model) {
    for (const JointPart& joint : model.joints) below_[joint.parent].push_back(joint.child);
    for (const LinkPart& link : model.links) links_.emplace(link.name, &link);
  }

  std::vector<GripperGuess> Find() const {
    std::vector<Finger> fingers;
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      if (std::optional<Finger> finger = FingerOf(i)) fingers.push_back(std::move(*finger));
    }
    std::vector<GripperGuess> grippers;
    std::set<std::size_t> paired;
    // Those that follow each other first: a link may carry two pairs.
    for (const bool follow : {true, false}) {
      for (std::size_t a = 0; a < fingers.size(); ++a) {
        for (std::size_t b = a + 1; b < fingers.size() && !paired.contains(a); ++b) {
          if (paired.contains(b) ||
              !(follow ? Follow(fingers[a], fingers[b]) : HaveOneParent(fingers[a], fingers[b]))) {
            continue;
          }
          const std::optional<GripperGuess> gripper = PairOf(fingers[a], fingers[b]);
          if (!gripper) continue;
          grippers.push_back(*gripper);
          paired.insert({a, b});
        }
      }
    }
    std::sort(grippers.begin(), grippers.end(), [](const GripperGuess& a, const GripperGuess& b) {
      return std::min(a.left.joint, a.right.joint) < std::min(b.left.joint, b.right.joint);
    });
    return grippers;
  }

 private:
  const JointPart& JointOf(const Finger& finger) const { return model_.joints[finger.joint]; }

  static std::optional<Interval> TravelOf(double from, double to) {
    const double travel = std::fabs(to - from);
    if (!(travel >= kLeastFingerTravel && travel <= kLargestFingerTravel)) return std::nullopt;
    return Interval{std::min(from, to), std::max(from, to)};
  }

  std::optional<Finger> FingerOf(std::size_t index) const {
    const JointPart& joint = model_.joints[index];
    if (joint.type != "prismatic" || std::fabs(joint.axis.z) > kHorizontal) return std::nullopt;
    std::optional<Interval> position = TravelOf(joint.lower, joint.upper);
    if (!position && !joint.mimic.empty()) {
      const auto leader = std::find_if(model_.joints.begin(), model_.joints.end(),
                                       [&](const JointPart& other) { return other.name == joint.mimic; });
      if (leader != model_.joints.end()) {
        position = TravelOf(leader->lower * joint.mimic_multiplier + joint.mimic_offset,
                            leader->upper * joint.mimic_multiplier + joint.mimic_offset);
      }
    }
    if (!position) return std::nullopt;
    Finger finger{index, *position, {}};
    bool has_body = false;
    std::vector<std::string> open = {joint.child};
    std::set<std::string> seen = {joint.child};
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (const auto link = links_.find(open[i]); link != links_.end()) {
        finger.links.push_back(link->second);
        has_body = has_body || !link->second->collisions.empty();
      }
      const auto children = below_.find(open[i]);
      if (children == below_.end()) continue;
      for (const std::string& child : children->second) {
        if (seen.insert(child).second) open.push_back(child);
      }
    }
    return has_body ? std::optional(std::move(finger)) : std::nullopt;
  }

  bool HaveOneParent(const Finger& a, const Finger& b) const { return JointOf(a).parent == JointOf(b).parent; }

  bool Follow(const Finger& a, const Finger& b) const {
    const JointPart& first = JointOf(a);
    const JointPart& second = JointOf(b);
    return first.mimic == second.name || second.mimic == first.name ||
           (!first.mimic.empty() && first.mimic == second.mimic);
  }

  std::optional<GripperGuess> PairOf(const Finger& a, const Finger& b) const {
    const Vec3& axis = JointOf(a).axis;
    const double along = Dot(axis, JointOf(b).axis);
    if (std::fabs(along) < kParallel) return std::nullopt;
    const Vec3 across = Cross({0, 0, 1}, axis);
    if (!Overlap(ExtentAlong(a, {0, 0, 1}), ExtentAlong(b, {0, 0, 1}))) return std::nullopt;
    if (!Overlap(ExtentAlong(a, across), ExtentAlong(b, across))) return std::nullopt;
    // From a to b along the axis of a, both at the middle of their travel.
    const double way = Middle(ExtentAlong(b, axis)) + (along > 0 ? 1.0 : -1.0) * Middle(b.position) -
                       Middle(ExtentAlong(a, axis)) - Middle(a.position);
    if (std::fabs(way) < 1e-4) return std::nullopt;
    const FingerGuess first{a.joint, a.position, way < 0.0};
    const FingerGuess second{b.joint, b.position, (way > 0.0) == (along > 0.0)};
    // From a to b in M.
    const Vec3 to_b = axis * way;
    const bool a_is_left = std::fabs(to_b.y) > 1e-6 ? to_b.y < 0.0 : to_b.x < 0.0;
    return a_is_left ? GripperGuess{first, second} : GripperGuess{second, first};
  }

  const RigidModel& model_;
  std::map<std::string, std::vector<std::string>> below_;  // children by parent
  std::map<std::string, const LinkPart*> links_;
};

}  // namespace

std::vector<GripperGuess> GuessGrippers(const RigidModel& model) {
  return GripperFinder(model).Find();
}

}  // namespace troupe
