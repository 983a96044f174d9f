// The class troupe.VectorSimulation: many copies of a world, stepped by all cores, with arrays over all of them.
//
// Worlds are independent: threads fetch the next world by an atomic counter, so that slow worlds do not hold up a fixed
// share, and the result does not depend on which thread steps which world. A call claims all worlds first (Uses) and
// releases them at its end. Copies share the constant parts of their scenes. With controllers in Python only one thread
// works at a time, because of the interpreter's lock.
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/signals/state_tables.h"
#include "python/native/convert.h"
#include "python/native/world.h"

namespace troupe::python {
namespace {

using namespace py::literals;
constexpr std::size_t kMaxWorlds = 1'000'000;

// Uses of all worlds, for one call.
class Uses {
 public:
  explicit Uses(const std::vector<std::shared_ptr<World>>& worlds) {
    uses_.reserve(worlds.size());
    for (const std::shared_ptr<World>& world : worlds) uses_.push_back(std::make_unique<World::Use>(*world));
  }

 private:
  std::vector<std::unique_ptr<World::Use>> uses_;
};

class Worlds {
 public:
  Worlds(std::vector<std::shared_ptr<World>> worlds, std::vector<Snapshot> starts, std::size_t threads)
      : worlds_(std::move(worlds)),
        starts_(std::move(starts)),
        robots_(worlds_[0]->simulation().world().robots.size()),
        pool_(std::min(threads, worlds_.size())) {
    for (const std::shared_ptr<World>& world : worlds_) calls_python_ |= world->calls_python();
  }

  std::size_t size() const { return worlds_.size(); }
  std::size_t robots() const { return robots_; }
  const std::vector<std::shared_ptr<World>>& worlds() const { return worlds_; }
  std::size_t threads() const { return pool_.size(); }

  void Step(Tick ticks) {
    const Uses uses(worlds_);
    for (const std::shared_ptr<World>& world : worlds_) world->ClearOutputs();
    ForEachWorld([ticks](World& world, Interrupt& interrupt) {
      for (Tick i = 0; i < ticks && !interrupt.IsDue(); ++i) world.StepOnce();
    });
  }

  // (worlds, robots, 2 or 3), and of grippers (worlds, grippers, 2). All are checked before any is commanded: an error
  // leaves no world half commanded.
  void Drive(const py::object& motion, const py::object& grippers) {
    const Uses uses(worlds_);
    const auto twists = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(motion);
    if (!twists) PyErr_Clear();
    if (!twists || twists.ndim() != 3 || twists.shape(0) != static_cast<py::ssize_t>(size()) ||
        twists.shape(1) != static_cast<py::ssize_t>(robots()) || (twists.shape(2) != 2 && twists.shape(2) != 3)) {
      throw py::value_error(fmt::format(
          "motion: expected an array ({0}, {1}, 3) of vx, vy, wz or ({0}, {1}, 2) of vx, wz", size(), robots()));
    }
    CheckFinite(twists, "motion");
    for (const std::shared_ptr<World>& world : worlds_) world->CheckRobots(robots());
    if (!grippers.is_none()) CommandGrippers(grippers);
    const double* row = twists.data();
    const py::ssize_t columns = twists.shape(2);
    for (const std::shared_ptr<World>& world : worlds_) {
      for (std::size_t i = 0; i < robots(); ++i, row += columns) {
        RaiseIfBad(world->simulation().DriveBy(RobotId(i), {row[0], columns == 3 ? row[1] : 0.0, row[columns - 1]}));
      }
    }
  }

  // Writes the number of the object that each gripper holds, or -1.
  py::array Held(const py::object& out) {
    return FillRows<&WorldState::grippers>(out, 0, "out", [](World& world, auto* next) {
      using Number = std::remove_pointer_t<decltype(next)>;
      const WorldState& state = world.simulation().state();
      for (std::size_t i = 0; i < state.grippers.size(); ++i) {
        const std::optional<ObjectId> object = state.grippers[i].clamped;
        const bool holds = object && state.objects[object->index()].holder == GripperId(i);
        *next++ = holds ? static_cast<Number>(object->index()) : Number{-1};
      }
    });
  }

  // Restores the starts of the chosen worlds, or the snapshots given for them.
  void Reset(const py::object& which, const py::object& snapshots) {
    std::vector<std::size_t> chosen = Choose(which);
    std::vector<Snapshot> from;
    if (snapshots.is_none()) {
      for (const std::size_t i : chosen) from.push_back(starts_[i]);
    } else if (py::isinstance<Snapshot>(snapshots)) {
      from.assign(chosen.size(), *snapshots.cast<SnapshotPointer>());
    } else {
      for (const SnapshotPointer& each : snapshots.cast<std::vector<SnapshotPointer>>()) {
        if (each == nullptr) throw py::type_error("snapshots: found None, expected a Snapshot");
        from.push_back(*each);
      }
    }
    if (from.size() != chosen.size()) {
      throw py::value_error(fmt::format("snapshots: found {}, expected {}", from.size(), chosen.size()));
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) worlds_[chosen[i]]->Restore(from[i]);
  }

  std::vector<Snapshot> Save() {
    const Uses uses(worlds_);
    std::vector<Snapshot> snapshots;
    for (const std::shared_ptr<World>& world : worlds_) snapshots.push_back(ValueOf(world->simulation().Save()));
    return snapshots;
  }

  // Calls write(world, row) with the place of each world in an array (worlds, ...) of `Number`.
  template <typename Number, typename Write>
  void Fill(Number* data, std::size_t per_world, const Write& write) {
    ForEachWorldByIndex([&](std::size_t i, Interrupt&) { write(*worlds_[i], data + i * per_world); });
  }

  // Of the table `table` of the states: (worlds, rows, columns), or (worlds, rows) for no columns.
  template <auto table = &WorldState::robots, typename Write>
  py::array FillRows(const py::object& out, std::size_t columns, const char* what, const Write& write) {
    const Uses uses(worlds_);
    const std::size_t rows = (worlds_[0]->simulation().state().*table).size();
    for (const std::shared_ptr<World>& world : worlds_) {
      world->CheckRobots(robots());
      if (const std::size_t found = (world->simulation().state().*table).size(); found != rows) {
        throw py::value_error(fmt::format("a world has {} rows of this array, expected {}", found, rows));
      }
    }
    std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(size()), static_cast<py::ssize_t>(rows)};
    if (columns > 0) shape.push_back(static_cast<py::ssize_t>(columns));
    py::array array = out.is_none() ? py::array(py::array_t<double>(shape)) : OutputArray(out, shape, what);
    const std::size_t per_world = rows * std::max<std::size_t>(columns, 1);
    if (array.dtype().itemsize() == sizeof(float)) {
      Fill(static_cast<float*>(array.mutable_data()), per_world, write);
    } else {
      Fill(static_cast<double*>(array.mutable_data()), per_world, write);
    }
    return array;
  }

  py::array Ranges(const py::object& sensor, const py::object& out) {
    std::vector<std::size_t> sensors;
    std::size_t rays = 0;
    {
      const Uses uses(worlds_);
      sensors = worlds_[0]->FindSensors(sensor);
      rays = worlds_[0]->CountRays(sensors);
    }
    if (rays == 0) throw py::value_error("the worlds have no robots with rays");
    return FillRows(out, rays, "out", [&](World& world, auto* row) { world.CopyRanges(sensors, rays, row); });
  }

  // Of the cameras of all robots: (worlds, robots, height, width, channels ...).
  template <auto part, typename Value>
  py::array Images(const py::object& sensor, const py::object& out, const char* type,
                   const std::vector<py::ssize_t>& channels) {
    const Uses uses(worlds_);
    const std::vector<std::size_t> sensors = worlds_[0]->FindSensors(sensor);
    const std::pair<std::size_t, std::size_t> size_of_image = worlds_[0]->ImageShape(sensors);
    std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(size()), static_cast<py::ssize_t>(robots()),
                                      static_cast<py::ssize_t>(size_of_image.first),
                                      static_cast<py::ssize_t>(size_of_image.second)};
    shape.insert(shape.end(), channels.begin(), channels.end());
    py::array_t<Value> array = ArrayOf<Value>(out, shape, type);
    const auto per_world = static_cast<std::size_t>(array.size()) / size();
    Fill(array.mutable_data(), per_world,
         [&](World& world, Value* row) { world.CopyImages<part>(sensors, size_of_image, row); });
    return array;
  }

  // The columns of a table of things, each with the worlds as its first axis.
  py::dict Table(const std::string& name) {
    const StateTable& table = FindTable(name);
    const Uses uses(worlds_);
    std::vector<SignalView> views;
    py::array_t<std::int64_t> rows(static_cast<py::ssize_t>(size()));
    std::size_t most = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      views.push_back(worlds_[i]->view());
      const std::size_t count = table.rows(views[i].world, views[i].state);
      rows.mutable_data()[i] = static_cast<std::int64_t>(count);
      most = std::max(most, count);
    }
    py::dict columns;
    columns["rows"] = rows;
    if (!table.varies) {
      columns["name"] = TextsOf(rows, [&, kind = KindOf(name)](std::size_t world, std::size_t row) {
        const Things& things = views[world].things;
        return things.name(things.first(kind) + static_cast<ThingId>(row));
      });
    }
    for (const Signal& signal : table.signals) {
      const py::str column(signal.name);
      if (signal.type == ValueType::kText) {
        columns[column] =
            TextsOf(rows, [&](std::size_t world, std::size_t row) { return signal.text(views[world], row); });
      } else if (signal.type == ValueType::kTruth) {
        columns[column] = NumbersOf<bool>(signal, views, rows, most);
      } else {
        columns[column] = NumbersOf<double>(signal, views, rows, most);
      }
    }
    return columns;
  }

  std::shared_ptr<World> At(py::ssize_t index) const {
    if (index < 0) index += static_cast<py::ssize_t>(size());
    if (index < 0 || index >= static_cast<py::ssize_t>(size())) {
      throw py::index_error(fmt::format("found world {}, expected one of {}", index, size()));
    }
    return worlds_[static_cast<std::size_t>(index)];
  }

 private:
  // A tuple of texts for each world: text(world, row).
  template <typename Text>
  static py::tuple TextsOf(const py::array_t<std::int64_t>& rows, const Text& text) {
    py::tuple worlds(static_cast<std::size_t>(rows.size()));
    for (std::size_t world = 0; world < worlds.size(); ++world) {
      py::tuple texts(static_cast<std::size_t>(rows.data()[world]));
      for (std::size_t row = 0; row < texts.size(); ++row) texts[row] = py::str(text(world, row));
      worlds[world] = std::move(texts);
    }
    return worlds;
  }

  // (worlds, most): the rows that a world has not are nan, or false.
  template <typename Number>
  py::array NumbersOf(const Signal& signal, const std::vector<SignalView>& views, const py::array_t<std::int64_t>& rows,
                      std::size_t most) {
    py::array_t<Number> numbers({static_cast<py::ssize_t>(size()), static_cast<py::ssize_t>(most)});
    Number* const data = numbers.mutable_data();
    const std::int64_t* const counts = rows.data();
    ForEachWorldByIndex([&](std::size_t world, Interrupt&) {
      const auto count = static_cast<std::size_t>(counts[world]);
      for (std::size_t row = 0; row < most; ++row) {
        const double number = row < count ? signal.number(views[world], row) : kNoNumber;
        Number& cell = data[world * most + row];
        if constexpr (std::is_same_v<Number, bool>) {
          cell = row < count && number != 0.0;
        } else {
          cell = number;
        }
      }
    });
    return numbers;
  }

  // Opening and lift of each gripper of each world, percent; not a number: it keeps its last command.
  void CommandGrippers(const py::object& percents) {
    const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(percents);
    if (!rows) PyErr_Clear();
    const std::size_t count = worlds_[0]->simulation().world().grippers.size();
    if (!rows || rows.ndim() != 3 || rows.shape(0) != static_cast<py::ssize_t>(size()) ||
        rows.shape(1) != static_cast<py::ssize_t>(count) || rows.shape(2) != 2) {
      throw py::value_error(
          fmt::format("grippers: expected an array ({}, {}, 2) of opening and lift, percent", size(), count));
    }
    for (py::ssize_t i = 0; i < rows.size(); ++i) {
      if (const double percent = rows.data()[i]; percent < 0.0 || percent > 100.0) {
        throw py::value_error(fmt::format("grippers: found {}, expected 0 to 100, or nan", percent));
      }
    }
    for (const std::shared_ptr<World>& world : worlds_) {
      if (const std::size_t found = world->simulation().world().grippers.size(); found != count) {
        throw py::value_error(fmt::format("a world has {} grippers, expected {}", found, count));
      }
    }
    const double* row = rows.data();
    for (const std::shared_ptr<World>& world : worlds_) {
      Simulation& simulation = world->simulation();
      const std::vector<GripperDescription>& grippers = simulation.world().grippers;
      std::vector<Command> commands(simulation.world().robots.size());
      std::vector<std::size_t> counts(commands.size());  // the grippers of a robot are in the order of the world's
      for (const GripperDescription& gripper : grippers) {
        const std::size_t robot = gripper.robot.index();
        GripperCommand command{.gripper = counts[robot]++};
        if (!std::isnan(row[0])) command.opening = row[0];
        if (!std::isnan(row[1])) command.lift = row[1];
        if (command.opening || command.lift) commands[robot].grippers.push_back(command);
        row += 2;
      }
      for (std::size_t i = 0; i < commands.size(); ++i) {
        if (!commands[i].grippers.empty()) RaiseIfBad(simulation.Drive(RobotId(i), std::move(commands[i])));
      }
    }
  }

  std::vector<std::size_t> Choose(const py::object& which) const {
    std::vector<std::size_t> chosen;
    if (which.is_none()) {
      for (std::size_t i = 0; i < size(); ++i) chosen.push_back(i);
      return chosen;
    }
    const auto array = py::array::ensure(which);
    if (!array) PyErr_Clear();
    if (array && array.dtype().kind() == 'b') {
      const auto mask = py::array_t<bool, py::array::c_style | py::array::forcecast>::ensure(array);
      if (mask.ndim() != 1 || mask.shape(0) != static_cast<py::ssize_t>(size())) {
        throw py::value_error(fmt::format("which: expected a mask ({},)", size()));
      }
      for (std::size_t i = 0; i < size(); ++i) {
        if (mask.data()[i]) chosen.push_back(i);
      }
      return chosen;
    }
    std::vector<bool> is_chosen(size());
    for (const py::handle row : py::iter(which)) {
      chosen.push_back(ToIndex(row, "which"));
      if (chosen.back() >= size()) {
        throw py::index_error(fmt::format("found world {}, expected one of {}", chosen.back(), size()));
      }
      // A mask of whole numbers, which is none.
      if (is_chosen[chosen.back()]) {
        throw py::value_error(fmt::format("which: found world {} twice, expected each once, or a mask of bool ({},)",
                                          chosen.back(), size()));
      }
      is_chosen[chosen.back()] = true;
    }
    return chosen;
  }

  template <typename Work>
  void ForEachWorld(const Work& work) {
    ForEachWorldByIndex([&](std::size_t i, Interrupt& interrupt) { work(*worlds_[i], interrupt); });
  }

  // Calls work(i, interrupt) on all threads, without the interpreter's lock.
  template <typename Work>
  void ForEachWorldByIndex(const Work& work) {
    RunInterruptibly(calls_python_, [&](Interrupt& interrupt) {
      std::atomic<std::size_t> next = 0;
      pool_.Run(pool_.size(), [&](std::size_t) {
        for (std::size_t i = next++; i < size() && !interrupt.IsDue(); i = next++) work(i, interrupt);
      });
    });
  }

  std::vector<std::shared_ptr<World>> worlds_;  // of the same file; at least one
  std::vector<Snapshot> starts_;                // by world
  std::size_t robots_;                          // of each world
  bool calls_python_ = false;
  ThreadPool pool_;
};

using WorldsPointer = std::shared_ptr<Worlds>;

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
