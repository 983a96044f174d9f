// The class troupe.Simulation.
#include "troupe/simulation.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/native/convert.h"
#include "python/native/world.h"

namespace troupe::python {
namespace {

using namespace py::literals;
using WorldPointer = std::shared_ptr<World>;

std::string PathOf(const py::object& file) {
  return py::module_::import("os").attr("fsdecode")(file).cast<std::string>();
}

SimulationOptions OptionsOf(const py::object& seed, std::optional<std::string> controller, bool run_controllers) {
  SimulationOptions options;
  if (!seed.is_none()) options.seed = seed.cast<std::uint64_t>();
  options.controller = std::move(controller);
  options.run_controllers = run_controllers;
  return options;
}

py::object ModelName(const WorldDescription& world, const std::optional<ModelId>& model) {
  return model ? py::object(py::str(world.model(*model).name)) : py::none();
}

py::list ToList(const WorldDescription& world, const std::vector<Event>& events) {
  py::list list;
  for (const Event& event : events) {
    const py::object robot = event.robot ? py::object(py::str(world.robot(*event.robot).name)) : py::none();
    list.append(Record("Event")(event.tick, ToString(event.type), robot, ModelName(world, event.other),
                                ModelName(world, event.object), event.detail));
  }
  return list;
}

// Rows of a state as an array (rows, columns), from the first number of each.
template <typename Row, typename Value>
py::array Columns(const std::shared_ptr<const WorldState>& state, const std::vector<Row>& rows, const Value Row::*first,
                  py::ssize_t columns) {
  const Value* data = rows.empty() ? nullptr : &(rows.front().*first);
  using Number = std::conditional_t<std::is_class_v<Value>, double, Value>;
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(rows.size())};
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(sizeof(Row))};
  if (columns > 0) {
    shape.push_back(columns);
    strides.push_back(static_cast<py::ssize_t>(sizeof(Number)));
  }
  return View(state, reinterpret_cast<const Number*>(data), std::move(shape), std::move(strides));
}
static_assert(sizeof(Pose) == 4 * sizeof(double) && sizeof(Twist) == 3 * sizeof(double));

template <auto member, py::ssize_t columns, auto table>
py::array StateView(const WorldPointer& world) {
  const World::Use use(*world);
  const std::shared_ptr<const WorldState> state = use->shared_state();
  return Columns(state, (*state).*table, member, columns);
}

Tick ToTicks(std::int64_t ticks) {
  if (ticks < 0) throw py::value_error(fmt::format("ticks: found {}, expected 0 or more", ticks));
  return static_cast<Tick>(ticks);
}

void Drive(const WorldPointer& world, const py::object& motion, const py::object& robot) {
  const World::Use use(*world);
  if (!robot.is_none()) {
    const RobotId id = world->FindRobot(robot);
    if (py::isinstance(motion, Record("Command"))) return RaiseIfBad(use->Drive(id, ToCommand(motion)));
    return RaiseIfBad(use->DriveBy(id, ToCommand(motion).twist));
  }
  const auto twists = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(motion);
  if (!twists) PyErr_Clear();
  const auto robots = static_cast<py::ssize_t>(use->world().robots.size());
  if (!twists || twists.ndim() != 2 || twists.shape(0) != robots || (twists.shape(1) != 2 && twists.shape(1) != 3)) {
    throw py::value_error(
        fmt::format("motion: expected an array ({0}, 3) of vx, vy, wz or ({0}, 2) of vx, wz", robots));
  }
  const double* row = twists.data();
  const py::ssize_t columns = twists.shape(1);
  for (py::ssize_t i = 0; i < robots; ++i, row += columns) {
    const Twist twist{row[0], columns == 3 ? row[1] : 0.0, row[columns - 1]};
    RaiseIfBad(use->DriveBy(RobotId(static_cast<std::size_t>(i)), twist));
  }
}

void Release(const WorldPointer& world, const py::object& robot) {
  const World::Use use(*world);
  if (!robot.is_none()) return use->Release(world->FindRobot(robot));
  for (std::size_t i = 0; i < use->world().robots.size(); ++i) use->Release(RobotId(i));
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

template <typename Rows, typename NameOf>
py::tuple NamesOf(const Rows& rows, const NameOf& name_of) {
  py::tuple names(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) names[i] = py::str(name_of(rows[i]));
  return names;
}

// "robot.part" of each.
template <typename Parts>
py::tuple NamesOfParts(const WorldDescription& world, const Parts& parts) {
  return NamesOf(parts, [&](const auto& part) { return world.robot(part.robot).name + "." + part.name; });
}

}  // namespace

void DefineSimulation(py::module_& module) {
  py::class_<Snapshot, SnapshotPointer>(module, "Snapshot", "The whole of a simulation at one tick. Never changes.")
      .def_property_readonly(
          "tick", [](const SnapshotPointer& snapshot) { return snapshot->tick(); }, "The tick at which it was saved.")
      .def("__copy__", [](const SnapshotPointer& snapshot) { return snapshot; })
      .def("__deepcopy__", [](const SnapshotPointer& snapshot, const py::object&) { return snapshot; })
      .def("__repr__", [](const SnapshotPointer& snapshot) {
        return fmt::format("<troupe.Snapshot at tick {}>", snapshot->tick());
      });

  py::class_<World, WorldPointer> state(
      module, "State",
      R"(A world at a tick: what can be read of it. A Simulation is one, and so is each state of a Recording.

Arrays of the state are views without a copy of the state at the tick at which they were taken: they can only be read,
and they stay as they are when the simulation steps on or ends. Numbers of robots, joints, grippers and objects are places in
the tuples `robots`, `joints`, `grippers` and `objects`. Robots and sensors may be named by name or number.)");
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
          "The hash of the whole state: equal states have equal hashes, on every machine.")
      .def_property_readonly(
          "robots",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return NamesOf(use->world().robots, [](const RobotDescription& robot) { return robot.name; });
          },
          "The names of the robots, a tuple.")
      .def_property_readonly(
          "joints",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return NamesOfParts(use->world(), use->world().joints);
          },
          "The names of the joints, a tuple.")
      .def_property_readonly(
          "grippers",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return NamesOfParts(use->world(), use->world().grippers);
          },
          "The names of the grippers, a tuple.")
      .def_property_readonly(
          "objects",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return NamesOf(use->world().objects, [&](ModelId model) { return use->world().model(model).name; });
          },
          "The names of the objects that grippers can hold, a tuple.")
      .def(
          "robot",
          [](const WorldPointer& world, const py::object& robot) {
            const World::Use use(*world);
            return ToRecord(use->Info(world->FindRobot(robot)));
          },
          "robot"_a, "The RobotInfo of a robot: its drive, sensors, joints and grippers.")
      .def_property_readonly("poses", StateView<&RobotState::X_WR, 4, &WorldState::robots>,
                             "float64 (robots, 4): x, y, z (m) and heading (rad) of each robot in W. A view.")
      .def_property_readonly(
          "twists", StateView<&RobotState::twist, 3, &WorldState::robots>,
          "float64 (robots, 3): vx, vy (m/s) and wz (rad/s) in R, executed in the last tick. A view.")
      .def_property_readonly("stalls", StateView<&RobotState::stalled, 0, &WorldState::robots>,
                             "bool (robots,): a contact ended the robot's last motion. A view.")
      .def_property_readonly("joint_positions", StateView<&JointState::position, 0, &WorldState::joints>,
                             "float64 (joints,): m or rad. A view.")
      .def_property_readonly("object_poses", StateView<&ObjectState::X_WO, 4, &WorldState::objects>,
                             "float64 (objects, 4): as `poses`. A view.")
      .def_property_readonly("energy", StateView<&StoreState::joules, 0, &WorldState::stores>,
                             "float64 (stores,): J in each store of energy, in the order of the file. A view.")
      .def("read", Read, "robot"_a, "sensor"_a,
           R"(The reading of a sensor in the present state, for instance a RangerReading; see troupe.records.

sensor: a name, a type ("ranger": the robot's first) or a number. Whether it is read changes nothing.)")
      .def("ranges", Ranges, "sensor"_a = "ranger", "out"_a = py::none(),
           R"(The ranges of all robots' rangers, (robots, rays), m: those of all ray sensors of a ranger in one row.

out: a writable array of that shape, of float32 or float64, to write into. Raises ValueError if the robots' rangers have
different numbers of rays.)")
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
      .def(
          "copy",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return std::make_shared<SteppedWorld>(ValueOf(Simulation::Continue(ValueOf(use->Save()))));
          },
          "A Simulation that continues from here; constant parts of the world are shared. That of a recorded state has "
          "no "
          "controllers.")
      .def_property_readonly(
          "events",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return ToList(use->world(), world->events);
          },
          "The events of the last call of `step`, a list of Event.")
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

  py::class_<SteppedWorld, World, std::shared_ptr<SteppedWorld>> simulation(module, "Simulation",
                                                                            R"(A world in this process.

Robots decide and the step moves them by the code of a distributed run, so that after the same number of ticks the state
hash is that of `troupe run` of the same file. One thread at a time may use a simulation; another one gets a
RuntimeError. Several simulations are independent, and step at the same time in several threads.)");
  simulation
      .def(py::init([](const py::object& file, const py::object& seed, std::optional<std::string> controller,
                       bool run_controllers) {
             return World::Load(PathOf(file), OptionsOf(seed, std::move(controller), run_controllers));
           }),
           "file"_a, py::kw_only(), "seed"_a = py::none(), "controller"_a = py::none(), "run_controllers"_a = true,
           R"(Loads a Stage world (.world), a scenario (.json) or a ROS map (.yaml).

seed: of all random numbers, in place of the file's. controller: for robots to which the file gives none; by default they
stand still. run_controllers=False: no robot has a controller, each stands still until it is driven.

Raises InputError with file, line and column.)")
      .def(
          "step", [](const WorldPointer& world, std::int64_t ticks) { world->Step(ToTicks(ticks)); }, "ticks"_a = 1,
          "Advances by `ticks` ticks of `interval` seconds. Other threads run meanwhile; Ctrl-C ends it between two "
          "ticks.")
      .def_property_readonly(
          "warnings",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return NamesOf(use->warnings(), [](const Warning& warning) { return warning.ToString(); });
          },
          "What the author of the file should know: a tuple of texts.")
      .def("drive", Drive, "motion"_a, "robot"_a = py::none(),
           R"(Drives robots in place of their controllers, until `release`.

motion: for one robot (vx, wz), (vx, vy, wz) or a Command; for all an array (robots, 3) of vx, vy (m/s), wz (rad/s) in R,
or (robots, 2) of vx, wz. The drive bounds it. A car follows the twist as far as it can. Commands to grippers and joints are executed once.)")
      .def("release", Release, "robot"_a = py::none(), "Returns a robot, or all, to its controller.")
      .def(
          "save", [](const WorldPointer& world) { return ValueOf(World::Use(*world)->Save()); },
          "A Snapshot of the whole simulation. Raises RunError if a controller cannot be copied.")
      .def(
          "restore", [](const WorldPointer& world, const SnapshotPointer& snapshot) { world->Restore(*snapshot); },
          py::arg("snapshot").none(false),
          "Continues from a snapshot, of this or of another simulation: the same steps give the same hashes.")
      .def_property_readonly(
          "reports",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return world->reports;
          },
          "What controllers reported in the last call of `step`, a list of lines.")
      .def_property_readonly(
          "failures", [](const WorldPointer& world) { return World::Use(*world)->failures(); },
          "A line for each controller that has failed; its robot stands still from then on.")
      .def(
          "view",
          [](const WorldPointer& world, const std::string& address, std::uint16_t port, const py::object& program) {
            SimulationPageOptions options{.address = address, .port = port};
            if (!program.is_none()) options.program = PathOf(program);
            return world->OpenPage(options);
          },
          py::kw_only(), "address"_a = "127.0.0.1", "port"_a = 0, "program"_a = py::none(),
          R"(Opens the page of `troupe view` on this simulation, and returns its address, for a browser.

The page follows the steps, at most 60 times a second, until `close_view` or the end of the simulation. Called again, it
returns the same address. port: 0 is any. program: the program troupe of the same version; by default that of the package.
Raises RunError if there is none, InputError for an address that is none.)")
      .def(
          "close_view", [](const WorldPointer& world) { world->ClosePage(); },
          "Closes the page; it shows that the run is over.");
}

}  // namespace troupe::python
