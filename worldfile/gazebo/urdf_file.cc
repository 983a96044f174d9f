#include "worldfile/gazebo/urdf_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "worldfile/gazebo/sdf_file.h"
#include "worldfile/gazebo/xml_values.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxUrdfLinks = 20'000;

class UrdfReader {
 public:
  UrdfReader(const std::string& path, ModelFiles& files, Diagnostics& diagnostics)
      : values_(path, diagnostics), files_(files), diagnostics_(diagnostics) {}

  std::optional<RigidModel> Read(const XmlElement& robot) {
    model_.name = XmlValues::Attribute(robot, "name", "robot");
    model_.where = values_.At(robot);
    for (const XmlElement& child : robot.children) {
      if (child.name == "material") AddMaterial(child);
    }
    for (const XmlElement& child : robot.children) {
      if (diagnostics_.failed()) return std::nullopt;
      if (child.name == "link") ReadLink(child);
      if (child.name == "joint") ReadJoint(child);
    }
    PlaceLinks(robot);
    for (const XmlElement& child : robot.children) {
      if (diagnostics_.failed()) return std::nullopt;
      if (child.name == "gazebo") ReadGazebo(child);
    }
    if (diagnostics_.failed()) return std::nullopt;
    return std::move(model_);
  }

 private:
  std::optional<Color> ColorOf(const XmlElement& material) const {
    const XmlElement* const color = material.Find("color");
    if (color == nullptr) return std::nullopt;
    const std::vector<double> n = values_.AttributeNumbers(*color, "rgba", {0.5, 0.5, 0.5, 1});
    const auto channel = [&](std::size_t i) { return std::clamp(n[i], 0.0, 1.0); };
    return Color{channel(0), channel(1), channel(2), 1.0};
  }

  void AddMaterial(const XmlElement& material) {
    if (const std::optional<Color> color = ColorOf(material)) {
      materials_.emplace(XmlValues::Attribute(material, "name"), *color);
    }
  }

  void ReadLink(const XmlElement& element) {
    LinkPart link;
    link.name = XmlValues::Attribute(element, "name");
    link.where = values_.At(element);
    if (link.name.empty()) values_.Fail(element, "found a link without a name, expected the attribute 'name'");
    if (!index_.emplace(link.name, model_.links.size()).second) {
      values_.Fail(element, "found the link " + Quoted(link.name) + " again, expected another name");
    }
    if (model_.links.size() >= kMaxUrdfLinks) values_.Fail(element, "found too many links, expected fewer");
    if (const XmlElement* const inertial = element.Find("inertial")) {
      if (const XmlElement* const mass = inertial->Find("mass")) {
        link.mass = std::clamp(values_.AttributeNumbers(*mass, "value", {0}).front(), 0.0, kMaxMagnitude);
      }
    }
    for (const XmlElement& child : element.children) {
      const XmlElement* const geometry = child.Find("geometry");
      if (diagnostics_.failed() || geometry == nullptr) continue;
      if (child.name == "collision") {
        for (SolidShape& solid : ReadGeometry(*geometry, values_.file(), files_, diagnostics_)) {
          link.collisions.push_back({std::move(solid), values_.Origin(child), std::nullopt, values_.At(child)});
        }
      } else if (child.name == "visual") {
        Diagnostics own;
        for (SolidShape& solid : ReadGeometry(*geometry, values_.file(), files_, own)) {
          link.visuals.push_back({std::move(solid), values_.Origin(child), VisualColor(child), values_.At(child)});
        }
        if (own.failed()) link.visual_faults.push_back(*own.error());
      }
    }
    model_.links.push_back(std::move(link));
  }

  std::optional<Color> VisualColor(const XmlElement& visual) const {
    const XmlElement* const material = visual.Find("material");
    if (material == nullptr) return std::nullopt;
    if (const std::optional<Color> color = ColorOf(*material)) return color;
    const auto found = materials_.find(XmlValues::Attribute(*material, "name"));
    return found == materials_.end() ? std::nullopt : std::optional(found->second);
  }

  std::string LinkOf(const XmlElement& joint, const char* role) const {
    const XmlElement* const element = joint.Find(role);
    std::string link = element != nullptr ? XmlValues::Attribute(*element, "link") : "";
    if (link.empty()) {
      values_.Fail(joint, "found a joint without a " + Quoted(role) + ", expected the name of a link");
    }
    return link;
  }

  void ReadJoint(const XmlElement& element) {
    JointPart joint;
    joint.name = XmlValues::Attribute(element, "name");
    joint.type = XmlValues::Attribute(element, "type");
    joint.where = values_.At(element);
    joint.parent = LinkOf(element, "parent");
    joint.child = LinkOf(element, "child");
    joint.T_MJ = values_.Origin(element);  // in the parent link, until PlaceLinks
    std::vector<double> axis = {1, 0, 0};
    if (const XmlElement* const direction = element.Find("axis")) {
      axis = values_.AttributeNumbers(*direction, "xyz", {1, 0, 0});
    }
    joint.axis = {axis[0], axis[1], axis[2]};
    if (const XmlElement* const limit = element.Find("limit")) {
      joint.lower = values_.AttributeNumber(*limit, "lower", 0.0);
      joint.upper = values_.AttributeNumber(*limit, "upper", 0.0);
      joint.velocity = std::max(0.0, values_.AttributeNumber(*limit, "velocity", 0.0));
    }
    if (const XmlElement* const mimic = element.Find("mimic")) {
      joint.mimic = XmlValues::Attribute(*mimic, "joint");
      joint.mimic_multiplier = values_.AttributeNumbers(*mimic, "multiplier", {1}).front();
      joint.mimic_offset = values_.AttributeNumbers(*mimic, "offset", {0}).front();
      if (joint.mimic.empty()) values_.Fail(*mimic, "found a 'mimic' without a 'joint', expected the name of a joint");
    }
    model_.joints.push_back(std::move(joint));
  }

  // From the poses of joints in their parents to poses in the root link.
  void PlaceLinks(const XmlElement& robot) {
    if (diagnostics_.failed()) return;
    if (model_.links.empty()) values_.Fail(robot, "found a robot without links, expected one");
    std::map<std::string, const JointPart*> above;  // by child
    std::map<std::string, std::vector<JointPart*>> below;
    for (JointPart& joint : model_.joints) {
      for (const std::string& link : {joint.parent, joint.child}) {
        if (!index_.contains(link)) {
          diagnostics_.Fail(joint.where, "found the link " + Quoted(link) + " in joint " + Quoted(joint.name) +
                                             ", expected a link of the robot");
        }
      }
      if (!above.emplace(joint.child, &joint).second) {
        diagnostics_.Fail(joint.where, "found a second joint above link " + Quoted(joint.child) + ", expected one");
      }
      below[joint.parent].push_back(&joint);
    }
    std::string root;
    for (const LinkPart& link : model_.links) {
      if (above.contains(link.name)) continue;
      if (root.empty()) {
        root = link.name;
      } else {
        diagnostics_.Fail(link.where, "found link " + Quoted(link.name) + " without a joint above it beside " +
                                          Quoted(root) + ", expected one root");
      }
    }
    if (diagnostics_.failed()) return;
    if (root.empty()) {
      values_.Fail(robot, "found joints that go in a circle, expected a root link");
      return;
    }
    // Without recursion: a chain may be as long as there are links.
    std::vector<std::string> open = {root};
    std::size_t placed = 0;
    for (std::size_t i = 0; i < open.size(); ++i, ++placed) {
      const Transform3 T_ML = model_.links[index_.at(open[i])].T_ML;
      for (JointPart* const joint : below[open[i]]) {
        joint->T_MJ = T_ML * joint->T_MJ;
        const double length = Length(joint->axis);
        joint->axis = length > 0.0 ? joint->T_MJ.Rotate(joint->axis) * (1.0 / length) : Vec3{0, 0, 1};
        model_.links[index_.at(joint->child)].T_ML = joint->T_MJ;
        open.push_back(joint->child);
      }
    }
    if (placed < model_.links.size()) values_.Fail(robot, "found joints that go in a circle, expected a tree of links");
    // The root first: it is the base.
    std::swap(model_.links.front(), model_.links[index_.at(root)]);
    for (std::size_t i = 0; i < model_.links.size(); ++i) index_[model_.links[i].name] = i;
    for (const LinkPart& link : model_.links) model_.frames.emplace(link.name, link.T_ML);
  }

  void ReadGazebo(const XmlElement& gazebo) {
    const std::string reference = XmlValues::Attribute(gazebo, "reference");
    const auto link = index_.find(reference);
    for (const XmlElement& child : gazebo.children) {
      if (child.name == "plugin") {
        std::string name = XmlValues::Attribute(child, "filename") + " " + XmlValues::Attribute(child, "name");
        for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        model_.plugins.push_back({std::move(name), child, values_.file()});
      }
      if (child.name != "sensor") continue;
      if (link == index_.end()) {
        values_.Warn(child,
                     "found a sensor on " + Quoted(reference) + ", expected a link of the robot; it is left out");
        continue;
      }
      const XmlElement* const pose = child.Find("pose");
      model_.links[link->second].sensors.push_back({XmlValues::Attribute(child, "name"),
                                                    pose != nullptr ? values_.Pose(*pose) : Transform3(), child,
                                                    values_.file()});
    }
  }

  XmlValues values_;
  ModelFiles& files_;
  Diagnostics& diagnostics_;
  RigidModel model_;
  std::map<std::string, std::size_t> index_;  // of links
  std::map<std::string, Color> materials_;
};

}  // namespace

std::optional<RigidModel> ReadUrdf(const XmlElement& robot, const std::string& path, ModelFiles& files,
                                   Diagnostics& diagnostics) {
  return UrdfReader(path, files, diagnostics).Read(robot);
}

}  // namespace troupe
