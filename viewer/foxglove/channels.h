// The channels of a run for Foxglove: their topics, and the JSON schemas of their messages.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "troupe/ids.h"
#include "troupe/world_description.h"

namespace troupe::foxglove {

enum class ChannelKind : std::uint8_t {
  kScene,       // foxglove.SceneUpdate: the bodies, each in its own frame; once for each world
  kTransforms,  // foxglove.FrameTransforms: the frames of bodies and links
  kMap,         // foxglove.Grid: the static map; once for each world
  kEvents,      // foxglove.Log
  kScan,        // foxglove.LaserScan, of one ray sensor
};

struct Channel {
  std::uint32_t id = 0;
  ChannelKind kind = ChannelKind::kScene;
  std::string topic;
  RobotId robot = {};      // kScan
  std::size_t sensor = 0;  // kScan: of the robot
  std::size_t scan = 0;    // kScan: of the sensor
  std::string frame = {};  // kScan: of the ray sensor
};

inline constexpr std::size_t kMostScanChannels = 500;

// Ids count from 1. Scans have a topic for each ray sensor with several rays: /NAME/RANGER or /NAME/RANGER.1.
std::vector<Channel> ChannelsOf(const WorldDescription& world);

// "foxglove.SceneUpdate"
const char* SchemaName(ChannelKind kind);
// A JSON schema, as text.
const char* Schema(ChannelKind kind);

}  // namespace troupe::foxglove
