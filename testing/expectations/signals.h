// Signals: what expectations see of a run: the signals of the state's tables (common/signals), and the table here with
// those that no row has: of pairs, of readings, of events and of the whole run. Each entry says how it is written, what
// it returns and what it means; the documentation is printed from the same table (language.cc), so that it cannot
// differ.
//
// A signal is a function of the tick's state and events, and of what the monitor remembers (SignalMemory); never of how
// the run was made. So a live simulation, a replay and a branch have the same values, bit by bit. A signal is read for
// all its lanes at once, with one dispatch. Units are SI: m, s, rad, J; positions are in W.
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

#include "common/signals/state_tables.h"
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
  kTable,  // of the state's tables (common/signals)
  kDistance,
  kClosestPair,
  kAt,
  kIn,
  kHolds,
  kAlive,
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
  kRows,
  kHash,
  kEvent,
  kEventCount,
};

// A signal that no table of the state has: of several things, of readings, of events or of the whole run.
//
// A parameter is one letter: r robot, o object, b robot, object or person, m robot or sensor, d body, static model or
// place, p place, g region, s sensor of the robot, e type of event, t any thing, x pattern of a text, l length. Those
// behind "?" may be left out.
struct SignalInfo {
  SignalKind kind;
  const char* name;
  const char* parameters;
  ValueType type;
  Dimension dimension;
  const char* usage;
  const char* meaning;

  // How many arguments it has.
  std::size_t least() const;
  std::size_t most() const;
};
std::span<const SignalInfo> RunSignals();
const SignalInfo* FindRunSignal(std::string_view name);  // null: there is none

// The tables that have a signal of that name, by their places in StateTables(): those with bodies first.
std::vector<std::size_t> KindsWith(std::string_view signal);

bool IsFunction(std::string_view name);  // "abs", "sqrt", "min", "max", "count"
bool IsSignalOrFunction(std::string_view name);
// Of both, for proposals.
std::vector<std::string> SignalNames();

// A signal in a program.
struct SignalUse {
  static constexpr std::uint32_t kNone = 0xffffffff;

  SignalKind kind = SignalKind::kTick;
  const Signal* column = nullptr;         // kTable: of StateTables(); the subjects are of one kind
  ThingId first = 0;                      // of that kind
  std::vector<ThingId> subjects = {};     // by lane
  std::vector<ThingId> others = {};       // by lane: bodies of kDistance and kHolds; empty: `point` or `model`
  std::vector<std::uint32_t> parts = {};  // by lane: store or sensor of the robot; kNone: none
  Vec2 point{0.0, 0.0};                   // m, in W: a place
  std::optional<ModelId> model = {};      // the root of a static tree
  Polygon region = {};
  // m: the height of the level of the place or region, among the world's levels; nothing: it is at all heights
  std::optional<double> floor = {};
  double number = 0.0;    // m, radius of kAt, reach of kPeopleNear and of intrusions
  std::size_t table = 0;  // of kRows
  std::string text = {};  // that a text is compared with; the pattern of an event's detail
  bool negated = false;   // of a text: !=
  EventType event = EventType::kStallBegan;
  bool operator==(const SignalUse&) const = default;
};

// What a monitor remembers of a signal between ticks: counts, and data that is costly to make and constant (pieces of
// static models, sensors). It is copied with the monitor; the sensors are immutable and shared.
struct SignalMemory {
  std::vector<double> numbers = {};      // counts of events; 1.0 of robots that have left; seconds; intrusions
  std::vector<bool> before = {};         // by lane: people were near at the last tick
  std::vector<ConvexPiece> pieces = {};  // of a static tree
  // By lane of a distance: the first lane with the same two bodies, in any order.
  std::shared_ptr<const std::vector<std::uint32_t>> first_lanes = {};
  std::shared_ptr<const std::vector<std::unique_ptr<const Sensor>>> sensors = {};  // by lane
  SensorReading reading = {};
  std::pair<std::uint32_t, std::uint32_t> pair = {0, 0};  // the bodies of kClosestPair
};

// Writes the value of each lane to `values`. `things`: of the world of the tick.
void ReadSignal(const SignalUse& signal, const Things& things, const TickView& tick, SignalMemory& memory,
                std::span<double> values);

}  // namespace troupe
