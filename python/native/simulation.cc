// The class troupe.Simulation.
#include "troupe/simulation.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

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

SimulationOptions OptionsOf(const py::object& seed, std::optional<std::string> controller, bool run_controllers) {
  SimulationOptions options;
  if (!seed.is_none()) options.seed = ToSeed(seed, "seed");
  options.controller = std::move(controller);
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
          "save", [](const WorldPointer& world) { return ValueOf(World::Use(*world)->Save()); },
          "A Snapshot of the whole simulation. Raises RunError if a controller cannot be copied.")
      .def(
          "restore", [](const WorldPointer& world, const SnapshotPointer& snapshot) { world->Restore(*snapshot); },
          py::arg("snapshot").none(false),
          "Continues from a snapshot, of this or of another simulation: the same steps give the same hashes.");
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

}  // namespace

void DefineSimulation(py::module_& module) {
  SimulationClass simulation(module, "Simulation",
                             R"(A world in this process.

Robots decide and the step moves them by the code of a distributed run, so that after the same number of ticks the state
hash is that of `troupe run` of the same file. One thread at a time may use a simulation; another one gets a
RuntimeError. Several simulations are independent, and step at the same time in several threads.)");
  DefineSteps(simulation);
  DefineReports(simulation);
}

}  // namespace troupe::python
