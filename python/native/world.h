// World: a simulation as Python sees it, the class troupe.Simulation, or, without steps, troupe.State.
//
// Threads: long work (steps, loading, pictures) is done without the interpreter's lock, so that other threads of Python
// run meanwhile. A Simulation is for one thread at a time; Use makes every call claim it and refuses another one with
// an exception instead of waiting: a wait could deadlock with the lock of the interpreter, and a controller that calls
// its own simulation would wait for itself.
//
// Ctrl-C: signal handlers of Python run in its main thread only when that asks; steps ask every 20 ms. With controllers
// in Python the work is on another thread, so that the exception of a signal cannot arise inside a controller; in one
// that does not return within a second it is raised all the same.
//
// The end of Python: a thread that wants the interpreter's lock back then is ended in the middle of C++, which aborts
// the process. So long work ends early, and the end waits for it (AwaitCalls).
//
// Errors of the library become InputError or RunError with file, line and column; wrong arguments become Python's own.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/signals/state_tables.h"
#include "troupe/simulation.h"
#include "troupe/simulation_page.h"
#include "troupe/simulation_recorder.h"

namespace troupe::python {

namespace py = pybind11;

inline constexpr std::chrono::milliseconds kSignalPeriod(20);  // between two looks for Ctrl-C

// Throws the exception troupe.InputError or troupe.RunError, with the error's place as attributes.
[[noreturn]] void Raise(const Error& error);
void RaiseIfBad(const Status& status);
template <typename Value>
Value ValueOf(Result<Value> result) {
  if (!result.ok()) Raise(result.error());
  return std::move(result).value();
}

// Whether long work is to end early: because of Ctrl-C, or of the end of Python. From any thread.
class Interrupt {
 public:
  // `looks_for_signals`: the thread of the constructor does, in IsDue.
  explicit Interrupt(bool looks_for_signals) : looks_for_signals_(looks_for_signals) {}

  // To be asked often, without the interpreter's lock.
  bool IsDue();
  // With the interpreter's lock: whether a handler of a signal has raised an exception.
  bool HasSignal();
  // Throws that exception, if there is one.
  void RethrowSignal() const;

 private:
  const bool looks_for_signals_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> is_due_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();  // of the caller
  std::exception_ptr signal_;
};

// Calls work(interrupt) without the interpreter's lock, and throws KeyboardInterrupt when `work` has ended because of
// Ctrl-C. With `calls_python` it works on another thread: a signal's exception must not arise in a controller, which
// the main thread would run.
void RunInterruptibly(bool calls_python, const std::function<void(Interrupt& interrupt)>& work);

// To be called once when Python begins to end: ends calls of RunInterruptibly on all threads, and waits for them.
void AwaitCalls();

using SnapshotPointer = std::shared_ptr<Snapshot>;

class SteppedWorld;

// What a world is made of, for one load: a path, or a scenario as a dict, a troupe.World or a function of the seed
// (troupe/world.py). REQUIRES: the interpreter's lock, also at the end.
class WorldInput {
 public:
  // Throws TypeError for another object.
  WorldInput(const py::object& world, std::optional<std::uint64_t> seed);

  Result<Simulation> Load(const SimulationOptions& options) const;

 private:
  std::string path_;
  std::optional<std::string> scenario_;
  py::object files_;  // of its maps, which end with this; or none
};

// The name of a controller, or a class of this process; nothing for None.
std::optional<std::string> ControllerName(const py::object& controller);

// A simulation at a tick: a troupe.State, which can be read.
class World {
 public:
  static std::shared_ptr<SteppedWorld> Load(const WorldInput& input, const SimulationOptions& options);
  explicit World(Simulation simulation);
  virtual ~World();  // Python knows the class of an instance by it
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // The simulation, for one call: another thread that uses it is an error.
  class Use {
   public:
    explicit Use(World& world);
    ~Use() { world_.used_.store(false, std::memory_order_release); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    Simulation* operator->() const { return &world_.simulation_; }
    Simulation& operator*() const { return world_.simulation_; }

   private:
    World& world_;
  };

  // A robot by its name or number. The error names the robots.
  RobotId FindRobot(py::handle robot);
  // A sensor of the robot by its name, type or number. REQUIRES: a Use exists, here and below.
  std::size_t FindSensor(RobotId robot, py::handle sensor);
  std::size_t sensor_count(RobotId robot) const { return sensor_counts_[robot.index()]; }

  // Until goes_on(simulation), called after each tick without the interpreter's lock, is false.
  void Step(Tick ticks, const std::function<bool(const Simulation&)>& goes_on = {});
  // Steps once, and collects events and reports. Without the interpreter's lock.
  void StepOnce();
  void Restore(const Snapshot& snapshot);
  // Calls change(simulation), which throws if it fails, and follows what it has changed.
  template <typename Change>
  void Edit(const Change& change) {
    const Use use(*this);
    const std::size_t before = simulation_.events().size();
    change(simulation_);
    FollowEdit(before);
  }
  // Opens the page, if it is not open, and returns its address.
  std::string OpenPage(const SimulationPageOptions& options);
  void ClosePage();
  // Records from the present state on, into a file that is whole when StopRecording has returned, or with the end of
  // this.
  void StartRecording(const std::string& file, Tick keyframe_interval);
  void StopRecording();
  // Throws the error of the recording, once: StepOnce cannot. REQUIRES: the interpreter's lock
  void RaiseIfNotRecorded();
  // Of the last call of Step.
  std::vector<Event> events;
  std::vector<std::string> reports;
  std::vector<Simulation::FleetOutput> fleet;
  void ClearOutputs() {
    events.clear();
    reports.clear();
    fleet.clear();
  }

  // The rays of the first robot's sensor. The error is a sensor that is no ranger.
  std::size_t CountRays(const std::vector<std::size_t>& sensors);
  // Writes the ranges of the sensor of each robot, one after another. The error is a robot whose sensor has not that
  // number of rays. Needs no lock of the interpreter.
  template <typename Number>
  void CopyRanges(const std::vector<std::size_t>& sensors, std::size_t rays, Number* out) const {
    CheckRobots(sensors.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      for (const double range : Ranges(RobotId(i), sensors[i], rays)) *out++ = static_cast<Number>(range);
    }
  }
  // Writes where the rays of the sensor of each robot have hit, x, y, z in R; not a number without a hit. As
  // CopyRanges.
  template <typename Number>
  void CopyPoints(const std::vector<std::size_t>& sensors, std::size_t rays, Number* out) const {
    CheckRobots(sensors.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      Ranges(RobotId(i), sensors[i], rays);
      ForEachHit(*simulation_.Read(RobotId(i), sensors[i]).ranger(), [&out](const std::array<double, 3>& point) {
        for (const double part : point) *out++ = static_cast<Number>(part);
      });
    }
  }
  // Height and width of the images of the first robot's camera. The error is a sensor that is no camera.
  std::pair<std::size_t, std::size_t> ImageShape(const std::vector<std::size_t>& sensors);
  // Writes the colours or depths of the camera of each robot, one after another. The error is a robot whose camera has
  // images of another shape. Needs no lock of the interpreter.
  template <auto part, typename Value>
  void CopyImages(const std::vector<std::size_t>& sensors, std::pair<std::size_t, std::size_t> shape,
                  Value* out) const {
    CheckRobots(sensors.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const auto& pixels = Image(RobotId(i), sensors[i], shape).*part;
      out = std::copy(pixels.begin(), pixels.end(), out);
    }
  }
  // The error is another number of robots, as after the restoration of a snapshot of another world.
  void CheckRobots(std::size_t count) const;
  // For all robots, by name, type or number.
  std::vector<std::size_t> FindSensors(py::handle sensor);

  Simulation& simulation() { return simulation_; }
  const Things& things();  // of its world; REQUIRES: as FindSensor
  SignalView view() { return {things(), simulation_.world(), simulation_.state()}; }
  bool calls_python() const { return calls_python_; }

 private:
  void Prepare();  // for another world
  // `before`: the number of events of the last tick before the edit.
  void FollowEdit(std::size_t before);
  const CameraReading& Image(RobotId robot, std::size_t sensor, std::pair<std::size_t, std::size_t> shape) const;
  const std::vector<double>& Ranges(RobotId robot, std::size_t sensor, std::size_t rays) const;
  static void ForEachHit(const RangerReading& reading, const std::function<void(const std::array<double, 3>&)>& visit);

  Simulation simulation_;
  std::atomic<bool> used_ = false;
  const WorldDescription* prepared_ = nullptr;
  std::optional<Things> things_;                                   // of prepared_, once they were needed
  std::vector<std::size_t> sensor_counts_;                         // by robot
  std::map<std::string, std::vector<std::size_t>> named_sensors_;  // of FindSensors, by name: it is slow
  bool calls_python_ = false;                                      // a robot's controller does
  std::optional<SimulationPage> page_;
  std::optional<SimulationRecorder> recorder_;
  Status recorded_;  // the first error of the recording, until it is raised
};

// A troupe.Simulation, which can be stepped.
class SteppedWorld final : public World {
 public:
  using World::World;
};

// The error names the tables.
const StateTable& FindTable(const std::string& name);

// DefineState first: the other classes are made of its.
void DefineState(py::module_& module);
void DefineSimulation(py::module_& module);
void DefineVectorSimulation(py::module_& module);
void DefineEpisodes(py::module_& module);  // after it
void DefineMonitors(py::module_& module);
void DefineRecording(py::module_& module);
void DefinePixels(py::module_& module);

}  // namespace troupe::python
