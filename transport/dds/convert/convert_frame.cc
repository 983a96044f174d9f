#include "transport/dds/convert/convert_frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "transport/dds/convert/convert_robot_command.h"

namespace troupe::dds {
namespace {

constexpr std::uint8_t kSetBit = 1;
constexpr std::uint8_t kLastEventType = static_cast<std::uint8_t>(troupe::kLastEventType);
constexpr std::uint8_t kLastObjectMode = static_cast<std::uint8_t>(ObjectMode::kHeld);
constexpr std::int32_t kNone = -1;
constexpr std::size_t kAnyId = std::numeric_limits<std::int32_t>::max();

template <typename Id>
std::int32_t ToWire(const std::optional<Id>& id) {
  return id ? static_cast<std::int32_t>(id->index()) : kNone;
}

// REQUIRES: id >= kNone
template <typename Id>
std::optional<Id> FromWire(std::int32_t id) {
  if (id == kNone) return std::nullopt;
  return Id(static_cast<std::size_t>(id));
}

// Whether it is an id below `count`, or none.
bool IsIdBelow(std::int32_t id, std::size_t count) {
  return id >= kNone && (id == kNone || static_cast<std::size_t>(id) < count);
}

// Conversions of one field of a row, which `field` returns, to its value on the wire and back. Set returns false if the
// value is not a valid one.
template <typename Field>
struct Number {
  Field field;
  template <typename Row>
  double Get(const Row& row) const {
    return field(row);
  }
  template <typename Row>
  bool Set(Row& row, double value) const {
    field(row) = value;
    return std::isfinite(value);
  }
};

template <typename Field>
struct Flag {
  Field field;
  template <typename Row>
  std::uint8_t Get(const Row& row) const {
    return field(row) ? kSetBit : 0;
  }
  template <typename Row>
  bool Set(Row& row, std::uint8_t value) const {
    field(row) = value != 0;
    return (value & ~kSetBit) == 0;
  }
};

template <typename Field>
struct OptionalId {
  Field field;
  std::size_t count;  // valid ids are below it
  template <typename Row>
  std::int32_t Get(const Row& row) const {
    return ToWire(field(row));
  }
  template <typename Row>
  bool Set(Row& row, std::int32_t value) const {
    using Id = typename std::remove_reference_t<decltype(field(row))>::value_type;
    if (!IsIdBelow(value, count)) return false;
    field(row) = FromWire<Id>(value);
    return true;
  }
};

struct Mode {
  std::uint8_t Get(const ObjectState& object) const { return static_cast<std::uint8_t>(object.mode); }
  bool Set(ObjectState& object, std::uint8_t value) const {
    object.mode = static_cast<ObjectMode>(value);
    return value <= kLastObjectMode;
  }
};

// Guides that C++20 derives by itself, but not clang 14.
template <typename Field>
Number(Field) -> Number<Field>;
template <typename Field>
Flag(Field) -> Flag<Field>;
template <typename Field>
OptionalId(Field, std::size_t) -> OptionalId<Field>;

#define TROUPE_FIELD(expression) ([](auto& row) -> auto& { return row.expression; })

// The columns of each kind of row, for writing and for reading: calls visit(column, value).
template <typename Wire, typename Visit>
void VisitRobots(Wire& wire, Visit& visit) {
  visit(wire.x, Number{TROUPE_FIELD(X_WR.x)});
  visit(wire.y, Number{TROUPE_FIELD(X_WR.y)});
  visit(wire.z, Number{TROUPE_FIELD(X_WR.z)});
  visit(wire.heading, Number{TROUPE_FIELD(X_WR.heading)});
  visit(wire.vx, Number{TROUPE_FIELD(twist.vx)});
  visit(wire.vy, Number{TROUPE_FIELD(twist.vy)});
  visit(wire.wz, Number{TROUPE_FIELD(twist.wz)});
  visit(wire.flags, Flag{TROUPE_FIELD(stalled)});
}

template <typename Wire, typename Visit>
void VisitJoints(Wire& wire, Visit& visit) {
  visit(wire.joint_position, Number{TROUPE_FIELD(position)});
  visit(wire.joint_velocity, Number{TROUPE_FIELD(velocity)});
  visit(wire.joint_flags, Flag{TROUPE_FIELD(blocked)});
}

template <typename Wire, typename Visit>
void VisitGrippers(Wire& wire, std::size_t objects, Visit& visit) {
  visit(wire.gripper_left_contact, OptionalId{TROUPE_FIELD(left_contact), kAnyId});
  visit(wire.gripper_right_contact, OptionalId{TROUPE_FIELD(right_contact), kAnyId});
  visit(wire.gripper_clamped, OptionalId{TROUPE_FIELD(clamped), objects});
}

template <typename Wire, typename Visit>
void VisitObjects(Wire& wire, std::size_t grippers, Visit& visit) {
  visit(wire.object_x, Number{TROUPE_FIELD(X_WO.x)});
  visit(wire.object_y, Number{TROUPE_FIELD(X_WO.y)});
  visit(wire.object_z, Number{TROUPE_FIELD(X_WO.z)});
  visit(wire.object_heading, Number{TROUPE_FIELD(X_WO.heading)});
  visit(wire.object_mode, Mode{});
  visit(wire.object_fall_speed, Number{TROUPE_FIELD(fall_speed)});
  visit(wire.object_holder, OptionalId{TROUPE_FIELD(holder), grippers});
  visit(wire.object_support, OptionalId{TROUPE_FIELD(support), kAnyId});
}

template <typename Wire, typename Visit>
void VisitStores(Wire& wire, Visit& visit) {
  visit(wire.store_joules, Number{TROUPE_FIELD(joules)});
  visit(wire.store_charge, Number{TROUPE_FIELD(charge_watts)});
}

template <typename Wire, typename Visit>
void VisitImus(Wire& wire, Visit& visit) {
  visit(wire.imu_vx, Number{TROUPE_FIELD(vx)});
  visit(wire.imu_vy, Number{TROUPE_FIELD(vy)});
  visit(wire.imu_vz, Number{TROUPE_FIELD(vz)});
}

template <typename Wire, typename Visit>
void VisitLights(Wire& wire, Visit& visit) {
  visit(wire.light_flags, Flag{TROUPE_FIELD(is_switched_on)});
}

template <typename Wire, typename Visit>
void VisitCameras(Wire& wire, Visit& visit) {
  visit(wire.camera_pan, Number{TROUPE_FIELD(pan)});
  visit(wire.camera_tilt, Number{TROUPE_FIELD(tilt)});
}

#undef TROUPE_FIELD

// Compares bits: -0.0 differs from 0.0, because a replica must have the same bits.
template <typename Value>
bool IsSame(Value a, Value b) {
  if constexpr (std::is_same_v<Value, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else {
    return a == b;
  }
}

// Finds the rows and the columns in which anything has changed.
template <typename Row>
class ChangeFinder {
 public:
  // `before`: as many rows; null: all rows and columns count as changed.
  ChangeFinder(const std::vector<Row>& now, const std::vector<Row>* before)
      : now_(now), before_(before), row_changed_(now.size(), before == nullptr) {}

  template <typename Column, typename Value>
  void operator()(const Column&, const Value& value) {
    bool changed = before_ == nullptr;
    for (std::size_t i = 0; i < now_.size() && before_ != nullptr; ++i) {
      if (IsSame(value.Get(now_[i]), value.Get((*before_)[i]))) continue;
      row_changed_[i] = true;
      changed = true;
    }
    column_changed_.push_back(changed);
  }

  std::vector<std::uint32_t> rows() const {
    std::vector<std::uint32_t> rows;
    for (std::size_t i = 0; i < row_changed_.size(); ++i) {
      if (row_changed_[i]) rows.push_back(static_cast<std::uint32_t>(i));
    }
    return rows;
  }
  const std::vector<bool>& column_changed() const { return column_changed_; }

 private:
  const std::vector<Row>& now_;
  const std::vector<Row>* before_;
  std::vector<bool> row_changed_;
  std::vector<bool> column_changed_;  // in the order of the visits
};

// Fills the columns with the changes that a ChangeFinder has found.
template <typename Row>
class ColumnWriter {
 public:
  ColumnWriter(const std::vector<Row>& now, const ChangeFinder<Row>& changes, WireArena& arena)
      : now_(now), changes_(changes), rows_(changes.rows()), arena_(arena) {}

  template <typename Sequence>
  void WriteRowNumbers(Sequence& sequence) const {
    if (rows_.size() < now_.size()) std::copy(rows_.begin(), rows_.end(), arena_.Fill(sequence, rows_.size()));
  }

  template <typename Column, typename Value>
  void operator()(Column& column, const Value& value) {
    if (!changes_.column_changed()[next_column_++]) return;
    auto* out = arena_.Fill(column, rows_.size());
    for (const std::uint32_t row : rows_) *out++ = value.Get(now_[row]);
  }

 private:
  const std::vector<Row>& now_;
  const ChangeFinder<Row>& changes_;
  std::vector<std::uint32_t> rows_;
  std::size_t next_column_ = 0;
  WireArena& arena_;
};

// `visit_columns(visitor)` visits the columns of the rows.
template <typename Row, typename Sequence, typename VisitColumns>
void RowsToWire(const std::vector<Row>& now, const std::vector<Row>* before, Sequence& row_numbers, WireArena& arena,
                VisitColumns visit_columns) {
  if (now.empty()) return;
  ChangeFinder<Row> changes(now, before);
  visit_columns(changes);
  ColumnWriter<Row> writer(now, changes, arena);
  writer.WriteRowNumbers(row_numbers);
  visit_columns(writer);
}

// Copies columns into rows.
template <typename Row>
class ColumnReader {
 public:
  ColumnReader(const char* what, bool whole, std::span<const std::uint32_t> numbers, std::vector<Row>& rows)
      : what_(what), whole_(whole), numbers_(numbers), rows_(rows) {
    if (whole && !numbers.empty()) Fail("row numbers though it is whole");
    for (const std::uint32_t number : numbers) {
      if (number >= rows.size()) Fail("a row that the world does not have");
    }
  }

  template <typename Column, typename Value>
  void operator()(const Column& column, const Value& value) {
    const auto values = Elements(column);
    if (!problem_.ok() || (!whole_ && values.empty())) return;  // of which nothing has changed
    if (whole_ && !sized_) rows_.resize(values.size());
    sized_ = true;
    if (values.size() != (numbers_.empty() ? rows_.size() : numbers_.size())) {
      return Fail("columns of different lengths");
    }
    bool fine = true;
    if (numbers_.empty()) {
      for (std::size_t i = 0; i < values.size(); ++i) fine &= value.Set(rows_[i], values[i]);
    } else {
      for (std::size_t i = 0; i < values.size(); ++i) fine &= value.Set(rows_[numbers_[i]], values[i]);
    }
    if (!fine) Fail("a value that is not finite or not known");
  }

  const Status& problem() const { return problem_; }

 private:
  void Fail(const std::string& problem) {
    if (problem_.ok()) problem_ = Error{{}, "frame with " + problem + ", for its " + what_};
  }

  const char* what_;
  bool whole_;
  bool sized_ = false;
  std::span<const std::uint32_t> numbers_;
  std::vector<Row>& rows_;
  Status problem_;
};

Status StateFromWire(const troupe_wire_Frame& wire, WorldState& state) {
  // Counted first, because grippers refer to objects, which follow them in the frame.
  const std::size_t objects = wire.whole ? Elements(wire.object_x).size() : state.objects.size();
  const std::size_t grippers = wire.whole ? Elements(wire.gripper_left_contact).size() : state.grippers.size();
  ColumnReader robot_reader("robots", wire.whole, Elements(wire.robot_row), state.robots);
  VisitRobots(wire, robot_reader);
  ColumnReader joint_reader("joints", wire.whole, Elements(wire.joint_row), state.joints);
  VisitJoints(wire, joint_reader);
  ColumnReader gripper_reader("grippers", wire.whole, Elements(wire.gripper_row), state.grippers);
  VisitGrippers(wire, objects, gripper_reader);
  ColumnReader object_reader("objects", wire.whole, Elements(wire.object_row), state.objects);
  VisitObjects(wire, grippers, object_reader);
  ColumnReader store_reader("stores of energy", wire.whole, Elements(wire.store_row), state.stores);
  VisitStores(wire, store_reader);
  ColumnReader imu_reader("inertial measurement units", wire.whole, Elements(wire.imu_row), state.imus);
  VisitImus(wire, imu_reader);
  ColumnReader light_reader("lights", wire.whole, Elements(wire.light_row), state.lights);
  VisitLights(wire, light_reader);
  ColumnReader camera_reader("cameras", wire.whole, Elements(wire.camera_row), state.cameras);
  VisitCameras(wire, camera_reader);
  for (const Status& problem :
       {robot_reader.problem(), joint_reader.problem(), gripper_reader.problem(), object_reader.problem(),
        store_reader.problem(), imu_reader.problem(), light_reader.problem(), camera_reader.problem()}) {
    if (!problem.ok()) return problem;
  }
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    if ((state.objects[i].mode == ObjectMode::kHeld) != state.objects[i].holder.has_value()) {
      return Error{{},
                   "frame with object " + std::to_string(i) +
                       (state.objects[i].holder ? " that has a holder but is not held" : " held without a holder")};
    }
  }
  return {};
}

void TransmissionsToWire(const std::vector<RadioTransmission>& transmissions, troupe_wire_Frame& wire,
                         WireArena& arena) {
  const std::size_t count = transmissions.size();
  if (count == 0) return;
  std::size_t bytes = 0;
  for (const RadioTransmission& transmission : transmissions) bytes += transmission.message.bytes.size();
  std::uint32_t* from = arena.Fill(wire.message_from, count);
  std::uint64_t* sent = arena.Fill(wire.message_sent, count);
  std::uint64_t* due = arena.Fill(wire.message_due, count);
  std::uint32_t* number = arena.Fill(wire.message_number, count);
  std::uint32_t* radio = arena.Fill(wire.message_radio, count);
  std::int32_t* to = arena.Fill(wire.message_to, count);
  std::uint32_t* length = arena.Fill(wire.message_length, count);
  std::uint8_t* content = arena.Fill(wire.message_bytes, bytes);
  for (const RadioTransmission& transmission : transmissions) {
    *from++ = static_cast<std::uint32_t>(transmission.from.index());
    *sent++ = transmission.sent;
    *due++ = transmission.due;
    *number++ = static_cast<std::uint32_t>(transmission.number);
    *radio++ = static_cast<std::uint32_t>(transmission.message.radio);
    *to++ = ToWire(transmission.message.to);
    *length++ = static_cast<std::uint32_t>(transmission.message.bytes.size());
    content = std::copy(transmission.message.bytes.begin(), transmission.message.bytes.end(), content);
  }
}

Status TransmissionsFromWire(const troupe_wire_Frame& wire, WorldState& state) {
  const auto from = Elements(wire.message_from);
  const auto sent = Elements(wire.message_sent);
  const auto due = Elements(wire.message_due);
  const auto number = Elements(wire.message_number);
  const auto radio = Elements(wire.message_radio);
  const auto to = Elements(wire.message_to);
  const auto length = Elements(wire.message_length);
  auto bytes = Elements(wire.message_bytes);
  if (!SameLength(from, sent, due, number, radio, to, length)) {
    return Error{{}, "frame with columns of radio messages of different lengths, expected one row for each"};
  }
  state.transmissions.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i] >= state.robots.size() || !IsIdBelow(to[i], state.robots.size()) || length[i] > bytes.size()) {
      return Error{{}, "frame with a radio message of unknown robots, or of more bytes than it has"};
    }
    RadioTransmission& transmission = state.transmissions[i];
    transmission.from = RobotId(from[i]);
    transmission.sent = sent[i];
    transmission.due = due[i];
    transmission.number = number[i];
    transmission.message.radio = radio[i];
    transmission.message.to = FromWire<RobotId>(to[i]);
    const auto own = bytes.first(length[i]);
    transmission.message.bytes.assign(own.begin(), own.end());
    bytes = bytes.subspan(length[i]);
  }
  if (!bytes.empty()) return Error{{}, "frame with more bytes of radio messages than their lengths say"};
  return {};
}

void EventsToWire(const std::vector<Event>& events, troupe_wire_Frame& wire, WireArena& arena) {
  const std::size_t count = events.size();
  std::uint8_t* type = arena.Fill(wire.event_type, count);
  std::int32_t* robot = arena.Fill(wire.event_robot, count);
  std::int32_t* other = arena.Fill(wire.event_other, count);
  std::int32_t* object = arena.Fill(wire.event_object, count);
  char** detail = arena.Fill(wire.event_detail, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Event& event = events[i];
    type[i] = static_cast<std::uint8_t>(event.type);
    robot[i] = ToWire(event.robot);
    other[i] = ToWire(event.other);
    object[i] = ToWire(event.object);
    detail[i] = arena.Copy(event.detail);
  }
}

Status EventsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<Event>& events) {
  const auto type = Elements(wire.event_type);
  const auto robot = Elements(wire.event_robot);
  const auto other = Elements(wire.event_other);
  const auto object = Elements(wire.event_object);
  const auto detail = Elements(wire.event_detail);
  const std::size_t count = type.size();
  if (!SameLength(type, robot, other, object, detail)) {
    return Error{{}, "frame with event columns of different lengths, expected one row for each event"};
  }
  events.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (type[i] > kLastEventType) return Error{{}, "frame with an event of unknown type " + std::to_string(type[i])};
    if (!IsIdBelow(robot[i], robots) || other[i] < kNone || object[i] < kNone) {
      return Error{{},
                   "frame with an event of robot " + std::to_string(robot[i]) + " and models " +
                       std::to_string(other[i]) + " and " + std::to_string(object[i]) +
                       ", expected ids of this world or -1"};
    }
    events[i].tick = wire.tick;
    events[i].type = static_cast<EventType>(type[i]);
    events[i].robot = FromWire<RobotId>(robot[i]);
    events[i].other = FromWire<ModelId>(other[i]);
    events[i].object = FromWire<ModelId>(object[i]);
    events[i].detail = Text(detail[i]);
  }
  return {};
}

void CommandsToWire(const std::vector<RobotCommand>& commands, troupe_wire_Frame& wire, WireArena& arena) {
  troupe_wire_RobotCommand* out = arena.Fill(wire.commands, commands.size());
  for (const RobotCommand& command : commands) *out++ = dds::ToWire(command, arena);
}

Status CommandsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<RobotCommand>& commands) {
  commands.clear();
  for (const troupe_wire_RobotCommand& element : Elements(wire.commands)) {
    if (element.robot >= robots || (!commands.empty() && element.robot <= commands.back().robot.index())) {
      return Error{{}, "frame with a command of robot " + std::to_string(element.robot) + ", expected ascending ids"};
    }
    Result<RobotCommand> command = dds::FromWire(element);
    if (!command.ok()) return command.error();
    commands.push_back(std::move(command).value());
  }
  return {};
}

}  // namespace

troupe_wire_Frame ToWire(const FrameMessage& message, const WorldState* before, WireArena& arena) {
  troupe_wire_Frame wire{};
  wire.run = message.run;
  wire.tick = message.state.tick;
  wire.state_hash = message.state_hash;
  wire.last = message.last;
  wire.paused = message.paused;
  wire.edition = message.edition;
  wire.world_edition = message.world_edition;
  wire.fresh_edition = message.fresh_edition;
  wire.incarnation = message.incarnation;
  wire.remembered = message.remembered;
  std::copy(message.awaited.begin(), message.awaited.end(), arena.Fill(wire.awaited, message.awaited.size()));
  wire.whole = before == nullptr;
  const WorldState& now = message.state;
  const auto of = [before](auto rows) { return before == nullptr ? nullptr : &(before->*rows); };
  RowsToWire(now.robots, of(&WorldState::robots), wire.robot_row, arena,
             [&](auto& visitor) { VisitRobots(wire, visitor); });
  RowsToWire(now.joints, of(&WorldState::joints), wire.joint_row, arena,
             [&](auto& visitor) { VisitJoints(wire, visitor); });
  RowsToWire(now.grippers, of(&WorldState::grippers), wire.gripper_row, arena,
             [&](auto& visitor) { VisitGrippers(wire, now.objects.size(), visitor); });
  RowsToWire(now.objects, of(&WorldState::objects), wire.object_row, arena,
             [&](auto& visitor) { VisitObjects(wire, now.grippers.size(), visitor); });
  RowsToWire(now.stores, of(&WorldState::stores), wire.store_row, arena,
             [&](auto& visitor) { VisitStores(wire, visitor); });
  RowsToWire(now.imus, of(&WorldState::imus), wire.imu_row, arena, [&](auto& visitor) { VisitImus(wire, visitor); });
  RowsToWire(now.lights, of(&WorldState::lights), wire.light_row, arena,
             [&](auto& visitor) { VisitLights(wire, visitor); });
  RowsToWire(now.cameras, of(&WorldState::cameras), wire.camera_row, arena,
             [&](auto& visitor) { VisitCameras(wire, visitor); });
  TransmissionsToWire(now.transmissions, wire, arena);
  EventsToWire(message.events, wire, arena);
  CommandsToWire(message.commands, wire, arena);
  return wire;
}

troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena) {
  return ToWire(message, nullptr, arena);
}

bool CanRead(const troupe_wire_Frame& wire, const FrameMessage& message) {
  return wire.whole ||
         (message.run == wire.run && message.edition == wire.edition && message.state.tick + 1 == wire.tick);
}

Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message) {
  message.run = wire.run;
  message.state.tick = wire.tick;
  message.state_hash = wire.state_hash;
  message.last = wire.last;
  message.paused = wire.paused;
  message.edition = wire.edition;
  message.world_edition = wire.world_edition;
  message.fresh_edition = wire.fresh_edition;
  message.incarnation = wire.incarnation;
  message.remembered = wire.remembered;
  const auto awaited = Elements(wire.awaited);
  message.awaited.assign(awaited.begin(), awaited.end());
  Status problem = StateFromWire(wire, message.state);
  if (problem.ok()) problem = TransmissionsFromWire(wire, message.state);
  if (problem.ok()) problem = EventsFromWire(wire, message.state.robots.size(), message.events);
  if (problem.ok()) problem = CommandsFromWire(wire, message.state.robots.size(), message.commands);
  if (!problem.ok()) message = {};  // changes since it would have no base
  return problem;
}

}  // namespace troupe::dds
