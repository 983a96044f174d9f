// The class troupe._troupe.Episodes: what troupe.rl does with all worlds at each step, in one pass. A thread drives a
// world, steps it, reads it into the rows of the arrays and evaluates the formulas of the task, while all of that is in
// the cache. Begins, autoreset and chance are Python's (troupe/rl/episodes.py).
//
// Its arrays are made once and written at each step: Python keeps them, and copies what it gives away.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/signals/state_tables.h"
#include "python/native/convert.h"
#include "python/native/cubes.h"
#include "python/native/formulas.h"
#include "python/native/worlds.h"

namespace troupe::python {
namespace {

using namespace py::literals;

// The numbers of a robot that formulas know, beside its signals: the first inputs of a program.
constexpr std::array kFormulaInputs = {"x",         "y",         "z",          "heading", "vx",        "vy",
                                       "wz",        "stalled",   "contact",    "held",    "opening",   "lift",
                                       "to_goal_x", "to_goal_y", "goal_level", "way",     "to_cube_x", "to_cube_y",
                                       "to_peer_x", "to_peer_y", "gripped",    "placed",  "idle"};
constexpr std::size_t kFirstOfGripper = 9;
constexpr std::size_t kFirstOfCubes = 12;
constexpr std::size_t kMotion = 3;         // numbers of an observation: vx, wz, contact
constexpr double kContactFades = 0.85;     // at each step
constexpr double kFingersMove = 0.3;       // of an action
constexpr std::size_t kMaxGrid = 1 << 20;  // cells

template <typename Value>
using Array = py::array_t<Value, py::array::c_style | py::array::forcecast>;

// A joint of each robot's gripper: 0 at its minimum, 1 at its maximum.
struct Travel {
  struct Joint {
    std::size_t joint = 0;
    double low = 0.0;
    double range = 1.0;
    double speed = 0.0;  // 1/s
  };
  std::vector<Joint> joints;  // by robot

  double At(const WorldState& state, std::size_t robot) const {
    const Joint& joint = joints[robot];
    return (state.joints[joint.joint].position - joint.low) / joint.range;
  }
};

Travel TravelOf(const std::vector<std::tuple<std::size_t, double, double, double>>& rows, std::size_t robots,
                std::size_t joints) {
  if (rows.size() != robots) throw py::value_error("found another number of grippers, expected one for each robot");
  Travel travel;
  for (const auto& [joint, low, range, speed] : rows) {
    if (joint >= joints) throw py::index_error("found a joint that does not exist");
    travel.joints.push_back({joint, low, range, speed});
  }
  return travel;
}

FormulaSection SectionOf(const py::handle& section) {
  FormulaSection made;
  const auto [rows, results] =
      section.cast<std::pair<std::vector<std::array<std::uint16_t, 5>>, std::vector<std::uint16_t>>>();
  for (const auto& [op, out, a, b, c] : rows) {
    if (op >= FormulaOps().size()) throw py::value_error(fmt::format("found operation {}", op));
    made.instructions.push_back({static_cast<FormulaOp>(op), out, a, b, c});
  }
  made.results = results;
  return made;
}

// What stays the same for all steps.
struct EpisodeTask {
  double speed = 1.0;      // m/s
  double turn_rate = 1.0;  // rad/s
  double reach = 1.0;      // m
  Tick ticks = 1;          // of a step
  double interval = 0.0;   // s, of a step
  std::vector<const Signal*> signals;
  FormulaProgram program;
  std::vector<CubePlace> places;
  std::optional<Travel> lift;
  std::optional<Travel> fingers;
};

class Episodes {
 public:
  Episodes(WorldsPointer worlds, const std::optional<std::string>& sensor, const py::dict& task)
      : worlds_(std::move(worlds)) {
    World& first = *worlds_->worlds()[0];
    const World::Use use(first);
    if (sensor) {
      sensors_ = first.FindSensors(py::str(*sensor));
      rays_ = first.CountRays(sensors_);
    }
    const WorldState& state = use->state();
    robots_ = worlds_->robots();
    objects_ = state.objects.size();
    stores_ = state.stores.size();
    joints_ = state.joints.size();
    grippers_ = state.grippers.size();
    Read(task);
    Allocate();
  }

  // New episodes have begun in these worlds: reads them, and forgets the last ones.
  void Look(const Array<bool>& which) {
    ForEach(which, [this](std::size_t i, Thread& thread) {
      std::fill_n(contacts_.mutable_data(i), robots_, 0.0);
      *steps_.mutable_data(i) = 0;
      std::fill(GridOf(i).begin(), GridOf(i).end(), std::uint8_t{0});
      if (!jobs_.empty()) jobs_[i].Begin();
      ReadWorld(i, thread);
    });
  }

  // Sets the memory of these worlds to its start, and observes them.
  void Start(const Array<bool>& which) {
    ForEach(which, [this](std::size_t i, Thread& thread) {
      FillRegisters(i, thread);
      thread.registers.Run(task_.program.start, GridOf(i));
      WriteMemory(i, thread, task_.program.start.results.data());
      Observe(i, thread);
    });
  }

  // actions: (worlds, robots, 2 or 4). frozen: (worlds, robots), robots that stand; idle: (worlds,), worlds that are
  // not stepped.
  void Step(const py::object& actions, const Array<bool>& frozen, const Array<bool>& idle) {
    const std::size_t columns = task_.lift ? 4 : 2;
    const auto rows = Array<double>::ensure(actions);
    if (!rows) PyErr_Clear();
    if (!rows || rows.ndim() != 3 || !Has(rows, {size(), robots_, columns})) {
      throw py::value_error(fmt::format("actions: expected an array ({}, {}, {})", size(), robots_, columns));
    }
    if (!Has(frozen, {size(), robots_})) throw py::value_error("frozen: expected a mask (worlds, robots)");
    Array<bool> runs(static_cast<py::ssize_t>(size()));
    if (!Has(idle, {size()})) throw py::value_error("idle: expected a mask (worlds,)");
    for (std::size_t i = 0; i < size(); ++i) runs.mutable_data()[i] = !idle.data()[i];
    ForEach(runs, [this, columns, action = rows.data(), stands = frozen.data()](std::size_t i, Thread& thread) {
      StepWorld(i, thread, action + i * robots_ * columns, stands + i * robots_);
    });
  }

  std::size_t size() const { return worlds_->size(); }

  py::dict Arrays() const {
    return py::dict("poses"_a = poses_, "twists"_a = twists_, "stalls"_a = stalls_, "contacts"_a = contacts_,
                    "ranges"_a = ranges_, "energy"_a = energy_, "objects"_a = object_poses_, "held"_a = held_,
                    "openings"_a = openings_, "lifts"_a = lifts_, "memory"_a = memory_, "steps"_a = steps_,
                    "observations"_a = observations_, "rewards"_a = rewards_, "ended"_a = ended_);
  }

 private:
  // What one thread needs for any world.
  struct Thread {
    explicit Thread(const FormulaProgram& program, std::size_t robots)
        : registers(program, robots), held(robots), actions(robots) {}

    FormulaRegisters registers;
    std::vector<std::optional<std::size_t>> held;  // by robot
    std::vector<std::array<double, 4>> actions;    // by robot, within [-1, 1]
  };

  template <typename Value>
  static bool Has(const Array<Value>& array, const std::vector<std::size_t>& shape) {
    return std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim(),
                      [](std::size_t a, py::ssize_t b) { return static_cast<py::ssize_t>(a) == b; });
  }

  void Read(const py::dict& task) {
    task_.speed = task["speed"].cast<double>();
    task_.turn_rate = task["turn_rate"].cast<double>();
    task_.reach = task["reach"].cast<double>();
    task_.ticks = task["ticks"].cast<Tick>();
    task_.interval = task["interval"].cast<double>();
    const StateTable& table = FindTable("robots");
    for (const auto& name : task["signals"].cast<std::vector<std::string>>()) {
      const Signal* const signal = table.Find(name);
      if (signal == nullptr) throw py::value_error(fmt::format("robots have no signal '{}'", name));
      task_.signals.push_back(signal);
    }
    for (const auto& [x, y, level] : task["places"].cast<std::vector<std::tuple<double, double, double>>>()) {
      task_.places.push_back({{x, y}, level});
    }
    using Rows = std::vector<std::tuple<std::size_t, double, double, double>>;
    if (!task["lift"].is_none()) {
      task_.lift = TravelOf(task["lift"].cast<Rows>(), robots_, joints_);
      task_.fingers = TravelOf(task["fingers"].cast<Rows>(), robots_, joints_);
      if (grippers_ != robots_) throw py::value_error("found another number of grippers, expected one for each robot");
    }
    FormulaProgram& program = task_.program;
    program.inputs = kFormulaInputs.size() + task_.signals.size();
    program.memory = task["memory"].cast<std::size_t>();
    program.pairs = task["pairs"].cast<std::vector<bool>>();
    program.constants = task["constants"].cast<std::vector<std::pair<std::uint16_t, double>>>();
    program.start = SectionOf(task["start"]);
    program.step = SectionOf(task["step"]);
    program.observe = SectionOf(task["observe"]);
    std::tie(program.width, program.height) = task["grid"].cast<std::pair<std::size_t, std::size_t>>();
    if (program.width > kMaxGrid || program.height > kMaxGrid || program.width * program.height > kMaxGrid) {
      throw py::value_error(
          fmt::format("grid: found {} x {} cells, expected at most {}", program.width, program.height, kMaxGrid));
    }
    if (!program.IsValid()) throw py::value_error("found formulas that were not compiled by troupe.rl");
  }

  void Allocate() {
    const auto count = static_cast<py::ssize_t>(size());
    const auto robots = static_cast<py::ssize_t>(robots_);
    const auto of = [](std::size_t number) { return static_cast<py::ssize_t>(number); };
    const auto zeros = []<typename Value>(std::vector<py::ssize_t> shape, Value value) {
      Array<Value> array(std::move(shape));
      std::fill_n(array.mutable_data(), array.size(), value);
      return array;
    };
    poses_ = zeros({count, robots, 4}, 0.0);
    twists_ = zeros({count, robots, 3}, 0.0);
    stalls_ = zeros({count, robots}, 0.0);
    contacts_ = zeros({count, robots}, 0.0);
    ranges_ = zeros({count, robots, of(rays_)}, 0.0);
    energy_ = zeros({count, of(stores_)}, 0.0);
    object_poses_ = zeros({count, of(objects_), 4}, 0.0);
    held_ = zeros({count, of(grippers_)}, -1.0);
    openings_ = zeros({count, of(grippers_)}, 0.0);
    lifts_ = zeros({count, of(grippers_)}, 0.0);
    memory_ = zeros({of(task_.program.memory), count, robots}, 0.0);
    steps_ = zeros({count}, std::int64_t{0});
    observations_ = zeros({count, robots, of(rays_ + kMotion + task_.program.observe.results.size())}, 0.0F);
    rewards_ = zeros({count, robots}, 0.0);
    ended_ = zeros({count, robots}, false);
    grid_.assign(size() * task_.program.width * task_.program.height, 0);
    if (!task_.places.empty()) jobs_.assign(size(), CubeJobs(robots_, objects_));
    for (std::size_t i = 0; i < worlds_->threads(); ++i) threads_.push_back(Thread(task_.program, robots_));
  }

  // Calls work(world, thread) for the worlds of the mask.
  template <typename Work>
  void ForEach(const Array<bool>& which, const Work& work) {
    if (!Has(which, {size()})) throw py::value_error("which: expected a mask (worlds,)");
    const Uses uses(worlds_->worlds());
    for (const std::shared_ptr<World>& world : worlds_->worlds()) CheckWorld(world->simulation().state());
    worlds_->ForEachWorldByThread([&, chosen = which.data()](std::size_t i, std::size_t thread, Interrupt&) {
      if (chosen[i]) work(i, threads_[thread]);
    });
    for (const std::shared_ptr<World>& world : worlds_->worlds()) world->RaiseIfNotRecorded();
  }

  // A snapshot of another world may have been restored into this one.
  void CheckWorld(const WorldState& state) const {
    if (state.robots.size() == robots_ && state.objects.size() == objects_ && state.stores.size() == stores_ &&
        state.joints.size() == joints_ && state.grippers.size() == grippers_) {
      return;
    }
    throw py::value_error("a world has other robots, joints, grippers, objects or stores than the task's");
  }

  std::span<std::uint8_t> GridOf(std::size_t world) {
    const std::size_t cells = task_.program.width * task_.program.height;
    return std::span(grid_).subspan(world * cells, cells);
  }

  void StepWorld(std::size_t i, Thread& thread, const double* action, const bool* stands) {
    World& world = *worlds_->worlds()[i];
    Simulation& simulation = world.simulation();
    world.ClearOutputs();
    const std::size_t columns = task_.lift ? 4 : 2;
    for (std::size_t robot = 0; robot < robots_; ++robot, action += columns) {
      std::array<double, 4>& own = thread.actions[robot];
      own = {};
      // A policy that diverges makes numbers that are none: a robot stands still then, instead of ending the training
      // with an error of the drive.
      for (std::size_t k = 0; k < columns && !stands[robot]; ++k) {
        own[k] = std::isnan(action[k]) ? 0.0 : std::clamp(action[k], -1.0, 1.0);
      }
      if (task_.lift) MoveGripper(simulation, robot, own);
      RaiseInThread(simulation.DriveBy(RobotId(robot), {own[0] * task_.speed, 0.0, own[1] * task_.turn_rate}));
    }
    for (Tick tick = 0; tick < task_.ticks; ++tick) world.StepOnce();
    ++*steps_.mutable_data(i);
    const std::vector<RobotState>& robots = simulation.state().robots;
    double* const contacts = contacts_.mutable_data(i);
    for (std::size_t robot = 0; robot < robots_; ++robot) {
      // A contact is remembered and fades: in a single step a policy could not learn to back off.
      const double met = thread.actions[robot][0] < 0.0 ? -1.0 : 1.0;
      contacts[robot] = robots[robot].stalled ? met : kContactFades * contacts[robot];
    }
    ReadWorld(i, thread);
    FillRegisters(i, thread);
    const FormulaSection& step = task_.program.step;
    thread.registers.Run(step, GridOf(i));
    const std::span<const double> rewards = thread.registers.of(step.results[0]);
    const std::span<const double> ended = thread.registers.of(step.results[1]);
    std::copy(rewards.begin(), rewards.end(), rewards_.mutable_data(i));
    std::transform(ended.begin(), ended.end(), ended_.mutable_data(i), [](double truth) { return truth != 0.0; });
    WriteMemory(i, thread, step.results.data() + 2);
    Observe(i, thread);
  }

  // An error in a thread, without the interpreter's lock.
  static void RaiseInThread(const Status& status) {
    if (!status.ok()) throw py::value_error(status.error().message);
  }

  // Fingers open or close, and the lift moves as far as it can in a step at that share of its speed.
  void MoveGripper(Simulation& simulation, std::size_t robot, const std::array<double, 4>& action) {
    GripperCommand command{.gripper = 0};
    if (std::abs(action[2]) > kFingersMove) command.opening = action[2] > 0.0 ? 100.0 : 0.0;
    if (action[3] != 0.0) {
      const double way = task_.interval * task_.lift->joints[robot].speed * action[3];
      command.lift = std::clamp(100.0 * (task_.lift->At(simulation.state(), robot) + way), 0.0, 100.0);
    }
    if (!command.opening && !command.lift) return;
    Command with_gripper;
    with_gripper.grippers.push_back(command);
    RaiseInThread(simulation.Drive(RobotId(robot), std::move(with_gripper)));
  }

  // Into the arrays.
  void ReadWorld(std::size_t i, Thread& thread) {
    World& world = *worlds_->worlds()[i];
    const WorldState& state = world.simulation().state();
    for (std::size_t robot = 0; robot < robots_; ++robot) {
      const RobotState& own = state.robots[robot];
      WritePose(own.X_WR, poses_.mutable_data(i, robot));
      double* const twist = twists_.mutable_data(i, robot);
      twist[0] = own.twist.vx;
      twist[1] = own.twist.vy;
      twist[2] = own.twist.wz;
      *stalls_.mutable_data(i, robot) = own.stalled ? 1.0 : 0.0;
    }
    for (std::size_t k = 0; k < stores_; ++k) *energy_.mutable_data(i, k) = state.stores[k].joules;
    for (std::size_t k = 0; k < objects_; ++k) WritePose(state.objects[k].X_WO, object_poses_.mutable_data(i, k));
    for (std::size_t k = 0; k < grippers_; ++k) {
      const std::optional<ObjectId> object = state.grippers[k].clamped;
      const bool holds = object && state.objects[object->index()].holder == GripperId(k);
      *held_.mutable_data(i, k) = holds ? static_cast<double>(object->index()) : -1.0;
      if (!task_.lift) continue;
      thread.held[k] = holds ? std::optional(object->index()) : std::nullopt;
      *lifts_.mutable_data(i, k) = task_.lift->At(state, k);
      *openings_.mutable_data(i, k) = 1.0 - task_.fingers->At(state, k);
    }
    if (rays_ > 0) world.CopyRanges(sensors_, rays_, ranges_.mutable_data(i));
  }

  static void WritePose(const Pose& pose, double* out) {
    out[0] = pose.x;
    out[1] = pose.y;
    out[2] = pose.z;
    out[3] = pose.heading;
  }

  // From the arrays, of the world that the thread has read last.
  void FillRegisters(std::size_t i, Thread& thread) {
    for (std::size_t robot = 0; robot < robots_; ++robot) {
      const double* const pose = poses_.data(i, robot);
      const double* const twist = twists_.data(i, robot);
      const std::array numbers{pose[0],
                               pose[1],
                               pose[2],
                               pose[3],
                               twist[0],
                               twist[1],
                               twist[2],
                               *stalls_.data(i, robot),
                               *contacts_.data(i, robot)};
      static_assert(numbers.size() == kFirstOfGripper);
      for (std::size_t k = 0; k < numbers.size(); ++k) thread.registers.of(k)[robot] = numbers[k];
    }
    if (task_.lift) {
      for (std::size_t robot = 0; robot < robots_; ++robot) {
        const std::array numbers{*held_.data(i, robot), *openings_.data(i, robot), *lifts_.data(i, robot)};
        static_assert(kFirstOfGripper + numbers.size() == kFirstOfCubes);
        for (std::size_t k = 0; k < numbers.size(); ++k) thread.registers.of(kFirstOfGripper + k)[robot] = numbers[k];
      }
    }
    World& world = *worlds_->worlds()[i];
    if (!jobs_.empty()) FillJobs(i, thread, world.simulation().state());
    if (!task_.signals.empty()) {
      const SignalView view = world.view();
      for (std::size_t k = 0; k < task_.signals.size(); ++k) {
        const std::span<double> numbers = thread.registers.of(kFormulaInputs.size() + k);
        for (std::size_t robot = 0; robot < robots_; ++robot) numbers[robot] = task_.signals[k]->number(view, robot);
      }
    }
    for (std::size_t k = 0; k < task_.program.memory; ++k) {
      std::copy_n(memory_.data(k, i), robots_, thread.registers.of(task_.program.inputs + k).begin());
    }
  }

  void FillJobs(std::size_t i, Thread& thread, const WorldState& state) {
    const std::vector<CubeJob>& jobs = jobs_[i].Update(state, thread.held, task_.places);
    for (std::size_t robot = 0; robot < robots_; ++robot) {
      const CubeJob& job = jobs[robot];
      const std::array numbers{job.goal.x(),
                               job.goal.y(),
                               job.goal_level,
                               job.way,
                               job.cube.x(),
                               job.cube.y(),
                               job.peer.x(),
                               job.peer.y(),
                               job.gripped ? 1.0 : 0.0,
                               job.placed ? 1.0 : 0.0,
                               job.idle ? 1.0 : 0.0};
      static_assert(kFirstOfCubes + numbers.size() == kFormulaInputs.size());
      for (std::size_t k = 0; k < numbers.size(); ++k) thread.registers.of(kFirstOfCubes + k)[robot] = numbers[k];
    }
  }

  void WriteMemory(std::size_t i, Thread& thread, const std::uint16_t* results) {
    // All of it before any is written to the registers: each may depend on the others.
    for (std::size_t k = 0; k < task_.program.memory; ++k) {
      std::copy_n(thread.registers.of(results[k]).begin(), robots_, memory_.mutable_data(k, i));
    }
    for (std::size_t k = 0; k < task_.program.memory; ++k) {
      std::copy_n(memory_.data(k, i), robots_, thread.registers.of(task_.program.inputs + k).begin());
    }
  }

  void Observe(std::size_t i, Thread& thread) {
    const FormulaSection& observe = task_.program.observe;
    thread.registers.Run(observe, GridOf(i));
    for (std::size_t robot = 0; robot < robots_; ++robot) {
      float* next = observations_.mutable_data(i, robot);
      const double* const ranges = rays_ > 0 ? ranges_.data(i, robot) : nullptr;
      for (std::size_t k = 0; k < rays_; ++k) *next++ = static_cast<float>(std::min(ranges[k] / task_.reach, 1.0));
      const double* const twist = twists_.data(i, robot);
      *next++ = static_cast<float>(twist[0] / task_.speed);
      *next++ = static_cast<float>(twist[2] / task_.turn_rate);
      *next++ = static_cast<float>(*contacts_.data(i, robot));
      for (const std::uint16_t result : observe.results) {
        *next++ = static_cast<float>(thread.registers.of(result)[robot]);
      }
    }
  }

  const WorldsPointer worlds_;
  std::vector<std::size_t> sensors_;  // by robot; none without rays
  std::size_t rays_ = 0;
  std::size_t robots_ = 0;
  std::size_t objects_ = 0;
  std::size_t stores_ = 0;
  std::size_t joints_ = 0;
  std::size_t grippers_ = 0;
  EpisodeTask task_;
  Array<double> poses_, twists_, stalls_, contacts_, ranges_, energy_, object_poses_, held_, openings_, lifts_;
  Array<double> memory_;  // (numbers, worlds, robots)
  Array<std::int64_t> steps_;
  Array<float> observations_;
  Array<double> rewards_;
  Array<bool> ended_;
  std::vector<std::uint8_t> grid_;  // by world
  std::vector<CubeJobs> jobs_;      // by world; none without places
  std::vector<Thread> threads_;
};

py::tuple TextsOf(std::span<const char* const> texts) {
  py::tuple made(texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) made[i] = py::str(texts[i]);
  return made;
}

}  // namespace

void DefineEpisodes(py::module_& module) {
  module.attr("FORMULA_OPS") = TextsOf(FormulaOps());
  module.attr("FORMULA_INPUTS") = TextsOf(kFormulaInputs);
  py::class_<Episodes>(module, "Episodes", "The native part of troupe.rl.envs.Episodes.")
      .def(py::init([](const WorldsPointer& worlds, const std::optional<std::string>& sensor, const py::dict& task) {
             return std::make_unique<Episodes>(worlds, sensor, task);
           }),
           py::arg("worlds").none(false), "sensor"_a.none(true), "task"_a)
      .def("look", &Episodes::Look, "which"_a, "Episodes have begun in the worlds of a mask: reads them.")
      .def("start", &Episodes::Start, "which"_a, "Then sets their memory to its start, and observes.")
      .def("step", &Episodes::Step, "actions"_a, "frozen"_a, "idle"_a,
           "Drives, steps, reads, rewards and observes all worlds but the idle ones.")
      .def_property_readonly("arrays", &Episodes::Arrays, "By name; written at each step.");
}

}  // namespace troupe::python
