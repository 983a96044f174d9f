// The classes troupe.State, what can be read of a world at a tick, and troupe.Snapshot.
//
// Arrays are strided views into the rows of the shared, immutable state: `poses` costs no copy however many robots
// there are, and stays valid after the simulation has stepped on. The static assertion below keeps the layouts of rows
// that the strides rely on. Names and columns come from the state's tables (common/signals), so that a new table
// appears here by itself.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/signals/state_tables.h"
#include "python/native/convert.h"
#include "python/native/world.h"
#include "troupe/simulation.h"
#include "troupe/snapshot_bytes.h"

namespace troupe::python {
namespace {

using namespace py::literals;
using WorldPointer = std::shared_ptr<World>;

py::object ModelName(const WorldDescription& world, const std::optional<ModelId>& model) {
  return model ? py::object(py::str(world.model(*model).name)) : py::none();
}

py::list ToList(const WorldDescription& world, const std::vector<Event>& events) {
  py::list list;
  for (const Event& event : events) {
    const py::object robot = event.robot ? py::object(py::str(world.robot(*event.robot).name)) : py::none();
    list.append(Record("Event")(event.tick, NameOf(event.type), robot, ModelName(world, event.other),
                                ModelName(world, event.object), event.detail));
  }
  return list;
}

// Rows of a state as an array (rows, columns), from the first number of each. A copy: torch and others write into
// arrays that are not writable, and states share their memory with snapshots and copies of the simulation.
template <typename Row, typename Value>
py::array Columns(const std::vector<Row>& rows, const Value Row::*first, py::ssize_t columns) {
  using Number = std::conditional_t<std::is_class_v<Value>, double, Value>;
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(rows.size())};
  if (columns > 0) shape.push_back(columns);
  py::array_t<Number> array(std::move(shape));
  const auto count = static_cast<std::size_t>(std::max<py::ssize_t>(columns, 1));
  Number* next = array.mutable_data();
  for (const Row& row : rows) next = std::copy_n(reinterpret_cast<const Number*>(&(row.*first)), count, next);
  // To write into it would not move a robot.
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}
static_assert(sizeof(Pose) == 4 * sizeof(double) && sizeof(Twist) == 3 * sizeof(double));

template <auto member, py::ssize_t columns, auto table>
py::array StateView(const WorldPointer& world) {
  const World::Use use(*world);
  return Columns(use->state().*table, member, columns);
}

py::object Read(const WorldPointer& world, const py::object& robot, const py::object& sensor) {
  const World::Use use(*world);
  const RobotId id = world->FindRobot(robot);
  const std::size_t index = world->FindSensor(id, sensor);
  return ToRecord(std::make_shared<const SensorReading>(use->Measure(id, index)));
}

py::array Ranges(const WorldPointer& world, const py::object& sensor, const py::object& out) {
  const World::Use use(*world);
  const std::vector<std::size_t> sensors = world->FindSensors(sensor);
  const std::size_t rays = world->CountRays(sensors);
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(sensors.size()), static_cast<py::ssize_t>(rays)};
  py::array array = out.is_none() ? py::array(py::array_t<double>(shape)) : OutputArray(out, shape, "out");
  const bool is_float = array.dtype().itemsize() == sizeof(float);
  void* const data = array.mutable_data();
  const py::gil_scoped_release release;
  if (is_float) {
    world->CopyRanges(sensors, rays, static_cast<float*>(data));
  } else {
    world->CopyRanges(sensors, rays, static_cast<double*>(data));
  }
  return array;
}

template <auto part, typename Value>
py::array Images(const WorldPointer& world, const py::object& sensor, const py::object& out, const char* type,
                 std::vector<py::ssize_t> channels) {
  const World::Use use(*world);
  const std::vector<std::size_t> sensors = world->FindSensors(sensor);
  const std::pair<std::size_t, std::size_t> size = world->ImageShape(sensors);
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(sensors.size()), static_cast<py::ssize_t>(size.first),
                                    static_cast<py::ssize_t>(size.second)};
  shape.insert(shape.end(), channels.begin(), channels.end());
  py::array_t<Value> array = ArrayOf<Value>(out, shape, type);
  Value* const data = array.mutable_data();
  const py::gil_scoped_release release;
  world->CopyImages<part>(sensors, size, data);
  return array;
}

// (occupied, resolution, origin).
py::tuple MapOf(const WorldPointer& world, std::optional<double> resolution, std::optional<double> z) {
  const World::Use use(*world);
  std::optional<Result<OccupancyGrid>> made;
  {
    const py::gil_scoped_release release;
    made.emplace(use->MakeMap(resolution, z));
  }
  const OccupancyGrid grid = ValueOf(*std::move(made));
  py::array_t<bool> cells({static_cast<py::ssize_t>(grid.height), static_cast<py::ssize_t>(grid.width)});
  std::copy(grid.occupied.begin(), grid.occupied.end(), cells.mutable_data());
  return Record("Map")(cells, grid.resolution, py::make_tuple(grid.origin_x, grid.origin_y));
}

PictureOptions PictureOptionsOf(const std::string& view, const std::string& format, std::optional<int> width,
                                std::optional<std::pair<double, double>> center, std::optional<double> meters) {
  PictureOptions options;
  if (view != "top" && view != "side") {
    throw py::value_error(fmt::format("view: found '{}', expected 'top' or 'side'", view));
  }
  if (format != "png" && format != "svg") {
    throw py::value_error(fmt::format("format: found '{}', expected 'png' or 'svg'", format));
  }
  options.view = view == "top" ? PictureView::kTop : PictureView::kSide;
  options.format = format == "png" ? PictureFormat::kPng : PictureFormat::kSvg;
  options.width = width;
  if (center) options.center = Vec2(center->first, center->second);
  options.meters = meters;
  return options;
}

py::object Picture(const WorldPointer& world, const PictureOptions& options, bool rays) {
  const World::Use use(*world);
  std::optional<Result<std::string>> bytes;
  {
    const py::gil_scoped_release release;
    bytes.emplace(use->DrawPicture(options, rays ? PictureRays::kDrawn : PictureRays::kHidden));
  }
  return py::module_::import("troupe.picture").attr("Picture")(py::bytes(ValueOf(*std::move(bytes))));
}

std::string Represent(const WorldPointer& world) {
  const World::Use use(*world);
  return fmt::format("<troupe.{} '{}': {} robots, tick {}, hash {:016x}>",
                     dynamic_cast<const SteppedWorld*>(world.get()) == nullptr ? "State" : "Simulation",
                     use->world().name, use->world().robots.size(), use->tick(), use->state_hash());
}

// The names of the things of a table, by their numbers.
py::tuple NamesOfThings(const Things& things, std::size_t kind) {
  py::tuple names(things.count(kind));
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = py::str(things.name(things.first(kind) + ThingId(i)));
  return names;
}

py::tuple NamesOfTable(const WorldPointer& world, std::string_view table) {
  const World::Use use(*world);
  return NamesOfThings(world->things(), KindOf(table));
}

// The values of a signal for all rows.
py::object ColumnOf(const Signal& signal, const SignalView& view, std::size_t rows) {
  if (signal.type == ValueType::kText) {
    py::tuple texts(rows);
    for (std::size_t row = 0; row < rows; ++row) texts[row] = py::str(signal.text(view, row));
    return texts;
  }
  if (signal.type == ValueType::kTruth) {
    py::array_t<bool> truths(static_cast<py::ssize_t>(rows));
    for (std::size_t row = 0; row < rows; ++row) truths.mutable_data()[row] = signal.number(view, row) != 0.0;
    return truths;
  }
  py::array_t<double> numbers(static_cast<py::ssize_t>(rows));
  for (std::size_t row = 0; row < rows; ++row) numbers.mutable_data()[row] = signal.number(view, row);
  return numbers;
}

py::dict TableOf(const WorldPointer& world, const std::string& name) {
  const StateTable& table = FindTable(name);
  const World::Use use(*world);
  const SignalView view = world->view();
  py::dict columns;
  if (!table.varies) columns["name"] = NamesOfThings(view.things, KindOf(name));
  for (const Signal& signal : table.signals) {
    columns[py::str(signal.name)] = ColumnOf(signal, view, table.rows(view.world, view.state));
  }
  return columns;
}

using StateClass = py::class_<World, WorldPointer>;

void DefineSnapshot(py::module_& module) {
  py::class_<Snapshot, SnapshotPointer>(module, "Snapshot", "The whole of a simulation at one tick. Never changes.")
      .def_property_readonly(
          "tick", [](const SnapshotPointer& snapshot) { return snapshot->tick(); }, "The tick at which it was saved.")
      .def("__copy__", [](const SnapshotPointer& snapshot) { return snapshot; })
      .def("__deepcopy__", [](const SnapshotPointer& snapshot, const py::object&) { return snapshot; })
      .def(py::pickle(
          [](const SnapshotPointer& snapshot) {
            const std::vector<std::byte> bytes = ValueOf(SnapshotBytes::Write(*snapshot));
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          [](const py::bytes& pickled) {
            const std::string_view text = pickled;
            std::optional<Result<Snapshot>> read;
            {
              const py::gil_scoped_release release;
              read.emplace(SnapshotBytes::Read(std::as_bytes(std::span(text))));
            }
            return std::make_shared<Snapshot>(ValueOf(*std::move(read)));
          }))
      .def("__repr__", [](const SnapshotPointer& snapshot) {
        return fmt::format("<troupe.Snapshot at tick {}>", snapshot->tick());
      });
}

void DefineFacts(StateClass& state) {
  state
      .def_property_readonly(
          "tick", [](const WorldPointer& world) { return World::Use(*world)->tick(); },
          "The number of the present tick.")
      .def_property_readonly(
          "time", [](const WorldPointer& world) { return World::Use(*world)->time(); }, "The simulated time, s.")
      .def_property_readonly(
          "interval", [](const WorldPointer& world) { return World::Use(*world)->world().interval_seconds(); },
          "The length of a tick, s.")
      .def_property_readonly(
          "seed", [](const WorldPointer& world) { return World::Use(*world)->world().seed; }, "Of all random numbers.")
      .def_property_readonly(
          "name", [](const WorldPointer& world) { return World::Use(*world)->world().name; },
          "The name of the scenario or world.")
      .def_property_readonly(
          "state_hash", [](const WorldPointer& world) { return World::Use(*world)->state_hash(); },
          "The hash of the whole state: equal states have equal hashes, on every machine.");
}

// A property for each table whose rows are things: robots, joints, doors, people ...
void DefineNames(StateClass& state) {
  for (const StateTable& table : StateTables()) {
    if (table.varies) continue;
    const std::string documentation = "The names of the " + table.name + ", a tuple.";
    state.def_property_readonly(
        table.name.c_str(), [&table](const WorldPointer& world) { return NamesOfTable(world, table.name); },
        documentation.c_str());
  }
}

void DefineTables(StateClass& state) {
  state
      .def_property_readonly(
          "tables",
          [](const WorldPointer&) {
            py::tuple names(StateTables().size());
            for (std::size_t i = 0; i < names.size(); ++i) names[i] = py::str(StateTables()[i].name);
            return names;
          },
          "The names of the tables of things, a tuple: robots, joints, doors, people, levels ...")
      .def("table", TableOf, "name"_a,
           R"(A table of things, such as "doors": a dict from the names of its columns to their values.

"name" is a tuple of the names of the things, in the order of their numbers; the other columns are the signals of
docs/testing.md: arrays of float64 or bool, and tuples for texts. A number that a thing does not have is nan, a text
empty. pandas.DataFrame(sim.table("doors")) is the same as a data frame. Raises ValueError for another name.)");
}

void DefineArrays(StateClass& state) {
  state
      .def_property_readonly("poses", StateView<&RobotState::X_WR, 4, &WorldState::robots>,
                             "float64 (robots, 4): x, y, z (m) and heading (rad) of each robot in W.")
      .def_property_readonly("twists", StateView<&RobotState::twist, 3, &WorldState::robots>,
                             "float64 (robots, 3): vx, vy (m/s) and wz (rad/s) in R, executed in the last tick.")
      .def_property_readonly("stalls", StateView<&RobotState::stalled, 0, &WorldState::robots>,
                             "bool (robots,): a contact ended the robot's last motion.")
      .def_property_readonly("joint_positions", StateView<&JointState::position, 0, &WorldState::joints>,
                             "float64 (joints,): m or rad.")
      .def_property_readonly("object_poses", StateView<&ObjectState::X_WO, 4, &WorldState::objects>,
                             "float64 (objects, 4): as `poses`.")
      .def_property_readonly("energy", StateView<&StoreState::joules, 0, &WorldState::stores>,
                             "float64 (stores,): J in each store of energy, in the order of the file.");
}

void DefineReadings(StateClass& state) {
  state
      .def(
          "robot",
          [](const WorldPointer& world, const py::object& robot) {
            const World::Use use(*world);
            return ToRecord(use->Info(world->FindRobot(robot)));
          },
          "robot"_a, "The RobotInfo of a robot: its drive, sensors, joints and grippers.")
      .def("read", Read, "robot"_a, "sensor"_a,
           R"(The reading of a sensor in the present state, for instance a RangerReading; see troupe.records.

sensor: a name, a type ("ranger": the robot's first) or a number. Whether it is read changes nothing.)")
      .def("ranges", Ranges, "sensor"_a = "ranger", "out"_a = py::none(),
           R"(The ranges of all robots' rangers, (robots, rays), m: those of all ray sensors of a ranger in one row.

out: a writable array of that shape, of float32 or float64, to write into. Raises ValueError if the robots' rangers have
different numbers of rays.)")
      .def(
          "images",
          [](const WorldPointer& world, const py::object& sensor, const py::object& out) {
            return Images<&CameraReading::colors, std::uint8_t>(world, sensor, out, "uint8", {3});
          },
          "sensor"_a = "camera", "out"_a = py::none(),
          "uint8 (robots, height, width, 3): the pictures of all robots' cameras. out: an array to write into.")
      .def(
          "depths",
          [](const WorldPointer& world, const py::object& sensor, const py::object& out) {
            return Images<&CameraReading::depths, float>(world, sensor, out, "float32", {});
          },
          "sensor"_a = "camera", "out"_a = py::none(),
          "float32 (robots, height, width): m ahead; -inf: too near, inf: no hit. out: an array to write into.")
      .def("map", MapOf, "resolution"_a = py::none(), "z"_a = py::none(),
           R"(The static bodies as a Map: an array of cells, row 0 the lowest in y.

resolution: m, of a cell; by default that of the world's ROS map, or 0.05. z: the height, m, that bodies reach through; by
default that of the lowest lidar. World.map takes such an array.)")
      .def(
          "held",
          [](const WorldPointer& world, const py::object& robot) {
            const World::Use use(*world);
            py::list held;
            for (const auto& model : use->HeldObjects(world->FindRobot(robot))) {
              held.append(ModelName(use->world(), model));
            }
            return held;
          },
          "robot"_a, "The name of the object that each gripper of the robot holds, or None.")
      .def_property_readonly(
          "events",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return ToList(use->world(), world->events);
          },
          "The events of the last call of `step`, a list of Event.");
}

void DefineCopies(StateClass& state) {
  state
      .def(
          "copy",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return std::make_shared<SteppedWorld>(ValueOf(Simulation::Continue(ValueOf(use->Save()))));
          },
          "A Simulation that continues from here; constant parts of the world are shared. That of a recorded state has "
          "no "
          "controllers.")
      .def(
          "picture",
          [](const WorldPointer& world, const std::string& view, bool rays, std::optional<int> width,
             std::optional<std::pair<double, double>> center, std::optional<double> meters, const std::string& format) {
            return Picture(world, PictureOptionsOf(view, format, width, center, meters), rays);
          },
          py::kw_only(), "view"_a = "top", "rays"_a = false, "width"_a = py::none(), "center"_a = py::none(),
          "meters"_a = py::none(), "format"_a = "png",
          R"(A Picture of the present state, which a notebook shows.

view: "top" or "side". rays: with the readings of all sensors. width: pixels, 200 to 4096. center, meters: the part of the
world, a place (x, y) in m and a length along x. format: "png" or "svg".)")
      .def("_repr_png_", [](const WorldPointer& world) { return py::bytes(Picture(world, PictureOptions(), false)); })
      .def("__repr__", Represent)
      .def("__copy__", [](const py::object& self) { return self.attr("copy")(); })
      .def("__deepcopy__", [](const py::object& self, const py::object&) { return self.attr("copy")(); });
}

}  // namespace

const StateTable& FindTable(const std::string& name) {
  std::vector<std::string> names;
  for (const StateTable& table : StateTables()) {
    if (table.name == name) return table;
    names.push_back(table.name);
  }
  throw py::value_error(fmt::format("found table '{}', expected one of: {}", name, fmt::join(names, ", ")));
}

void DefineState(py::module_& module) {
  DefineSnapshot(module);
  StateClass state(
      module, "State",
      R"(A world at a tick: what can be read of it. A Simulation is one, and so is each state of a Recording.

Arrays of the state are copies of the state at the tick at which they were taken: they can only be read, and they stay as
they are when the simulation steps on or ends. Numbers of robots, joints, grippers and objects are places in
the tuples `robots`, `joints`, `grippers` and `objects`. Robots and sensors may be named by name or number.)");
  DefineFacts(state);
  DefineNames(state);
  DefineTables(state);
  DefineArrays(state);
  DefineReadings(state);
  DefineCopies(state);
}

}  // namespace troupe::python
