// Worlds: many copies of a world with the threads that step them, the class troupe.VectorSimulation.
//
// Worlds are independent: threads fetch the next world by an atomic counter, so that slow worlds do not hold up a fixed
// share, and the result does not depend on which thread steps which world. A call claims all worlds first (Uses) and
// releases them at its end. Copies share the constant parts of their scenes. With controllers in Python only one thread
// works at a time, because of the interpreter's lock.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/signals/state_tables.h"
#include "python/native/convert.h"
#include "python/native/world.h"

namespace troupe::python {

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
    for (const std::shared_ptr<World>& world : worlds_) world->RaiseIfNotRecorded();
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
    const auto [sensors, rays] = FindRays(sensor);
    return FillRows(out, rays, "out", [&, found = sensors, count = rays](World& world, auto* row) {
      world.CopyRanges(found, count, row);
    });
  }

  // (worlds, robots, rays, 3)
  py::array Points(const py::object& sensor, const py::object& out) {
    const auto [sensors, rays] = FindRays(sensor);
    const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(size()), static_cast<py::ssize_t>(robots()),
                                            static_cast<py::ssize_t>(rays), 3};
    const std::vector<py::ssize_t> flat = {shape[0], shape[1], shape[2] * 3};
    py::array array = out.is_none() ? py::array(py::array_t<double>(shape)) : OutputArray(out, shape, "out");
    // The same memory, with points one after another.
    FillRows(array.attr("reshape")(flat), rays * 3, "out",
             [&, found = sensors, count = rays](World& world, auto* row) { world.CopyPoints(found, count, row); });
    return array;
  }

  // What the radios of all robots receive.
  py::dict Receptions(const py::object& sensor);

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

  // Calls work(i, interrupt) for each world, on all threads, without the interpreter's lock.
  template <typename Work>
  void ForEachWorldByIndex(const Work& work) {
    ForEachWorldByThread([&](std::size_t i, std::size_t, Interrupt& interrupt) { work(i, interrupt); });
  }
  // Calls work(i, thread, interrupt); thread: below threads().
  template <typename Work>
  void ForEachWorldByThread(const Work& work) {
    RunInterruptibly(calls_python_, [&](Interrupt& interrupt) {
      std::atomic<std::size_t> next = 0;
      pool_.Run(pool_.size(), [&](std::size_t thread) {
        for (std::size_t i = next++; i < size() && !interrupt.IsDue(); i = next++) work(i, thread, interrupt);
      });
    });
  }

 private:
  // The sensor of each robot of a world, and its number of rays.
  std::pair<std::vector<std::size_t>, std::size_t> FindRays(const py::object& sensor) {
    const Uses uses(worlds_);
    std::vector<std::size_t> sensors = worlds_[0]->FindSensors(sensor);
    const std::size_t rays = worlds_[0]->CountRays(sensors);
    if (rays == 0) throw py::value_error("the worlds have no robots with rays");
    return {std::move(sensors), rays};
  }

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

  std::vector<std::shared_ptr<World>> worlds_;  // of the same file; at least one
  std::vector<Snapshot> starts_;                // by world
  std::size_t robots_;                          // of each world
  bool calls_python_ = false;
  ThreadPool pool_;
};

using WorldsPointer = std::shared_ptr<Worlds>;

}  // namespace troupe::python
