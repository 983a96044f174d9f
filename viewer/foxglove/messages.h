// The messages of the channels for Foxglove, as JSON text: those of its own schemas, and the tables of things
// (common/signals) with a schema each, "troupe.doors". Frames: `map` is W; NAME is a robot's or an object's root
// model, NAME/JOINT the link that a joint moves.
//
// JSON with schemas, because Foxglove reads it without a plug-in, and it is used for a few clients at a few updates a
// second. Pure functions of scene and state, so the exporter of recordings (launcher/export) and the live gateway have
// the same bytes. Bodies are sent once per world, each in its own frame; updates have transforms alone.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/signals/state_tables.h"
#include "common/spatial/scene.h"
#include "troupe/event.h"
#include "troupe/ids.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::foxglove {

// Simulated time, ns.
using Time = std::uint64_t;

inline constexpr std::size_t kMaxStaticPieces = 20'000;  // of the static map in a scene; the rest is in /map only

std::string SceneText(const Scene& scene, Time time);
std::string TransformsText(const Scene& scene, const WorldState& state, Time time);
std::string MapText(const Scene& scene, Time time);
std::string EventText(const std::string& text, bool warning, Time time);
// `frame`: of the robot.
std::string ScanText(const RangeScan& scan, const std::string& frame, Time time);

// {"timestamp", "rows": [{"name": "lobby_door", "opening": 0.5, ...}, ...]}: the things that exist, with their signals.
// A signal that a thing has not is null.
std::string TableText(const StateTable& table, const SignalView& view, Time time);

// JSON in the form of Foxglove's schemas.

using Json = nlohmann::json;

// {"sec": 1, "nsec": 500000000}
inline Json TimeOf(Time time) {
  constexpr Time kSecond = 1'000'000'000;
  return {{"sec", time / kSecond}, {"nsec", time % kSecond}};
}

// Names need not be UTF-8.
inline std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// The channels of a run for Foxglove: their topics, and the JSON schemas of their messages.

enum class ChannelKind : std::uint8_t {
  kScene,       // foxglove.SceneUpdate: the bodies, each in its own frame; once for each world
  kTransforms,  // foxglove.FrameTransforms: the frames of bodies and links
  kMap,         // foxglove.Grid: the static map; once for each world
  kEvents,      // foxglove.Log
  kScan,        // foxglove.LaserScan, of one ray sensor
  kTable,       // troupe.TABLE: the rows of a table of things
};

struct Channel {
  std::uint32_t id = 0;
  ChannelKind kind = ChannelKind::kScene;
  std::string topic;
  RobotId robot = {};                 // kScan
  std::size_t sensor = 0;             // kScan: of the robot
  std::size_t scan = 0;               // kScan: of the sensor
  std::string frame = {};             // kScan: of the ray sensor
  const StateTable* table = nullptr;  // kTable
};

inline constexpr std::size_t kMaxScanChannels = 500;

// Ids count from 1. Scans have a topic for each ray sensor with several rays: /NAME/RANGER or /NAME/RANGER.1. Each
// table that has things in the world, and each whose rows come and go, has a topic: /tables/doors.
std::vector<Channel> ChannelsOf(const WorldDescription& world);

// "foxglove.SceneUpdate"
std::string SchemaName(const Channel& channel);
// A JSON schema, as text.
std::string Schema(const Channel& channel);

}  // namespace troupe::foxglove
