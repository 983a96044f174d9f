// Signals: what expectations see of a run. One table says how each is written, what it returns and what it means; the
// documentation has the same table. A signal is read from a tick for all its lanes at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "testing/expectations/syntax.h"
#include "testing/expectations/tick_view.h"
#include "troupe/event.h"
#include "troupe/polygon.h"
#include "troupe/vec2.h"

namespace troupe {

// The robustness of a signal that is true or false.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class SignalKind : std::uint8_t {
  kX,
  kY,
  kZ,
  kHeading,
  kSpeed,
  kTurnRate,
  kStalled,
  kDistance,
  kClosestPair,
  kAt,
  kIn,
  kHolds,
  kFalling,
  kResting,
  kAlive,
  kEnergy,
  kCapacity,
  kCharging,
  kJoint,
  kJointSpeed,
  kBlocked,
  kRange,
  kMeanRange,
  kPressed,
  kHeard,
  kPersonDistance,
  kPeopleNear,
  kIntrusionTime,
  kIntrusions,
  kTick,
  kTime,
  kHash,
  kEvent,
  kEventCount,
};

enum class ValueType : std::uint8_t { kNumber, kTruth, kText };

// A parameter is one letter: r robot, o object, b robot or object, d robot, object, static model or place, p place,
// g region, s sensor, j joint, e type of event, x pattern of a text, l length. Those behind "?" may be left out.
struct SignalInfo {
  SignalKind kind;
  const char* name;
  const char* parameters;
  ValueType type;
  Dimension dimension;
  const char* usage;
  const char* meaning;
};
std::span<const SignalInfo> Signals();

// A signal in a program. Bodies are numbered as in Scene: robots, then objects.
struct SignalUse {
  static constexpr std::uint32_t kNone = 0xffffffff;

  SignalKind kind = SignalKind::kTick;
  std::vector<std::uint32_t> subjects = {};  // by lane: bodies
  std::vector<std::uint32_t> others = {};    // by lane: bodies of kDistance and kHolds; empty: `point` or `model`
  std::vector<std::uint32_t> parts = {};     // by lane: joint, store, or sensor of the robot; kNone: none
  Vec2 point{0.0, 0.0};                      // m, in W: a place
  std::optional<ModelId> model = {};         // the root of a static tree
  Polygon region = {};
  double number = 0.0;  // m, radius of kAt, reach of kPeopleNear and of intrusions
  std::string text = {};
  bool negated = false;  // kHash: !=
  EventType event = EventType::kStallBegan;
};

// What a monitor remembers of a signal.
struct SignalMemory {
  std::vector<double> numbers = {};      // counts of events; 1.0 of robots that have left; seconds; intrusions
  std::vector<bool> before = {};         // by lane: people were near at the last tick
  std::vector<ConvexPiece> pieces = {};  // of a static tree
  std::shared_ptr<const std::vector<std::unique_ptr<const Sensor>>> sensors = {};  // by lane
  SensorReading reading = {};
  std::pair<std::uint32_t, std::uint32_t> pair = {0, 0};  // the bodies of kClosestPair
};

// Writes the value of each lane to `values`.
void ReadSignal(const SignalUse& signal, const TickView& tick, SignalMemory& memory, std::span<double> values);

}  // namespace troupe
