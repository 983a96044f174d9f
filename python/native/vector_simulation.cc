// The class troupe.VectorSimulation: many copies of a world, stepped by all cores, with arrays over all of them.
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "python/native/convert.h"
#include "python/native/worlds.h"

namespace troupe::python {
namespace {

using namespace py::literals;
constexpr std::size_t kMaxWorlds = 1'000'000;

// A method for pybind11, which passes an instance without content (VectorSimulation.__new__) as an error to a function
// of a pointer like this, but not to a method.
template <typename Value, typename... Arguments>
auto Held(Value (Worlds::*method)(Arguments...)) {
  return
      [method](const WorldsPointer& worlds, Arguments... arguments) { return (worlds.get()->*method)(arguments...); };
}
template <typename Value, typename... Arguments>
auto Held(Value (Worlds::*method)(Arguments...) const) {
  return
      [method](const WorldsPointer& worlds, Arguments... arguments) { return (worlds.get()->*method)(arguments...); };
}

// A method that writes parts(row) of each row of a table of the states: (worlds, rows, columns); for no columns, which
// is one part, (worlds, rows).
template <auto table, typename Parts>
auto Rows(std::size_t columns, const Parts& parts) {
  return [columns, parts](const WorldsPointer& worlds, const py::object& out) {
    return worlds->FillRows<table>(out, columns, "out", [&](World& world, auto* next) {
      using Number = std::remove_pointer_t<decltype(next)>;
      for (const auto& row : world.simulation().state().*table) {
        for (const double part : parts(row)) *next++ = static_cast<Number>(part);
      }
    });
  };
}

std::array<double, 4> PartsOf(const Pose& pose) {
  return {pose.x, pose.y, pose.z, pose.heading};
}

std::vector<std::uint64_t> SeedsOf(const py::object& seeds, std::size_t count, std::uint64_t first) {
  std::vector<std::uint64_t> list;
  if (seeds.is_none()) {
    for (std::size_t i = 0; i < count; ++i) list.push_back(first + i);
    return list;
  }
  for (const py::handle seed : py::iter(seeds)) list.push_back(ToSeed(seed, "seeds"));
  if (list.size() != count) throw py::value_error(fmt::format("seeds: found {}, expected {}", list.size(), count));
  return list;
}

WorldsPointer Load(const py::object& world, const py::object& num_envs, const py::object& seeds, std::int64_t threads,
                   const py::object& controller, bool run_controllers) {
  std::vector<py::object> list;  // of a list
  const bool is_list = py::isinstance<py::list>(world) || py::isinstance<py::tuple>(world);
  if (is_list) list = world.cast<std::vector<py::object>>();
  if (num_envs.is_none() && !is_list) throw py::type_error("num_envs: expected the number of worlds");
  const auto count = num_envs.is_none() ? static_cast<std::int64_t>(list.size()) : num_envs.cast<std::int64_t>();
  if (is_list && count != static_cast<std::int64_t>(list.size())) {
    throw py::value_error(fmt::format("num_envs: found {}, expected {}, one for each world", count, list.size()));
  }
  if (count < 1 || count > static_cast<std::int64_t>(kMaxWorlds)) {
    throw py::value_error(fmt::format("num_envs: found {}, expected 1 to {}", count, kMaxWorlds));
  }
  if (threads < 0 || threads > 1024) {
    throw py::value_error(fmt::format("threads: found {}, expected 0 to 1024", threads));
  }
  SimulationOptions options;
  options.controller = ControllerName(controller);
  options.run_controllers = run_controllers;
  std::vector<std::shared_ptr<World>> worlds;
  const auto size = static_cast<std::size_t>(count);
  std::vector<Snapshot> starts;
  const auto add = [&](std::shared_ptr<World> loaded) {
    starts.push_back(ValueOf(loaded->simulation().Save()));
    worlds.push_back(std::move(loaded));
  };
  const bool is_function = PyCallable_Check(world.ptr()) != 0;
  const auto input = [&](std::size_t i, std::optional<std::uint64_t> seed) {
    return WorldInput(is_list ? list[i] : world, seed);
  };
  std::uint64_t first = 1;  // of a function
  if (seeds.is_none() && !is_function) {
    add(World::Load(input(0, std::nullopt), options));
    first = worlds[0]->simulation().world().seed;
  }
  const std::vector<std::uint64_t> each = SeedsOf(seeds, size, first);
  for (std::size_t i = worlds.size(); i < size; ++i) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    // A copy that an earlier one has with this seed is continued from it, with the same start.
    const auto same = std::find_if(worlds.begin(), worlds.end(), [&](const auto& other) {
      return !is_list && !is_function && other->simulation().world().seed == each[i];
    });
    if (same != worlds.end()) {
      const Snapshot start = starts[static_cast<std::size_t>(same - worlds.begin())];
      starts.push_back(start);
      worlds.push_back(std::make_shared<SteppedWorld>(ValueOf(Simulation::Continue(start))));
      continue;
    }
    options.seed = each[i];
    if (!worlds.empty()) options.share_with = &worlds[0]->simulation();
    add(World::Load(input(i, options.seed), options));
    if (worlds.back()->simulation().world().robots.size() != worlds[0]->simulation().world().robots.size()) {
      throw py::value_error("the numbers of robots differ between the worlds");
    }
  }
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  return std::make_shared<Worlds>(std::move(worlds), std::move(starts),
                                  threads == 0 ? cores : static_cast<std::size_t>(threads));
}

// The functions that write the states of all worlds into arrays.
void DefineArrays(py::class_<Worlds, WorldsPointer>& simulation) {
  simulation
      .def("poses", Rows<&WorldState::robots>(4, [](const RobotState& robot) { return PartsOf(robot.X_WR); }),
           "out"_a = py::none(), "(worlds, robots, 4): x, y, z (m), heading (rad).")
      .def("twists",
           Rows<&WorldState::robots>(3,
                                     [](const RobotState& robot) {
                                       return std::array{robot.twist.vx, robot.twist.vy, robot.twist.wz};
                                     }),
           "out"_a = py::none(), "(worlds, robots, 3): vx, vy (m/s), wz (rad/s), executed in the last tick.")
      .def("stalls",
           Rows<&WorldState::robots>(0, [](const RobotState& robot) { return std::array{robot.stalled ? 1.0 : 0.0}; }),
           "out"_a = py::none(), "(worlds, robots): 1 where a contact ended the last motion, else 0.")
      .def("object_poses",
           Rows<&WorldState::objects>(4, [](const ObjectState& object) { return PartsOf(object.X_WO); }),
           "out"_a = py::none(), "(worlds, objects, 4): as `poses`.")
      .def("joint_positions",
           Rows<&WorldState::joints>(0, [](const JointState& joint) { return std::array{joint.position}; }),
           "out"_a = py::none(), "(worlds, joints): m or rad.")
      .def("energy", Rows<&WorldState::stores>(0, [](const StoreState& store) { return std::array{store.joules}; }),
           "out"_a = py::none(), "(worlds, stores): J, in the order of the file.")
      .def("ranges", Held(&Worlds::Ranges), "sensor"_a = "ranger", "out"_a = py::none(),
           "(worlds, robots, rays): the ranges of a ranger of each robot, m; see Simulation.ranges.")
      .def("points", Held(&Worlds::Points), "sensor"_a = "ranger", "out"_a = py::none(),
           "(worlds, robots, rays, 3): where the rays have hit, m in R; nan without a hit.")
      .def("receptions", Held(&Worlds::Receptions), "sensor"_a = "radio",
           R"(The radio messages that arrive at this tick, of the radio of each robot: a dict of columns.

"rows", int64 (worlds,), says how many each world has; the others are arrays (worlds, rows), with -1, False or nan where a
world has fewer: the numbers "receiver" and "sender" of the robots, the "tick" of sending, "to_all", "rssi" (dBm), and
"range" (m), "bearing" and "elevation" (rad) of the sender. "data" is a tuple of bytes for each world.)")
      .def(
          "images",
          [](const WorldsPointer& worlds, const py::object& sensor, const py::object& out) {
            return worlds->Images<&CameraReading::colors, std::uint8_t>(sensor, out, "uint8", {3});
          },
          "sensor"_a = "camera", "out"_a = py::none(),
          "uint8 (worlds, robots, height, width, 3): the pictures of all cameras; see Simulation.images.")
      .def(
          "depths",
          [](const WorldsPointer& worlds, const py::object& sensor, const py::object& out) {
            return worlds->Images<&CameraReading::depths, float>(sensor, out, "float32", {});
          },
          "sensor"_a = "camera", "out"_a = py::none(),
          "float32 (worlds, robots, height, width): m ahead; see Simulation.depths.")
      .def("table", Held(&Worlds::Table), "name"_a,
           R"(A table of things of all worlds, such as "doors": a dict with the columns of Simulation.table.

The worlds are the first axis. Numbers and truths are arrays (worlds, rows) of float64 and bool. "rows", int64 (worlds,),
says how many rows each world has; where one has fewer than others, the rest of its numbers is nan and of its truths
False. "name" and the other texts are a tuple for each world, as long as it has rows. Raises ValueError for another name.)");
}

}  // namespace

void DefineVectorSimulation(py::module_& module) {
  py::class_<Worlds, WorldsPointer> simulation(module, "VectorSimulation",
                                               R"(Many copies of one world, stepped together by all cores.

Each has a seed of its own, and the state hashes of a Simulation with that seed. Copies with equal seeds share all
constant parts of the world, the others the map. `vector[i]` is copy i as a Simulation. Arrays have the shape
(worlds, robots, ...); they are written into `out`, if it is given: a writable array of float32 or float64 in one piece.
Every array supports DLPack, as numpy's do. As of a Simulation, one thread at a time may use it.)");
  simulation
      .def(py::init(&Load), "world"_a, "num_envs"_a = py::none(), py::kw_only(), "seeds"_a = py::none(),
           "threads"_a = 0, "controller"_a = py::none(), "run_controllers"_a = true,
           R"(Loads a world `num_envs` times; the arguments are as those of Simulation.

Worlds that differ, with equal numbers of robots, come from a list of worlds, or from a function of the seed. seeds: one
for each; by default the file's (of a function 1), and the numbers after it. threads: 0 is one for each core.)")
      .def("__len__", Held(&Worlds::size))
      .def("__getitem__", Held(&Worlds::At), "index"_a)
      .def_property_readonly("num_envs", Held(&Worlds::size), "The number of worlds.")
      .def_property_readonly("num_robots", Held(&Worlds::robots), "Of each world.")
      .def_property_readonly("threads", Held(&Worlds::threads), "That step the worlds.")
      .def(
          "step",
          [](const WorldsPointer& worlds, std::int64_t ticks) {
            if (ticks < 0) throw py::value_error(fmt::format("ticks: found {}, expected 0 or more", ticks));
            worlds->Step(static_cast<Tick>(ticks));
          },
          "ticks"_a = 1, "Advances all worlds. After a KeyboardInterrupt they may be at different ticks.")
      .def(
          "drive", Held(&Worlds::Drive), "motion"_a, "grippers"_a = py::none(),
          R"(Drives all robots: an array (worlds, robots, 3) of vx, vy (m/s), wz (rad/s), or (worlds, robots, 2) of vx, wz.

grippers: (worlds, grippers, 2): opening, 0 to 100 percent, where 0 closes, and lift, percent; nan: as commanded last.)")
      .def("held", Held(&Worlds::Held), "out"_a = py::none(),
           "(worlds, grippers): the number of the object that each gripper holds, -1: none.")
      .def("reset", Held(&Worlds::Reset), "which"_a = py::none(), "snapshots"_a = py::none(),
           R"(Sets worlds back to their start, or to a snapshot.

which: a mask (worlds,) or numbers of worlds; None: all. snapshots: one for all, or one for each world of `which`.)")
      .def("save", Held(&Worlds::Save), "A list of a Snapshot of each world.")
      .def_property_readonly(
          "state_hashes",
          [](const WorldsPointer& worlds) {
            py::array_t<std::uint64_t> hashes(static_cast<py::ssize_t>(worlds->size()));
            std::uint64_t* next = hashes.mutable_data();
            for (const auto& world : worlds->worlds()) *next++ = World::Use(*world)->state_hash();
            return hashes;
          },
          "uint64 (worlds,).")
      .def_property_readonly(
          "ticks",
          [](const WorldsPointer& worlds) {
            py::array_t<std::int64_t> ticks(static_cast<py::ssize_t>(worlds->size()));
            std::int64_t* next = ticks.mutable_data();
            for (const auto& world : worlds->worlds()) *next++ = static_cast<std::int64_t>(World::Use(*world)->tick());
            return ticks;
          },
          "int64 (worlds,).");
  DefineArrays(simulation);
}

}  // namespace troupe::python
