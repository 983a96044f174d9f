// The limits of a radio: the agent drops messages beyond them, the world service refuses proposals beyond them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "troupe/radio_message.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

// The bytes that a radio may send in one tick of `interval_seconds`: its bandwidth, rounded down, at most
// kMaxRadioBytes.
std::size_t BytesPerTick(const RadioParameters& radio, double interval_seconds);

// The ticks that its messages are on their way: its delay, rounded up to whole ticks.
Tick DelayTicks(const RadioParameters& radio, double interval_seconds);

// The radio that is number `sensor` of the robot's sensors; null for another kind, or none.
const RadioParameters* FindRadio(const RobotDescription& robot, std::size_t sensor);

// The messages that the robot's radios can send in a tick, in their order; a message that does not fit into the rest of
// its radio's bytes is left out. REQUIRES: each names a radio of the robot.
std::vector<RadioMessage> WithinLimits(const RobotDescription& robot, double interval_seconds,
                                       std::vector<RadioMessage> messages);

// Success if WithinLimits would leave none out. The error is for an event.
Status CheckMessages(const RobotDescription& robot, double interval_seconds, std::span<const RadioMessage> messages);

}  // namespace troupe
