// The class troupe.Simulation.
#include "troupe/simulation.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
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
using SimulationClass = py::class_<SteppedWorld, World, std::shared_ptr<SteppedWorld>>;

std::string PathOf(const py::object& file) {
  return py::module_::import("os").attr("fsdecode")(file).cast<std::string>();
}

SimulationOptions OptionsOf(const py::object& seed, const py::object& controller, bool run_controllers) {
  SimulationOptions options;
  if (!seed.is_none()) options.seed = ToSeed(seed, "seed");
  options.controller = ControllerName(controller);
  options.run_controllers = run_controllers;
  return options;
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
  // The failed conversion has set an error of numpy's; ours is clearer.
  if (!twists) PyErr_Clear();
  const auto robots = static_cast<py::ssize_t>(use->world().robots.size());
  if (!twists || twists.ndim() != 2 || twists.shape(0) != robots || (twists.shape(1) != 2 && twists.shape(1) != 3)) {
    throw py::value_error(
        fmt::format("motion: expected an array ({0}, 3) of vx, vy, wz or ({0}, 2) of vx, wz", robots));
  }
  CheckFinite(twists, "motion");  // before any is driven: an error leaves no robot with half of a command
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

void DefineSteps(SimulationClass& simulation) {
  simulation
      .def(
          py::init(
              [](const py::object& world, const py::object& seed, const py::object& controller, bool run_controllers) {
                const SimulationOptions options = OptionsOf(seed, controller, run_controllers);
                return World::Load(WorldInput(world, options.seed), options);
              }),
          "world"_a, py::kw_only(), "seed"_a = py::none(), "controller"_a = py::none(), "run_controllers"_a = true,
          R"(Loads a Stage world (.world), a scenario (.json) or a ROS map (.yaml); or a scenario as a dict, or a troupe.World.

seed: of all random numbers, in place of the file's. controller: for robots to which the world gives none, a name or a
class; by default they stand still. run_controllers=False: no robot has a controller, each stands still until it is driven.

Raises InputError with file, line and column.)")
      .def(
          "step", [](const WorldPointer& world, std::int64_t ticks) { world->Step(ToTicks(ticks)); }, "ticks"_a = 1,
          "Advances by `ticks` ticks of `interval` seconds. Other threads run meanwhile; Ctrl-C ends it between two "
          "ticks.")
      .def_property_readonly(
          "warnings",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            py::tuple warnings(use->warnings().size());
            for (std::size_t i = 0; i < warnings.size(); ++i) warnings[i] = py::str(use->warnings()[i].ToString());
            return warnings;
          },
          "What the author of the file should know: a tuple of texts.")
      .def("drive", Drive, "motion"_a, "robot"_a = py::none(),
           R"(Drives robots in place of their controllers, until `release`.

motion: for one robot (vx, wz), (vx, vy, wz) or a Command; for all an array (robots, 3) of vx, vy (m/s), wz (rad/s) in R,
or (robots, 2) of vx, wz. The drive bounds it. A car follows the twist as far as it can. All
else of a Command is executed once: grippers, joints, messages, orders, and the text to say.)")
      .def("release", Release, "robot"_a = py::none(), "Returns a robot, or all, to its controller.")
      .def(
          "record",
          [](const WorldPointer& world, const py::object& file, std::int64_t keyframe_interval) {
            if (keyframe_interval < 1) {
              throw py::value_error(fmt::format("keyframe_interval: found {}, expected 1 or more", keyframe_interval));
            }
            world->StartRecording(PathOf(file), static_cast<Tick>(keyframe_interval));
          },
          "file"_a, "keyframe_interval"_a = 100,
          R"(Records all that follows into a file as `troupe run --record` makes it: for troupe.Recording and `troupe replay`.

The file is whole after stop_recording(), or when the simulation is gone. keyframe_interval: in ticks, of whole states, from
which readers begin. Raises RunError for a file that cannot be written; then a step does, when the disk is full.)")
      .def(
          "stop_recording", [](const WorldPointer& world) { world->StopRecording(); },
          "Ends the recording, if there is one.")
      .def(
          "save", [](const WorldPointer& world) { return ValueOf(World::Use(*world)->Save()); },
          "A Snapshot of the whole simulation. Raises RunError if a controller cannot be copied.")
      .def(
          "restore", [](const WorldPointer& world, const SnapshotPointer& snapshot) { world->Restore(*snapshot); },
          py::arg("snapshot").none(false),
          "Continues from a snapshot, of this or of another simulation: the same steps give the same hashes.");
}

// A name or a number of one of `things`, the names of a table.
std::size_t FindThing(World& world, const char* table, const py::object& thing) {
  const StateTable& rows = FindTable(table);
  const SignalView view = world.view();
  const std::size_t count = rows.rows(view.world, view.state);
  const std::size_t kind = KindOf(table);
  const auto number = [&](std::size_t row) { return view.things.first(kind) + static_cast<ThingId>(row); };
  if (!py::isinstance<py::str>(thing)) {
    const std::size_t index = ToIndex(thing, table);
    if (index < count) return index;
    throw py::index_error(fmt::format("{}: found {}, expected one of {}", table, index, count));
  }
  const auto name = thing.cast<std::string>();
  std::vector<std::string> names;
  for (std::size_t row = 0; row < count; ++row) {
    if (!view.things.exists(number(row))) continue;
    names.push_back(view.things.name(number(row)));
    if (names.back() == name) return row;
  }
  throw py::value_error(fmt::format("{}: found '{}', expected {}", table, name,
                                    names.empty() ? "a world with one" : fmt::format("{}", fmt::join(names, ", "))));
}

// A pose (x, y, heading) or (x, y, z, heading); without z at `z`.
Pose ToPose(const py::object& value, double z) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!numbers) PyErr_Clear();
  if (!numbers || numbers.ndim() != 1 || (numbers.size() != 3 && numbers.size() != 4)) {
    throw py::value_error("pose: expected (x, y, heading) or (x, y, z, heading), in m and rad");
  }
  const double* const at = numbers.data();
  return numbers.size() == 3 ? Pose{at[0], at[1], z, at[2]} : Pose{at[0], at[1], at[2], at[3]};
}

// A point, or points one after another: (x, y) or (x, y, z) each.
Goal ToGoal(const py::object& points, const py::object& heading) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(points);
  if (!numbers) PyErr_Clear();
  const py::ssize_t columns = !numbers || numbers.ndim() < 1 ? 0 : numbers.shape(numbers.ndim() - 1);
  if (!numbers || numbers.ndim() > 2 || (columns != 2 && columns != 3)) {
    throw py::value_error("goal: expected a point (x, y) or (x, y, z), in m, or a list of such points");
  }
  Goal goal;
  for (const double* at = numbers.data(); at != numbers.data() + numbers.size(); at += columns) {
    goal.waypoints.emplace_back(at[0], at[1]);
    if (columns == 3) goal.heights.push_back(at[2]);
  }
  if (!heading.is_none()) goal.heading = ToNumber(heading, "heading");
  return goal;
}

std::string Spawn(const WorldPointer& world, const py::object& source, const py::object& pose, const std::string& name,
                  const py::object& controller, const py::object& parameters) {
  std::optional<ControllerDescription> description;
  if (const std::optional<std::string> named = ControllerName(controller)) {
    const py::object text = py::module_::import("json").attr("dumps")(parameters.is_none() ? py::dict() : parameters);
    description = ControllerDescription{*named, text.cast<std::string>()};
  } else if (!parameters.is_none()) {
    throw py::value_error("parameters: found some without a controller");
  }
  std::string found;
  world->Edit([&](Simulation& simulation) {
    found = ValueOf(simulation.Spawn(PathOf(source), ToPose(pose, 0.0), name, description));
  });
  return found;
}

void SendMessage(const WorldPointer& world, const py::object& robot, const std::string& topic,
                 const py::object& message) {
  const std::optional<FleetTopic> known = FindByName<FleetTopic>(topic);
  if (!known || !IsToVehicle(*known)) {
    throw py::value_error(
        fmt::format("topic: found '{}', expected order, instantActions, zoneSet or responses", topic));
  }
  const py::object text =
      py::isinstance<py::str>(message) ? message : py::module_::import("json").attr("dumps")(message);
  const World::Use use(*world);
  RaiseIfBad(use->SendMessage(world->FindRobot(robot), {*known, text.cast<std::string>()}));
}

void DefineChanges(SimulationClass& simulation) {
  simulation
      .def(
          "send_to",
          [](const WorldPointer& world, const py::object& robot, const py::object& goal, const py::object& heading) {
            const World::Use use(*world);
            RaiseIfBad(use->SendTo(world->FindRobot(robot), ToGoal(goal, heading)));
          },
          "robot"_a, "goal"_a, "heading"_a = py::none(),
          R"(Sends a robot to a point (x, y) or (x, y, z), or to several, one after another, as `troupe goto`.

heading: at the last one, rad. Raises InputError for a controller that accepts no goals, and with the reason for a goal
that it cannot reach.)")
      .def(
          "cancel_goal",
          [](const WorldPointer& world, const py::object& robot) {
            const World::Use use(*world);
            use->CancelGoal(world->FindRobot(robot));
          },
          "robot"_a, "The robot has no goal any more.")
      .def("send_message", SendMessage, "robot"_a, "topic"_a, "message"_a,
           R"(Sends a vehicle of VDA 5050 a message of its fleet control, for the next tick.

topic: order, instantActions, zoneSet or responses. message: a dict, or the text of one.)")
      .def(
          "set_door",
          [](const WorldPointer& world, const py::object& door, double opening) {
            const World::Use use(*world);
            RaiseIfBad(use->AddInput({{}, DoorOrder{FindThing(*world, "doors", door), opening}}));
          },
          "door"_a, "opening"_a = 1.0, "Moves a door from the next tick on; opening: 0, closed, to 1.")
      .def(
          "call_lift",
          [](const WorldPointer& world, const py::object& lift, const std::string& floor) {
            const World::Use use(*world);
            const std::size_t number = FindThing(*world, "lifts", lift);
            const std::vector<LiftFloor>& floors = use->world().lifts[number].floors;
            const auto found =
                std::find_if(floors.begin(), floors.end(), [&](const LiftFloor& each) { return each.name == floor; });
            if (found == floors.end()) throw py::value_error(fmt::format("floor: the lift has no '{}'", floor));
            RaiseIfBad(use->AddInput({{}, LiftOrder{number, static_cast<std::size_t>(found - floors.begin())}}));
          },
          "lift"_a, "floor"_a, "Calls a lift to a floor, by its name, from the next tick on.")
      .def(
          "find_pose",
          [](const WorldPointer& world, const std::string& name) {
            return ToRecord(ValueOf(World::Use(*world)->FindPose(name)));
          },
          "name"_a, "The Pose of a robot, an object, a person or another model.")
      .def(
          "set_pose",
          [](const WorldPointer& world, const std::string& name, const py::object& pose) {
            world->Edit([&](Simulation& edited) {
              const Pose before = ValueOf(edited.FindPose(name));
              RaiseIfBad(edited.SetPose(name, ToPose(pose, before.z)));
            });
          },
          "name"_a, "pose"_a,
          R"(Places a robot, an object, a person or another model at (x, y, heading) or (x, y, z, heading), in m and rad.

Without z it stays at its height. What a robot holds falls. Raises RunError where something stands.)")
      .def("spawn", Spawn, "source"_a, "pose"_a, "name"_a = "", py::kw_only(), "controller"_a = py::none(),
           "parameters"_a = py::none(),
           R"(Adds a robot or another model, and returns its name.

source: a model that the world's file or its includes define, a file with one model, or "FILE#NAME". It has the next
number of its kind. name: by default a free one. controller: a name or a class.)")
      .def(
          "delete",
          [](const WorldPointer& world, const std::string& name) {
            world->Edit([&](Simulation& edited) { RaiseIfBad(edited.Delete(name)); });
          },
          "name"_a,
          "Removes a robot, an object, a person or another model. Its number stays free, and arrays keep its row.");
}

void DefineReports(SimulationClass& simulation) {
  simulation
      .def_property_readonly(
          "reports",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            return world->reports;
          },
          "What controllers reported in the last call of `step`, a list of lines.")
      .def_property_readonly(
          "messages",
          [](const WorldPointer& world) {
            const World::Use use(*world);
            const py::object loads = py::module_::import("json").attr("loads");
            py::list messages;
            for (const Simulation::FleetOutput& sent : world->fleet) {
              const std::string& name = use->world().robot(sent.robot).name;
              messages.append(py::make_tuple(sent.tick, name, NameOf(sent.message.topic), loads(sent.message.text)));
            }
            return messages;
          },
          R"(What vehicles of VDA 5050 sent to their fleet control in the last call of `step`: a list of (tick, robot, topic,
message), with topics state, visualization and factsheet, and messages as dicts.)")
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
          "show",
          [](const WorldPointer& world, int height) {
            const std::string address = world->OpenPage({.address = "127.0.0.1", .port = 0});
            return py::module_::import("troupe.picture").attr("Page")(address, height);
          },
          "height"_a = 500,
          "The page of `view` in the cell of a notebook, `height` pixels high: the world can be turned, and follows "
          "the steps.")
      .def(
          "close_view", [](const WorldPointer& world) { world->ClosePage(); },
          "Closes the page; it shows that the run is over.");
}

}  // namespace

void DefineSimulation(py::module_& module) {
  SimulationClass simulation(module, "Simulation",
                             R"(A world in this process.

Robots decide and the step moves them by the code of a distributed run, so that after the same number of ticks the state
hash is that of `troupe run` of the same file. One thread at a time may use a simulation; another one gets a
RuntimeError. Several simulations are independent, and step at the same time in several threads.)");
  DefineSteps(simulation);
  DefineChanges(simulation);
  DefineReports(simulation);
}

}  // namespace troupe::python
