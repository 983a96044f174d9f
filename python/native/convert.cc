#include "python/native/convert.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {
namespace {

using namespace py::literals;

std::string TypeName(py::handle value) {
  return Py_TYPE(value.ptr())->tp_name;
}

template <typename... Values>
py::object Make(const char* record, Values&&... values) {
  return Record(record)(std::forward<Values>(values)...);
}

template <typename Rows, typename Convert>
py::tuple ToTuple(const Rows& rows, Convert&& convert) {
  py::tuple tuple(rows.size());
  std::size_t i = 0;
  for (const auto& row : rows) tuple[i++] = convert(row);
  return tuple;
}

template <typename Tag>
py::object Number(const std::optional<Id<Tag>>& id) {
  return id ? py::object(py::int_(id->index())) : py::none();
}

template <typename Value>
py::object Optional(const std::optional<Value>& value) {
  return value ? py::cast(*value) : py::none();
}

py::object Name(const std::optional<SeenModel>& model) {
  return model ? py::object(py::str(model->name.data(), model->name.size())) : py::none();
}

py::str Text(std::string_view text) {
  return py::str(text.data(), text.size());
}

py::ssize_t Size(std::size_t size) {
  return static_cast<py::ssize_t>(size);
}

// Rows of readings are records of their fields (troupe/fields.h), by name: the record (troupe/records.py) says which it
// has, and in which order. Ranges and images are arrays, and come below.

// The member of a record that is no field, or another value than the field of its name; null for the others.
template <typename Row>
py::object OwnMember(const Row& row, std::string_view name) {
  if constexpr (std::is_same_v<Row, Fiducial>) {
    if (name == "pose") return ToRecord(row.X_SF);
    if (name == "size") return py::make_tuple(row.size_x, row.size_y, row.size_z);
  } else if constexpr (std::is_same_v<Row, FiducialReading>) {
    if (name == "min") return py::float_(row.limits.min);
    if (name == "max") return py::float_(row.limits.max);
  } else if constexpr (std::is_same_v<Row, BumperReading::Segment>) {
    if (name == "pressed") return py::bool_(row.pressed_by.has_value());
  } else if constexpr (std::is_same_v<Row, BodyContact>) {
    if (name == "x") return py::float_(row.point.x());
    if (name == "y") return py::float_(row.point.y());
  } else if constexpr (std::is_same_v<Row, RadioReception>) {
    if (name == "sender") return py::int_(row.from.index());
    if (name == "data") return py::bytes(reinterpret_cast<const char*>(row.bytes.data()), row.bytes.size());
  } else if constexpr (std::is_same_v<Row, ImuReading>) {
    if (name == "force") return py::make_tuple(row.force_xy.x(), row.force_xy.y(), row.force_z);
  }
  return {};
}

// The names of records, by the type of their rows.
template <typename Row>
constexpr std::string_view kRecord = {};
// clang-format off
template <> constexpr std::string_view kRecord<BreakBeamReading> = "BreakBeamReading";
template <> constexpr std::string_view kRecord<BreakBeamReading::Beam> = "Beam";
template <> constexpr std::string_view kRecord<FiducialReading> = "FiducialReading";
template <> constexpr std::string_view kRecord<Fiducial> = "Fiducial";
template <> constexpr std::string_view kRecord<BumperReading> = "BumperReading";
template <> constexpr std::string_view kRecord<BumperReading::Segment> = "BumperSegment";
template <> constexpr std::string_view kRecord<ContactReading> = "ContactReading";
template <> constexpr std::string_view kRecord<BodyContact> = "Contact";
template <> constexpr std::string_view kRecord<BlobfinderReading> = "BlobfinderReading";
template <> constexpr std::string_view kRecord<Blob> = "Blob";
template <> constexpr std::string_view kRecord<RadioReading> = "RadioReading";
template <> constexpr std::string_view kRecord<RadioReception> = "Reception";
template <> constexpr std::string_view kRecord<RadioReception::Place> = "Place";
template <> constexpr std::string_view kRecord<ImuReading> = "ImuReading";
// clang-format on

template <typename Row>
py::object RowRecord(const Row& row, Tick tick);

template <typename Value>
py::object FieldValue(const Value& value) {
  if constexpr (std::is_same_v<Value, Pose>) {
    return ToRecord(value);
  } else if constexpr (std::is_same_v<Value, Color>) {
    return py::make_tuple(value.r, value.g, value.b, value.a);
  } else if constexpr (kIsOptionalId<Value>) {
    return Number(value);
  } else if constexpr (kIsId<Value>) {
    return py::int_(value.index());
  } else if constexpr (kIsOptional<Value>) {
    return value ? FieldValue(*value) : py::object(py::none());
  } else if constexpr (kIsList<Value>) {
    return ToTuple(value, [](const auto& element) { return FieldValue(element); });
  } else if constexpr (HasFields<Value>) {
    return RowRecord(value, 0);
  } else {
    return py::cast(value);
  }
}

template <typename Row>
py::object RowRecord(const Row& row, Tick tick) {
  const py::object& record = Record(kRecord<Row>.data());
  const auto names = record.attr("_fields").template cast<py::tuple>();
  py::tuple values(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto name = names[i].template cast<std::string_view>();
    py::object value = OwnMember(row, name);
    ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
      if constexpr (!std::is_same_v<Part, Vec2> && (!HasFields<Part> || std::is_same_v<Part, Pose> ||
                                                    std::is_same_v<Part, Color> || !kRecord<Part>.empty())) {
        if (!value && field.name == name) value = FieldValue(field.Of(row));
      }
    });
    if (!value && name == "tick") value = py::int_(tick);
    if (!value) throw std::logic_error(fmt::format("troupe.records.{}: no field is named {}", kRecord<Row>, name));
    values[i] = std::move(value);
  }
  return record(*values);
}

// Of each kind of reading its record.
struct ReadingConverter {
  const std::shared_ptr<const SensorReading>& owner;
  Tick tick;

  py::object operator()(const std::monostate&) const { return py::none(); }

  py::object operator()(const RangerReading& reading) const {
    std::size_t first = 0;
    return Make("RangerReading", tick, ToTuple(*reading.geometry, [&](const ScanGeometry& scan) {
                  const double* const ranges = reading.ranges.data() + first;
                  const double* const intensities = reading.intensities.data() + first;
                  first += scan.rays();
                  std::vector<py::ssize_t> shape = {Size(scan.rays())};
                  if (!scan.elevations.empty()) shape = {Size(scan.planes()), Size(scan.fan.count)};
                  static constexpr double kLevel = 0.0;
                  const double* const elevations = scan.elevations.empty() ? &kLevel : scan.elevations.data();
                  return Make("RangeScan", View(owner, ranges, shape), View(owner, intensities, shape), scan.fan.fov,
                              View(owner, elevations, {Size(scan.planes())}), ToRecord(scan.X_RS), scan.limits.min,
                              scan.limits.max);
                }));
  }

  template <typename Reading>
  py::object operator()(const Reading& reading) const {
    return RowRecord(reading, tick);
  }

  py::object operator()(const CameraReading& reading) const {
    const std::vector<py::ssize_t> shape = {Size(reading.height), Size(reading.width)};
    return Make("CameraReading", tick, View(owner, reading.colors.data(), {shape[0], shape[1], 3}),
                View(owner, reading.depths.data(), shape), View(owner, reading.models.data(), shape),
                py::make_tuple(reading.focal_length_x, reading.focal_length_y),
                py::make_tuple(reading.center_x, reading.center_y), reading.limits.min, reading.limits.max,
                ToRecord(reading.X_RS));
  }
};

py::object Limits(const Interval& interval) {
  return py::make_tuple(interval.min, interval.max);
}

// The members of a record, which Python's own tuples of the same length stand for, too.

py::tuple Members(py::handle value, const char* record) {
  if (!py::isinstance(value, Record(record))) {
    throw py::type_error(fmt::format("found {} in a command, expected {}", TypeName(value), record));
  }
  return py::reinterpret_borrow<py::tuple>(value);
}

std::optional<double> OptionalNumber(py::handle value, const char* what) {
  if (value.is_none()) return std::nullopt;
  return ToNumber(value, what);
}

std::string ToText(py::handle value, const char* what) {
  if (!py::isinstance<py::str>(value)) {
    throw py::type_error(fmt::format("{}: found {}, expected a str", what, TypeName(value)));
  }
  return value.cast<std::string>();
}

bool ToBool(py::handle value, const char* what) {
  const int truth = PyObject_IsTrue(value.ptr());
  if (truth < 0) throw py::error_already_set();
  if (!PyBool_Check(value.ptr()) && !PyLong_Check(value.ptr())) {
    throw py::type_error(fmt::format("{}: found {}, expected a bool", what, TypeName(value)));
  }
  return truth == 1;
}

std::optional<FingerCommand> ToFingers(py::handle value) {
  if (value.is_none()) return std::nullopt;
  const std::string name = ToText(value, "fingers");
  if (const auto command = FindByName<FingerCommand>(name)) return command;
  throw py::value_error(fmt::format("fingers: found '{}', expected 'open', 'close' or 'stay'", name));
}

// Calls add(row) for each element of a sequence.
template <typename Add>
void ForEach(py::handle rows, const char* what, Add&& add) {
  const auto list = py::reinterpret_steal<py::list>(PySequence_List(rows.ptr()));
  if (!list) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: found {}, expected a list", what, TypeName(rows)));
  }
  for (const py::handle row : list) add(row);
}

Order ToOrder(py::handle row) {
  const auto is = [row](const char* record) { return py::isinstance(row, Record(record)); };
  if (!is("LightOrder") && !is("CameraOrder") && !is("DoorOrder") && !is("LiftOrder") && !is("TrafficOrder") &&
      !is("ChargeOrder") && !is("JobOrder") && !is("WaitOrder") && !is("LoadOrder")) {
    throw py::type_error(
        fmt::format("orders: found {}, expected LightOrder, CameraOrder, DoorOrder, LiftOrder, "
                    "TrafficOrder, ChargeOrder, JobOrder, WaitOrder or LoadOrder",
                    TypeName(row)));
  }
  const auto m = py::reinterpret_borrow<py::tuple>(row);
  if (is("LightOrder")) return LightOrder{ToIndex(m[0], "light"), ToBool(m[1], "on")};
  if (is("CameraOrder")) return CameraOrder{ToIndex(m[0], "sensor"), ToNumber(m[1], "pan"), ToNumber(m[2], "tilt")};
  if (is("DoorOrder")) return DoorOrder{ToIndex(m[0], "door"), ToNumber(m[1], "opening")};
  if (is("LiftOrder")) return LiftOrder{ToIndex(m[0], "lift"), ToIndex(m[1], "floor"), ToBool(m[2], "ends")};
  const auto number = [&](std::size_t i, const char* name) { return static_cast<std::uint32_t>(ToIndex(m[i], name)); };
  if (is("ChargeOrder")) {
    return ChargeOrder{m[0].is_none() ? std::nullopt : std::optional(number(0, "vertex")), ToBool(m[1], "at_charger")};
  }
  if (is("JobOrder")) return JobOrder{ToBool(m[0], "free"), ToBool(m[1], "loads"), ToBool(m[2], "delivers")};
  if (is("WaitOrder")) {
    return WaitOrder{m[0].is_none() ? std::nullopt : std::optional(ModelId(ToIndex(m[0], "thing"))),
                     m[1].is_none() ? std::nullopt : std::optional(number(1, "lane"))};
  }
  if (is("LoadOrder")) {
    return LoadOrder{ModelId(ToIndex(m[0], "object")), ToBool(m[1], "takes"), ToNumber(m[2], "x"), ToNumber(m[3], "y")};
  }
  return TrafficOrder{.at = number(0, "at"),
                      .goal = m[1].is_none() ? std::nullopt : std::optional(number(1, "goal")),
                      .holds = ToBool(m[2], "holds"),
                      .finished = number(3, "finished"),
                      .driven = ToNumber(m[4], "driven"),
                      .is_blocked = ToBool(m[5], "blocked")};
}

Command FromRecord(const py::tuple& record) {
  Command command;
  command.twist = {ToNumber(record[0], "vx"), ToNumber(record[1], "vy"), ToNumber(record[2], "wz")};
  command.speed = ToNumber(record[3], "speed");
  command.steering = ToNumber(record[4], "steering");
  ForEach(record[5], "grippers", [&](py::handle row) {
    const py::tuple m = Members(row, "GripperCommand");
    command.grippers.push_back(
        {ToIndex(m[0], "gripper"), ToFingers(m[1]), OptionalNumber(m[2], "lift"), OptionalNumber(m[3], "opening")});
  });
  ForEach(record[6], "joints", [&](py::handle row) {
    const py::tuple m = Members(row, "JointCommand");
    command.joints.push_back(
        {ToIndex(m[0], "joint"), OptionalNumber(m[1], "position"), OptionalNumber(m[2], "velocity")});
  });
  ForEach(record[7], "messages", [&](py::handle row) {
    const py::tuple m = Members(row, "RadioMessage");
    const py::object data = m[1];
    if (!PyBytes_Check(data.ptr())) {
      throw py::type_error(fmt::format("data: found {}, expected bytes", TypeName(data)));
    }
    const auto bytes = data.cast<std::string_view>();
    RadioMessage message{.radio = ToIndex(m[0], "radio"), .to = {}, .bytes = {bytes.begin(), bytes.end()}};
    if (const py::object to = m[2]; !to.is_none()) message.to = RobotId(ToIndex(to, "to"));
    command.messages.push_back(std::move(message));
  });
  ForEach(record[8], "orders", [&](py::handle row) { command.orders.push_back(ToOrder(row)); });
  command.report = ToText(record[9], "report");
  command.say = ToText(record[10], "say");
  return command;
}

}  // namespace

const py::object& Record(const char* name) {
  // Never freed: the interpreter may end before them.
  // Looked up once: a controller makes dozens of records in each tick.
  static auto* const types = new std::map<std::string_view, py::object>();
  const auto found = types->find(name);
  if (found != types->end()) return found->second;
  return types->emplace(name, py::module_::import("troupe.records").attr(name)).first->second;
}

py::object ToRecord(const Pose& pose) {
  return Make("Pose", pose.x, pose.y, pose.z, pose.heading);
}

py::object ToRecord(const Twist& twist) {
  return Make("Twist", twist.vx, twist.vy, twist.wz);
}

py::object ToRecord(const std::shared_ptr<const SensorReading>& reading) {
  return std::visit(ReadingConverter{reading, reading->tick}, reading->content);
}

py::object ToRecord(const RobotInfo& info) {
  const DriveDescription& drive = info.robot->drive;
  py::tuple sensors = ToTuple(info.sensors, [](const SensorInfo& sensor) {
    return Make("SensorInfo", sensor.description->name, Text(TypeOf(sensor.description->parameters)),
                ToRecord(sensor.X_RM));
  });
  py::tuple joints = ToTuple(info.joints, [](const JointDescription* joint) {
    return Make("JointInfo", joint->name, NameOf(joint->type), joint->position.min, joint->position.max,
                joint->max_speed);
  });
  py::tuple grippers = ToTuple(info.grippers, [](const GripperInfo& gripper) {
    return Make("GripperInfo", gripper.description->name, gripper.left, gripper.right, Optional(gripper.lift),
                Optional(gripper.beams));
  });
  py::tuple lights = ToTuple(info.lights, [](const LightInfo& light) { return Text(light.name); });
  return Make(
      "RobotInfo", info.robot->name, info.id.index(), py::module_::import("json").attr("loads")(info.parameters),
      Make("DriveInfo", NameOf(drive.type), drive.wheelbase,
           py::make_tuple(Limits(drive.velocity.x), Limits(drive.velocity.y), Limits(drive.velocity.heading))),
      std::move(sensors), std::move(joints), std::move(grippers), std::move(lights),
      ToTuple(info.doors, [](const DoorInfo& door) { return Text(door.name); }),
      ToTuple(info.lifts, [](const LiftInfo& lift) {
        return Make("LiftInfo", lift.name, ToTuple(lift.floors, [](const std::string& floor) { return Text(floor); }));
      }));
}

py::object ToRecord(const Observation& seen) {
  py::tuple sensors = ToTuple(seen.sensors, [](const SensorReading& reading) -> py::object {
    if (reading.empty()) return py::none();
    return ToRecord(std::make_shared<const SensorReading>(reading));  // the robot's own changes in the next tick
  });
  py::tuple joints = ToTuple(seen.joints, [](const JointReading& joint) {
    return Make("JointReading", joint.position, joint.velocity, joint.blocked, joint.moving);
  });
  py::tuple grippers = ToTuple(seen.grippers, [](const GripperReading& gripper) {
    py::tuple beams = ToTuple(gripper.beams, [](const std::optional<SeenModel>& object) { return Name(object); });
    return Make("GripperReading", NameOf(gripper.fingers), gripper.lift_moving, gripper.lift_position,
                gripper.lift_percent, Name(gripper.left_contact), Name(gripper.right_contact), Name(gripper.held),
                Name(gripper.clamped), std::move(beams));
  });
  py::tuple lights = ToTuple(seen.lights, [](bool on) { return py::bool_(on); });
  py::object energy = py::none();
  if (seen.energy) {
    energy = Make("EnergyReading", seen.energy->joules, seen.energy->capacity, seen.energy->charge_watts);
  }
  py::object goal = py::none();
  if (seen.goal != nullptr) {
    py::tuple points =
        ToTuple(seen.goal->waypoints, [](const Vec2& point) { return py::make_tuple(point.x(), point.y()); });
    goal = Make("Goal", seen.goal->number, std::move(points), Optional(seen.goal->heading),
                ToTuple(seen.goal->heights, [](double z) { return py::float_(z); }));
  }
  return Make("Observation", seen.tick, seen.time, seen.interval, ToRecord(seen.pose_estimate), ToRecord(seen.twist),
              seen.stalled, std::move(sensors), std::move(joints), std::move(grippers), std::move(lights),
              std::move(energy), std::move(goal), seen.random_key,
              ToTuple(seen.doors, [](const DoorState& door) { return py::float_(door.opening); }),
              ToTuple(seen.lifts, [](const LiftState& lift) {
                return Make("LiftReading", lift.z, lift.floor,
                            lift.session ? py::object(py::int_(lift.session->index())) : py::object(py::none()));
              }));
}

Command ToCommand(py::handle value) {
  if (value.is_none()) return {};
  if (py::isinstance(value, Record("Command"))) return FromRecord(py::reinterpret_borrow<py::tuple>(value));
  std::vector<double> numbers;
  if (PySequence_Check(value.ptr()) != 0 && !PyUnicode_Check(value.ptr())) {
    ForEach(value, "command", [&](py::handle number) { numbers.push_back(ToNumber(number, "command")); });
  }
  Command command;
  if (numbers.size() == 2) {
    command.twist = {numbers[0], 0.0, numbers[1]};
  } else if (numbers.size() == 3) {
    command.twist = {numbers[0], numbers[1], numbers[2]};
  } else {
    throw py::type_error(fmt::format("found {}, expected a Command, (vx, wz), (vx, vy, wz) or None",
                                     py::str(py::repr(value)).cast<std::string>()));
  }
  return command;
}

py::array OutputArray(const py::object& out, const std::vector<py::ssize_t>& shape, const char* what) {
  std::string expected;
  for (const py::ssize_t side : shape) expected += fmt::format("{}{}", expected.empty() ? "" : ", ", side);
  if (!py::isinstance<py::array>(out)) {
    throw py::type_error(fmt::format("{}: expected a numpy array ({}) of float32 or float64", what, expected));
  }
  py::array array = py::reinterpret_borrow<py::array>(out);
  const bool number = py::isinstance<py::array_t<float>>(array) || py::isinstance<py::array_t<double>>(array);
  bool fits = number && array.writeable() && (array.flags() & py::array::c_style) != 0 &&
              static_cast<std::size_t>(array.ndim()) == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) fits = array.shape(static_cast<py::ssize_t>(i)) == shape[i];
  if (!fits) {
    throw py::value_error(
        fmt::format("{}: expected a writable array ({}) of float32 or float64, in one piece", what, expected));
  }
  return array;
}

double ToNumber(py::handle value, const char* what) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1.0 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: found {}, expected a number", what, TypeName(value)));
  }
  return number;
}

std::uint64_t ToSeed(py::handle value, const char* what) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!whole) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: found {}, expected a whole number", what, TypeName(value)));
  }
  const unsigned long long seed = PyLong_AsUnsignedLongLong(whole.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw py::value_error(
        fmt::format("{}: found {}, expected 0 to 18446744073709551615", what, py::str(whole).cast<std::string>()));
  }
  return seed;
}

void CheckFinite(const py::array_t<double>& numbers, const char* what) {
  const auto end = numbers.data() + numbers.size();
  const auto bad = std::find_if_not(numbers.data(), end, [](double number) { return std::isfinite(number); });
  if (bad == end) return;
  std::vector<py::ssize_t> place(static_cast<std::size_t>(numbers.ndim()));
  py::ssize_t index = bad - numbers.data();
  for (std::size_t axis = place.size(); axis-- > 0;) {
    const py::ssize_t length = numbers.shape(static_cast<py::ssize_t>(axis));
    place[axis] = index % length;
    index /= length;
  }
  throw py::value_error(fmt::format("{}[{}]: found {}, expected a finite number", what, fmt::join(place, ", "), *bad));
}

std::size_t ToIndex(py::handle value, const char* what) {
  const Py_ssize_t index = PyNumber_AsSsize_t(value.ptr(), PyExc_OverflowError);
  if (index == -1 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: found {}, expected a number from 0", what, TypeName(value)));
  }
  if (index < 0) throw py::value_error(fmt::format("{}: found {}, expected a number from 0", what, index));
  return static_cast<std::size_t>(index);
}

}  // namespace troupe::python
