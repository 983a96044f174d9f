// The native part of troupe.Recording. States are found by stepping from a keyframe, with a cache; a mutex lets one
// thread search at a time, without the interpreter's lock, so that the others keep running.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "python/native/world.h"
#include "troupe/recorded_simulation.h"

namespace troupe::python {
namespace {

using namespace py::literals;

class RecordedWorlds {
 public:
  explicit RecordedWorlds(RecordedSimulation recorded) : recorded_(std::move(recorded)) {}

  static std::shared_ptr<RecordedWorlds> Open(const py::object& file) {
    const auto path = py::module_::import("os").attr("fsdecode")(file).cast<std::string>();
    std::optional<Result<RecordedSimulation>> opened;
    {
      const py::gil_scoped_release release;
      opened.emplace(RecordedSimulation::Open(path));
    }
    return std::make_shared<RecordedWorlds>(ValueOf(*std::move(opened)));
  }

  // The table of places is constant: it needs no lock.
  const RecordedSimulation& recorded() const { return recorded_; }

  std::shared_ptr<World> At(std::size_t position) {
    if (position >= recorded_.size()) {
      throw py::index_error(fmt::format("found position {}, expected one of {}", position, recorded_.size()));
    }
    std::optional<Result<Simulation>> found;
    {
      const py::gil_scoped_release release;
      const std::lock_guard lock(mutex_);
      found.emplace(recorded_.At(position));
    }
    auto world = std::make_shared<World>(ValueOf(*std::move(found)));
    world->events = world->simulation().events();
    return world;
  }

 private:
  RecordedSimulation recorded_;
  std::mutex mutex_;  // of At
};

using Pointer = std::shared_ptr<RecordedWorlds>;

}  // namespace

void DefineRecording(py::module_& module) {
  py::class_<RecordedWorlds, Pointer>(module, "RecordedStates", "The states of a recording; see troupe.Recording.")
      .def(py::init(&RecordedWorlds::Open), "file"_a)
      .def("__len__", [](const Pointer& states) { return states->recorded().size(); })
      .def(
          "at", [](const Pointer& states, std::size_t position) { return states->At(position); }, "position"_a,
          "The State at a position.")
      .def_property_readonly(
          "ticks",
          [](const Pointer& states) {
            const RecordedSimulation& recorded = states->recorded();
            py::array_t<std::int64_t> ticks(static_cast<py::ssize_t>(recorded.size()));
            std::int64_t* next = ticks.mutable_data();
            for (std::size_t i = 0; i < recorded.size(); ++i) *next++ = static_cast<std::int64_t>(recorded.TickAt(i));
            return ticks;
          },
          "int64 (states,).")
      .def_property_readonly(
          "damage", [](const Pointer& states) { return states->recorded().damage(); },
          "Why the states end before the run; None: they do not.")
      .def_property_readonly(
          "program_version", [](const Pointer& states) { return states->recorded().program_version(); },
          "Of the program that has recorded it.")
      .def_property_readonly(
          "world_file", [](const Pointer& states) { return states->recorded().world_file(); },
          "The world or scenario, as the run was given it.");
}

}  // namespace troupe::python
