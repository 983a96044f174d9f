#include "viewer/foxglove/channels.h"

#include <variant>

namespace troupe::foxglove {
namespace {

constexpr const char* kSceneSchema = R"({"title":"foxglove.SceneUpdate","type":"object","properties":{
"deletions":{"type":"array","items":{"type":"object"}},
"entities":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"id":{"type":"string"},
"lifetime":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_locked":{"type":"boolean"},
"metadata":{"type":"array","items":{"type":"object"}},"arrows":{"type":"array","items":{"type":"object"}},
"cubes":{"type":"array","items":{"type":"object"}},"spheres":{"type":"array","items":{"type":"object"}},
"cylinders":{"type":"array","items":{"type":"object"}},"lines":{"type":"array","items":{"type":"object"}},
"triangles":{"type":"array","items":{"type":"object"}},"texts":{"type":"array","items":{"type":"object"}},
"models":{"type":"array","items":{"type":"object"}}}}}}})";

constexpr const char* kTransformsSchema = R"({"title":"foxglove.FrameTransforms","type":"object","properties":{
"transforms":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},
"translation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},
"rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},
"w":{"type":"number"}}}}}}}})";

constexpr const char* kGridSchema = R"({"title":"foxglove.Grid","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"pose":{"type":"object"},"column_count":{"type":"integer"},
"cell_size":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"}}},
"row_stride":{"type":"integer"},"cell_stride":{"type":"integer"},
"fields":{"type":"array","items":{"type":"object","properties":{"name":{"type":"string"},"offset":{"type":"integer"},
"type":{"type":"integer"}}}},
"data":{"type":"string","contentEncoding":"base64"}}})";

constexpr const char* kLogSchema = R"({"title":"foxglove.Log","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"level":{"type":"integer"},"message":{"type":"string"},"name":{"type":"string"},"file":{"type":"string"},
"line":{"type":"integer"}}})";

constexpr const char* kScanSchema = R"({"title":"foxglove.LaserScan","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"pose":{"type":"object"},"start_angle":{"type":"number"},
"end_angle":{"type":"number"},"ranges":{"type":"array","items":{"type":"number"}},
"intensities":{"type":"array","items":{"type":"number"}}}})";

void AddScans(const WorldDescription& world, RobotId robot, std::vector<Channel>& channels) {
  const RobotDescription& description = world.robot(robot);
  for (std::size_t i = 0; i < description.sensors.size(); ++i) {
    const auto* ranger = std::get_if<RangerParameters>(&description.sensors[i].parameters);
    if (ranger == nullptr) continue;
    for (std::size_t k = 0; k < ranger->ray_sensors.size(); ++k) {
      if (ranger->ray_sensors[k].samples < 2 || channels.size() >= kMostScanChannels) continue;
      std::string topic = "/" + description.name + "/" + description.sensors[i].name;
      if (k > 0) topic += "." + std::to_string(k);
      channels.push_back({.id = static_cast<std::uint32_t>(channels.size() + 1),
                          .kind = ChannelKind::kScan,
                          .topic = std::move(topic),
                          .robot = robot,
                          .sensor = i,
                          .scan = k,
                          .frame = description.name});
    }
  }
}

}  // namespace

std::vector<Channel> ChannelsOf(const WorldDescription& world) {
  std::vector<Channel> channels = {{.id = 1, .kind = ChannelKind::kScene, .topic = "/scene"},
                                   {.id = 2, .kind = ChannelKind::kTransforms, .topic = "/tf"},
                                   {.id = 3, .kind = ChannelKind::kMap, .topic = "/map"},
                                   {.id = 4, .kind = ChannelKind::kEvents, .topic = "/events"}};
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (IsThere(world, RobotId(i))) AddScans(world, RobotId(i), channels);
  }
  return channels;
}

const char* SchemaName(ChannelKind kind) {
  switch (kind) {
    case ChannelKind::kScene:
      return "foxglove.SceneUpdate";
    case ChannelKind::kTransforms:
      return "foxglove.FrameTransforms";
    case ChannelKind::kMap:
      return "foxglove.Grid";
    case ChannelKind::kEvents:
      return "foxglove.Log";
    case ChannelKind::kScan:
      return "foxglove.LaserScan";
  }
  return "";
}

const char* Schema(ChannelKind kind) {
  switch (kind) {
    case ChannelKind::kScene:
      return kSceneSchema;
    case ChannelKind::kTransforms:
      return kTransformsSchema;
    case ChannelKind::kMap:
      return kGridSchema;
    case ChannelKind::kEvents:
      return kLogSchema;
    case ChannelKind::kScan:
      return kScanSchema;
  }
  return "";
}

}  // namespace troupe::foxglove
