// The messages of the channels for Foxglove, as JSON text. Frames: `map` is W; NAME is a robot's or an object's root
// model, NAME/JOINT the link that a joint moves.
#pragma once

#include <cstdint>
#include <string>

#include "common/spatial/scene.h"
#include "troupe/event.h"
#include "troupe/sensor.h"
#include "troupe/world_state.h"

namespace troupe::foxglove {

// Simulated time, ns.
using Time = std::uint64_t;

inline constexpr std::size_t kMostStaticPieces = 20'000;  // of the static map in a scene; the rest is in /map only

std::string SceneText(const Scene& scene, Time time);
std::string TransformsText(const Scene& scene, const WorldState& state, Time time);
std::string MapText(const Scene& scene, Time time);
std::string EventText(const std::string& text, bool warning, Time time);
// `frame`: of the robot.
std::string ScanText(const RangeScan& scan, const std::string& frame, Time time);

}  // namespace troupe::foxglove
