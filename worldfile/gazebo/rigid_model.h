// RigidModel: a model of SDF or a robot of URDF, as read from its file: links with solids and sensors, joints at
// position 0, plugins. Nothing here is 2.5D yet (model_node.h). Lengths in m, angles in rad, kg. Frames: M the model, L
// a link, S a solid or a sensor, J a joint.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "troupe/color.h"
#include "troupe/result.h"
#include "worldfile/gazebo/solid.h"
#include "worldfile/gazebo/transform3.h"
#include "worldfile/text/xml_reader.h"

namespace troupe {

struct SolidPart {
  SolidShape solid;
  Transform3 T_LS;
  std::optional<Color> color;
  SourceLocation where;
};

// The element is read where the sensor becomes one of Troupe's (sensor_nodes.h).
struct SensorPart {
  std::string name;
  Transform3 T_LS;
  XmlElement element;
  std::string file;
};

struct LinkPart {
  std::string name;
  Transform3 T_ML;
  std::vector<SolidPart> collisions;
  std::vector<SolidPart> visuals;
  std::vector<Error> visual_faults;  // of visuals that could not be read
  std::vector<SensorPart> sensors;
  double mass = 0.0;
  SourceLocation where;
};

struct JointPart {
  std::string name;
  std::string type;  // "fixed", "revolute", "continuous", "prismatic", ...
  std::string parent;
  std::string child;
  Transform3 T_MJ;
  Vec3 axis{0, 0, 1};  // in M, of length 1
  double lower = 0.0;  // rad or m
  double upper = 0.0;
  double velocity = 0.0;  // rad/s or m/s; 0: not given
  std::string mimic;      // the joint that it follows: position = multiplier x its position + offset; empty: none
  double mimic_multiplier = 1.0;
  double mimic_offset = 0.0;
  SourceLocation where;
};

struct PluginPart {
  std::string name;  // its file and its name, in lower case
  XmlElement element;
  std::string file;
};

struct RigidModel {
  std::string name;
  bool is_static = false;
  Transform3 T_PM;              // in its parent: the world, or the model around it
  std::string relative_to;      // the frame of T_PM; empty: the parent's
  std::string placement_frame;  // that is at T_PM in place of M; empty: M
  std::vector<LinkPart> links;
  std::vector<JointPart> joints;
  std::vector<PluginPart> plugins;
  std::map<std::string, Transform3> frames;  // all names of the model that poses can refer to, in M
  SourceLocation where;
};

}  // namespace troupe
