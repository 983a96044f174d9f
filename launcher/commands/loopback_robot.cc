#include "launcher/commands/loopback_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/base/xml_text.h"
#include "worldfile/text/text_file.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {
namespace {

constexpr double kMostSamples = 100'000.0;  // rays of a scan
constexpr const char* kNode = "loopback_simulator";

class ParameterReader {
 public:
  explicit ParameterReader(const std::string& path) : yaml_(path, diagnostics_) {}

  Result<ReadParameters> Read(const std::string& text) {
    const YamlNode& root = yaml_.Read(text, kNode);
    if (yaml_.failed()) return *diagnostics_.error();
    ReadParameters read;
    // Those of the node come after those of all nodes, whatever their order.
    for (const char* node : {"/**", kNode}) ReadNode(YamlReader::Find(root, node), read.parameters);
    if (yaml_.failed()) return *diagnostics_.error();
    const LoopbackParameters& p = read.parameters;
    if (!(p.range_min < p.range_max) || !(p.angle_min < p.angle_max)) {
      yaml_.Fail(YamlReader::Find(root, kNode),
                 "found a scan without ranges or angles, expected a minimum below the maximum");
    } else if ((p.angle_max - p.angle_min) / p.angle_increment >= kMostSamples) {
      yaml_.Fail(YamlReader::Find(root, kNode),
                 "found a scan_angle_increment for more than 100000 rays, expected a larger one");
    }
    if (yaml_.failed()) return *diagnostics_.error();
    read.warnings = std::move(diagnostics_.warnings());
    return read;
  }

 private:
  // The name of the node is above `ros__parameters`, perhaps once more, as for costmaps.
  void ReadNode(const YamlNode& node, LoopbackParameters& p) {
    const YamlNode& again = YamlReader::Find(node, kNode);
    const YamlNode& map = YamlReader::Find(again ? again : node, "ros__parameters");
    if (!map) return;
    const auto number = [&](const char* key, double& value, double min, double max) {
      value = yaml_.Number(YamlReader::Find(map, key), std::string("'") + key + "'", value, min, max);
    };
    const auto flag = [&](const char* key, bool& value) {
      value = yaml_.Flag(YamlReader::Find(map, key), std::string("'") + key + "'", value);
    };
    const auto frame = [&](const char* key, std::string& value) {
      const YamlNode& found = YamlReader::Find(map, key);
      value = yaml_.Text(found, std::string("'") + key + "'", value);
      if (found && value.empty())
        yaml_.Fail(found, std::string("found an empty '") + key + "', expected the name of a frame");
    };
    number("update_duration", p.update_duration, 0.001, 10.0);
    frame("base_frame_id", p.base_frame);
    frame("scan_frame_id", p.scan_frame);
    flag("enable_stamped_cmd_vel", p.stamped_commands);
    number("scan_publish_dur", p.scan_period, 0.001, 1000.0);
    if (const YamlNode& rate = YamlReader::Find(map, "scan_publish_rate")) {
      p.scan_period = 1.0 / yaml_.Number(rate, "'scan_publish_rate'", 10.0, 0.001, 1000.0);
    }
    number("scan_range_min", p.range_min, 0.0, 1e4);
    number("scan_range_max", p.range_max, 0.01, 1e4);
    number("scan_angle_min", p.angle_min, -6.3, 6.3);
    number("scan_angle_max", p.angle_max, -6.3, 6.3);
    number("scan_angle_increment", p.angle_increment, 1e-4, 3.2);
    flag("scan_use_inf", p.infinite_ranges);
    flag("publish_scan", p.publishes_scan);
    flag("publish_map_odom_tf", p.publishes_map_to_odom);
    number("speed_factor", p.speed, 0.001, 1e6);
    const auto is_fixed = [&](const char* key, const char* value) {
      const YamlNode& found = YamlReader::Find(map, key);
      if (found && found.text != value) {
        yaml_.Warn(found,
                   fmt::format("found {} for '{}', expected '{}', which it is here", Quoted(found.text), key, value));
      }
    };
    is_fixed("map_frame_id", "map");
    is_fixed("odom_frame_id", "odom");
    const YamlNode& clock = YamlReader::Find(map, "publish_clock");
    if (clock && !yaml_.Flag(clock, "'publish_clock'", true)) {
      yaml_.Warn(clock, "found 'publish_clock' false, expected true; the clock is published");
    }
  }

  Diagnostics diagnostics_;
  YamlReader yaml_;
};

}  // namespace

Result<ReadParameters> ReadLoopbackParameters(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path, {path});
  if (!text.ok()) return text.error();
  return ParameterReader(path).Read(text.value());
}

std::string LoopbackRobot(const LoopbackParameters& parameters) {
  const LoopbackParameters& p = parameters;
  const std::string base = XmlText(p.base_frame);
  const std::string scan = XmlText(p.scan_frame);
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"robot\">\n  <link name=\"{}\"/>\n", base);
  // Between the base on the floor and the body, as configurations expect it.
  const std::string body = p.base_frame == "base_link" ? "body" : "base_link";
  text += fmt::format(
      "  <link name=\"{0}\"><collision><origin xyz=\"0 0 0.07\"/><geometry><cylinder radius=\"0.11\" "
      "length=\"0.12\"/></geometry>"
      "</collision></link>\n  <joint name=\"base_joint\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}\"/>"
      "<origin xyz=\"0 0 0.01\"/></joint>\n",
      body, base);
  text += fmt::format(
      "  <link name=\"{0}\"/>\n  <joint name=\"scan_joint\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}\"/>"
      "<origin xyz=\"0 0 0.17\"/></joint>\n",
      scan, body);
  text +=
      "  <gazebo><plugin filename=\"gz-sim-velocity-control-system\" "
      "name=\"gz::sim::systems::VelocityControl\"/></gazebo>\n";
  if (p.publishes_scan) {
    // The last ray is at the maximum or before it, as there.
    const double samples = std::floor((p.angle_max - p.angle_min) / p.angle_increment + 1e-9) + 1.0;
    text += fmt::format(
        "  <gazebo reference=\"{}\"><sensor name=\"scan\" type=\"gpu_lidar\"><topic>scan</topic>"
        "<update_rate>{}</update_rate><lidar><scan><horizontal><samples>{}</samples><min_angle>{}</min_angle>"
        "<max_angle>{}</max_angle></horizontal></scan><range><min>{}</min><max>{}</max></range></lidar></sensor></"
        "gazebo>\n",
        scan, 1.0 / p.scan_period, samples, p.angle_min, p.angle_min + (samples - 1.0) * p.angle_increment, p.range_min,
        p.range_max);
  }
  return text + "</robot>\n";
}

}  // namespace troupe
