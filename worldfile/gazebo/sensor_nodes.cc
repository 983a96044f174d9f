#include "worldfile/gazebo/sensor_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "worldfile/gazebo/xml_values.h"
#include "worldfile/sites/node_maker.h"

namespace troupe {
namespace {

constexpr double kSamePlace = 1e-3;   // m
constexpr double kSameAngle = 5e-3;   // rad
constexpr double kFullCircle = 0.05;  // rad: a fan that lacks less than this is a circle
constexpr double kSteepest = 1.4835;  // rad, of rays; 85 degrees
constexpr double kMaxCameraSide = 2048;

// The words after the slashes of a topic.
std::vector<std::string> PartsOfTopic(const std::string& topic) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= topic.size();) {
    const std::size_t end = std::min(topic.find('/', begin), topic.size());
    if (end > begin) parts.push_back(topic.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// The first text of a child of these names, in the sensor or its plugins.
std::string FindText(const XmlElement& sensor, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (sensor.Find(name) != nullptr) return XmlValues::Text(sensor, name);
  }
  for (const XmlElement& child : sensor.children) {
    if (child.name != "plugin") continue;
    if (std::string text = FindText(child, names); !text.empty()) return text;
  }
  return "";
}

// The topic to which a plugin of gazebo_ros is remapped: "~/out:=scan".
std::string Remapped(const XmlElement& sensor) {
  for (const XmlElement& plugin : sensor.children) {
    const XmlElement* const ros = plugin.name == "plugin" ? plugin.Find("ros") : nullptr;
    if (ros == nullptr) continue;
    for (const char* name : {"remapping", "argument"}) {
      const std::string text = XmlValues::Text(*ros, name);
      const std::size_t at = text.find(":=");
      if (at != std::string::npos) return text.substr(at + 2);
    }
  }
  return "";
}

// The name of the sensor, which is that of its topic; empty for the usual one of its kind.
std::string TopicOf(const XmlElement& sensor, bool is_camera) {
  std::string topic = FindText(sensor, {"topic", "topicName", "imageTopicName", "bumperTopicName"});
  if (topic.empty()) topic = Remapped(sensor);
  if (topic.starts_with("__default")) topic.clear();
  std::vector<std::string> parts = PartsOfTopic(topic);
  // "camera/image_raw" and "imu/data" are names of one topic of several.
  const auto is_last = [&](const char* word) { return parts.size() > 1 && parts.back() == word; };
  while (is_last("image_raw") || is_last("image") || is_last("data") || is_last("points") || is_last("depth") ||
         is_last("rgb") || is_last("color")) {
    parts.pop_back();
  }
  const bool is_usual = parts.size() == 1 && (parts[0] == "image_raw" || parts[0] == "image" || parts[0] == "data");
  if (parts.empty() || is_usual) {
    if (!is_camera) return "";
    const std::string camera = FindText(sensor, {"cameraName", "camera_name"});
    return camera.empty() ? XmlValues::Attribute(sensor, "name") : PartsOfTopic(camera).back();
  }
  std::string name = parts.back();
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

bool IsUpright(const Transform3& T) {
  return IsVertical(T.z_axis()) && T.z_axis().z > 0.0;
}

// The frame of the messages, if the file has one that is where the sensor is; a name that the file gives to the frame
// of the sensor itself; else nothing.
std::string FrameOf(const XmlElement& sensor, const SensorAttachment& mount, const Transform3& T_BS) {
  std::string name = FindText(sensor, {"gz_frame_id", "ignition_frame_id", "frame_id", "frameName", "frame_name"});
  name = name.substr(name.rfind('/') == std::string::npos ? 0 : name.rfind('/') + 1);
  if (name.empty()) name = mount.link;
  const auto found = mount.frames->find(name);
  if (found == mount.frames->end()) return name;
  const Transform3 T = found->second.Inverse() * T_BS;
  const bool is_same = Length(T.translation()) < kSamePlace && IsUpright(T) && std::fabs(T.yaw()) < kSameAngle;
  return is_same ? name : "";
}

void SetCommon(const XmlValues& values, const SensorPart& sensor, const SensorAttachment& mount, const Transform3& T_BS,
               const std::string& name, NodeMaker& maker) {
  if (!name.empty()) maker.Text("name", name);
  maker.At(T_BS.ToPose());
  const double rate = values.Number(sensor.element, "update_rate", 0.0);
  // Without a rate a sensor measures in each step.
  maker.Number("update_interval", rate > 0.0 ? 1000.0 / rate : 0.0);
  if (const std::string frame = FrameOf(sensor.element, mount, T_BS); !frame.empty()) maker.Text("frame", frame);
}

void WarnOfTilt(const XmlValues& values, const XmlElement& element, double angle) {
  values.Warn(element, "found a sensor that is tilted by " + NumberText(std::round(RadiansToDegrees(angle) * 10) / 10) +
                           " degrees, expected an upright one; it measures as if it were upright");
}

std::optional<WorldNode> RangerNode(const XmlValues& values, const SensorPart& sensor, const SensorAttachment& mount) {
  const XmlElement* ray = sensor.element.Find("ray");
  if (ray == nullptr) ray = sensor.element.Find("lidar");
  static const XmlElement kEmpty;
  if (ray == nullptr) ray = &kEmpty;
  const XmlElement* const scan = ray->Find("scan");
  const XmlElement* const horizontal = scan != nullptr ? scan->Find("horizontal") : nullptr;
  const XmlElement& h = horizontal != nullptr ? *horizontal : kEmpty;
  double low = values.Number(h, "min_angle", 0.0);
  double high = values.Number(h, "max_angle", 0.0);
  if (low > high) std::swap(low, high);
  const double samples = std::clamp(values.Number(h, "samples", 640.0), 1.0, 100'000.0);
  const double resolution = std::clamp(values.Number(h, "resolution", 1.0), 1e-3, 1e3);
  double fov = std::min(high - low, 2.0 * kPi);
  double middle = fov > 2.0 * kPi - kFullCircle ? 0.0 : 0.5 * (low + high);
  Transform3 T_BS = mount.T_BS;
  const Vec3 up = T_BS.z_axis();
  if (!IsVertical(up)) {
    WarnOfTilt(values, sensor.element, Atan2(std::sqrt(up.x * up.x + up.y * up.y), up.z));
    T_BS = Transform3::FromRpy(T_BS.translation(), 0, 0, T_BS.yaw());
  } else if (up.z < 0.0) {
    // Upside down: its left is our right.
    middle = -middle;
    T_BS = Transform3::FromRpy(T_BS.translation(), 0, 0, T_BS.yaw());
  }
  T_BS = T_BS * Transform3::FromRpy({}, 0, 0, middle);
  NodeMaker maker("ranger", values.At(sensor.element));
  SetCommon(values, sensor, mount, T_BS, TopicOf(sensor.element, false), maker);
  NodeMaker rays("sensor", values.At(sensor.element));
  rays.Numbers("size", {0.01, 0.01, 0.0});
  const XmlElement* const range = ray->Find("range");
  const XmlElement& r = range != nullptr ? *range : kEmpty;
  const double max = std::clamp(values.Number(r, "max", 10.0), 1e-3, 1e5);
  rays.Numbers("range", {std::clamp(values.Number(r, "min", 0.0), 0.0, max), max});
  rays.Number("samples", std::max(1.0, std::round(samples * resolution)));
  rays.Number("fov", RadiansToDegrees(fov));
  if (const XmlElement* const vertical = scan != nullptr ? scan->Find("vertical") : nullptr) {
    const auto planes = static_cast<int>(std::clamp(values.Number(*vertical, "samples", 1.0), 1.0, 1024.0));
    const double from = std::clamp(values.Number(*vertical, "min_angle", 0.0), -kSteepest, kSteepest);
    const double to = std::clamp(values.Number(*vertical, "max_angle", 0.0), -kSteepest, kSteepest);
    if (planes > 1 && to > from) {
      std::vector<double> elevations;
      for (int i = 0; i < planes; ++i) elevations.push_back(RadiansToDegrees(from + (to - from) * i / (planes - 1)));
      rays.Numbers("elevations", elevations);
    }
  }
  if (const XmlElement* const noise = ray->Find("noise")) {
    const double deviation = values.Number(*noise, "stddev", 0.0);
    if (deviation > 0.0 && deviation < 1e3) rays.Numbers("noise", {deviation * deviation, 0.0, 0.0});
  }
  return maker.Child(std::move(rays.node)).node;
}

std::optional<WorldNode> CameraNode(const XmlValues& values, const SensorPart& sensor, const SensorAttachment& mount) {
  static const XmlElement kEmpty;
  const XmlElement* camera = sensor.element.Find("camera");
  if (camera == nullptr) camera = &kEmpty;
  const XmlElement* const image = camera->Find("image");
  const XmlElement& i = image != nullptr ? *image : kEmpty;
  const double width = std::clamp(values.Number(i, "width", 320.0), 1.0, kMaxCameraSide);
  const double height = std::clamp(values.Number(i, "height", 240.0), 1.0, kMaxCameraSide);
  const double fov = std::clamp(values.Number(*camera, "horizontal_fov", 1.047), 0.02, 2.0 * kSteepest);
  const SinCosResult half = SinCos(0.5 * fov);
  const double vertical = 2.0 * Atan2(half.sin / half.cos * height / width, 1.0);
  const XmlElement* const clip = camera->Find("clip");
  const XmlElement& c = clip != nullptr ? *clip : kEmpty;
  const double far = std::clamp(values.Number(c, "far", 100.0), 0.01, 1e5);
  const double near = std::clamp(values.Number(c, "near", 0.1), 0.0, 0.5 * far);
  if (std::fabs(mount.T_BS.roll()) > 0.05) WarnOfTilt(values, sensor.element, mount.T_BS.roll());
  NodeMaker maker("camera", values.At(sensor.element));
  // The height of the optical axis is half the size's above the pose.
  maker.Numbers("size", {0.02, 0.02, 0.0}).Number("noblocks", 1);
  SetCommon(values, sensor, mount, mount.T_BS, TopicOf(sensor.element, true), maker);
  maker.Numbers("resolution", {width, height}).Numbers("range", {near, far});
  maker.Numbers("fov", {RadiansToDegrees(fov), RadiansToDegrees(std::min(vertical, 2.0 * kSteepest))});
  const double pitch = mount.T_BS.pitch();
  if (std::fabs(pitch) > kSameAngle) maker.Numbers("pantilt", {0.0, RadiansToDegrees(-pitch)});
  return std::move(maker.node);
}

std::optional<WorldNode> ImuNode(const XmlValues& values, const SensorPart& sensor, const SensorAttachment& mount) {
  NodeMaker maker("imu", values.At(sensor.element));
  std::string name = TopicOf(sensor.element, false);
  SetCommon(values, sensor, mount, mount.T_BS, name.empty() ? "imu" : name, maker);
  const XmlElement* const imu = sensor.element.Find("imu");
  const auto noise_of = [&](const char* part, const char* axis) {
    const XmlElement* const of_part = imu != nullptr ? imu->Find(part) : nullptr;
    const XmlElement* const of_axis = of_part != nullptr ? of_part->Find(axis) : nullptr;
    const XmlElement* const noise = of_axis != nullptr ? of_axis->Find("noise") : nullptr;
    return noise != nullptr ? std::clamp(values.Number(*noise, "stddev", 0.0), 0.0, 1e3) : 0.0;
  };
  maker.Number("gyro_noise", noise_of("angular_velocity", "z"));
  maker.Number("acceleration_noise", noise_of("linear_acceleration", "x"));
  return std::move(maker.node);
}

}  // namespace

std::optional<WorldNode> SensorNode(const SensorPart& sensor, const SensorAttachment& mount, Diagnostics& diagnostics) {
  const XmlValues values(sensor.file, diagnostics);
  const std::string type = XmlValues::Attribute(sensor.element, "type");
  if (type == "ray" || type == "gpu_ray" || type == "lidar" || type == "gpu_lidar") {
    return RangerNode(values, sensor, mount);
  }
  if (type == "camera" || type == "depth" || type == "depth_camera" || type == "rgbd" || type == "rgbd_camera" ||
      type == "multicamera" || type == "wideanglecamera" || type == "segmentation_camera") {
    return CameraNode(values, sensor, mount);
  }
  if (type == "imu") return ImuNode(values, sensor, mount);
  if (type == "contact") {
    NodeMaker maker("contact", values.At(sensor.element));
    if (const std::string name = TopicOf(sensor.element, false); !name.empty()) maker.Text("name", name);
    return std::move(maker.node);
  }
  values.Warn(sensor.element, "a sensor of type " + Quoted(type) + " is left out");
  return std::nullopt;
}

}  // namespace troupe
