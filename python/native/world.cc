#include "python/native/world.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <exception>
#include <future>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "python/native/convert.h"
#include "troupe/deterministic_math.h"

namespace troupe::python {
namespace {

std::string NamesOf(const WorldDescription& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    if (names.size() == 8) {
      names.emplace_back("...");
      break;
    }
    names.push_back(world.robots[i].name);
  }
  return names.empty() ? "a world with robots" : fmt::format("one of: {}", fmt::join(names, ", "));
}

// Of a controller, after Ctrl-C: of the process's time, because a controller that does return may have to wait for a
// processor; and of wall time, for one that waits.
constexpr double kMaxReturnWork = 1.0;  // s
constexpr auto kMaxReturn = std::chrono::seconds(10);
constexpr auto kMaxEnd = std::chrono::seconds(10);

std::atomic<int> calls = 0;  // of RunInterruptibly and of World::Load
std::atomic<bool> is_ending = false;

// One of them. REQUIRES: the interpreter's lock, at the begin and at the end.
struct Running {
  Running() { ++calls; }
  ~Running() { --calls; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
};

}  // namespace

void Raise(const Error& error) {
  const bool bad_input = error.code == ErrorCode::kBadInput || error.code == ErrorCode::kMalformed;
  const py::object type = py::module_::import("troupe.errors").attr(bad_input ? "InputError" : "RunError");
  const auto known = [](int number) { return number > 0 ? py::object(py::int_(number)) : py::none(); };
  const py::object file = error.where.file.empty() ? py::none() : py::object(py::str(error.where.file));
  const py::object exception =
      type(error.message, file, known(error.where.line), known(error.where.column), error.ToString());
  PyErr_SetObject(type.ptr(), exception.ptr());
  throw py::error_already_set();
}

void RaiseIfBad(const Status& status) {
  if (!status.ok()) Raise(status.error());
}

bool Interrupt::HasSignal() {
  if (is_due_ || PyErr_CheckSignals() == 0) return false;
  signal_ = std::make_exception_ptr(py::error_already_set());
  is_due_ = true;
  return true;
}

bool Interrupt::IsDue() {
  if (is_due_ || is_ending) return true;
  if (!looks_for_signals_ || std::this_thread::get_id() != caller_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kSignalPeriod) return false;
  last_ = now;
  const py::gil_scoped_acquire acquire;
  return HasSignal();
}

void Interrupt::RethrowSignal() const {
  if (signal_) std::rethrow_exception(signal_);
}

void RunInterruptibly(bool calls_python, const std::function<void(Interrupt& interrupt)>& work) {
  Interrupt interrupt(!calls_python);
  const Running running;
  if (!calls_python) {
    const py::gil_scoped_release release;
    work(interrupt);
  } else {
    const py::gil_scoped_release release;
    std::atomic<unsigned long> worker = 0;
    std::future<void> done = std::async(std::launch::async, [&] {
      worker = PyThread_get_thread_ident();
      work(interrupt);
    });
    // Since Ctrl-C, or since a controller that does not return was interrupted.
    struct Since {
      std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
      std::clock_t processor = std::clock();
    };
    std::optional<Since> since;
    while (done.wait_for(kSignalPeriod) != std::future_status::ready) {
      const py::gil_scoped_acquire acquire;
      const Since now;
      if (interrupt.HasSignal()) since = now;
      if (!since) continue;
      const double used = static_cast<double>(now.processor - since->processor) / CLOCKS_PER_SEC;
      if (used < kMaxReturnWork && now.wall - since->wall < kMaxReturn) continue;
      PyThreadState_SetAsyncExc(worker, PyExc_KeyboardInterrupt);
      since = now;
    }
    done.get();
  }
  interrupt.RethrowSignal();
  // Ends a thread without a message.
  if (is_ending) {
    PyErr_SetNone(PyExc_SystemExit);
    throw py::error_already_set();
  }
}

void AwaitCalls() {
  is_ending = true;
  const py::gil_scoped_release release;
  const auto end = std::chrono::steady_clock::now() + kMaxEnd;
  while (calls > 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

WorldInput::WorldInput(const py::object& world, std::optional<std::uint64_t> seed) {
  const py::module_ os = py::module_::import("os");
  if (py::isinstance<py::str>(world) || py::isinstance<py::bytes>(world) ||
      py::isinstance(world, os.attr("PathLike"))) {
    path_ = os.attr("fsdecode")(world).cast<std::string>();
    return;
  }
  files_ = py::module_::import("troupe.world").attr("WorldText")(world, seed);
  path_ = files_.attr("path").cast<std::string>();
  scenario_ = files_.attr("scenario").cast<std::string>();
}

Result<Simulation> WorldInput::Load(const SimulationOptions& options) const {
  return scenario_ ? Simulation::LoadScenario(*scenario_, path_, options) : Simulation::Load(path_, options);
}

std::optional<std::string> ControllerName(const py::object& controller) {
  if (controller.is_none()) return std::nullopt;
  if (py::isinstance<py::str>(controller)) return controller.cast<std::string>();
  return py::module_::import("troupe._cell").attr("name_of")(controller).cast<std::string>();
}

std::shared_ptr<SteppedWorld> World::Load(const WorldInput& input, const SimulationOptions& options) {
  std::optional<Result<Simulation>> loaded;
  {
    const Running running;
    const py::gil_scoped_release release;
    loaded.emplace(input.Load(options));
  }
  return std::make_shared<SteppedWorld>(ValueOf(*std::move(loaded)));
}

World::World(Simulation simulation) : simulation_(std::move(simulation)) {
  Prepare();
}

World::~World() {
  // The destructor may run without the interpreter's lock, or after the interpreter: then nothing of it may be called.
  if (!page_ || PyGILState_Check() == 0) return;
  PyThreadState* const thread = PyEval_SaveThread();  // browsers are shown the end; gil_scoped_release might throw
  page_.reset();
  PyEval_RestoreThread(thread);
}

void World::Prepare() {
  if (prepared_ == &simulation_.world()) return;
  // By the address of the world: a restored snapshot of another world has another.
  prepared_ = &simulation_.world();
  things_.reset();
  sensor_counts_.clear();
  named_sensors_.clear();
  calls_python_ = false;
  for (std::size_t i = 0; i < prepared_->robots.size(); ++i) {
    sensor_counts_.push_back(simulation_.Info(RobotId(i)).sensors.size());
    // A controller is FILE.py:CLASS.
    calls_python_ |= prepared_->robots[i].controller.name.find(".py:") != std::string::npos;
  }
}

const Things& World::things() {
  if (!things_) things_.emplace(simulation_.world());
  return *things_;
}

World::Use::Use(World& world) : world_(world) {
  if (world_.used_.exchange(true, std::memory_order_acquire)) {
    throw std::runtime_error("the simulation is in use: another thread, or one of its own controllers, calls it");
  }
}

RobotId World::FindRobot(py::handle robot) {
  const WorldDescription& world = simulation_.world();
  if (py::isinstance<py::str>(robot)) {
    const auto name = robot.cast<std::string>();
    if (const std::optional<RobotId> id = simulation_.FindRobot(name)) return *id;
    throw py::value_error(fmt::format("found robot '{}', expected {}", name, NamesOf(world)));
  }
  const std::size_t index = ToIndex(robot, "robot");
  if (index >= world.robots.size()) {
    throw py::index_error(fmt::format("found robot {}, expected one of {}", index, world.robots.size()));
  }
  return RobotId(index);
}

std::size_t World::FindSensor(RobotId robot, py::handle sensor) {
  if (!py::isinstance<py::str>(sensor)) {
    const std::size_t index = ToIndex(sensor, "sensor");
    if (index < sensor_count(robot)) return index;
    throw py::index_error(fmt::format("found sensor {} of robot {}, expected one of {}", index,
                                      simulation_.world().robot(robot).name, sensor_count(robot)));
  }
  const auto name = sensor.cast<std::string>();
  const RobotInfo info = simulation_.Info(robot);
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (info.sensors[i].description->name == name) return i;
  }
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (TypeOf(info.sensors[i].description->parameters) == name) return i;
  }
  std::vector<std::string> names;
  for (const SensorInfo& each : info.sensors) names.push_back(each.description->name);
  throw py::value_error(fmt::format("found sensor '{}' of robot {}, expected one of: {}", name, info.robot->name,
                                    fmt::join(names, ", ")));
}

std::vector<std::size_t> World::FindSensors(py::handle sensor) {
  const std::string name = py::isinstance<py::str>(sensor) ? sensor.cast<std::string>() : std::string();
  if (const auto found = named_sensors_.find(name); found != named_sensors_.end()) return found->second;
  std::vector<std::size_t> sensors;
  for (std::size_t i = 0; i < simulation_.world().robots.size(); ++i) {
    sensors.push_back(FindSensor(RobotId(i), sensor));
  }
  if (!name.empty()) named_sensors_[name] = sensors;
  return sensors;
}

std::size_t World::CountRays(const std::vector<std::size_t>& sensors) {
  if (sensors.empty()) return 0;
  const RangerReading* const ranger = simulation_.Read(RobotId(0), sensors[0]).ranger();
  if (ranger == nullptr) throw py::value_error(fmt::format("sensor {} of the first robot is no ranger", sensors[0]));
  return ranger->ranges.size();
}

const std::vector<double>& World::Ranges(RobotId robot, std::size_t sensor, std::size_t rays) const {
  const std::string& name = simulation_.world().robot(robot).name;
  const RangerReading* const ranger = sensor < sensor_count(robot) ? simulation_.Read(robot, sensor).ranger() : nullptr;
  if (ranger == nullptr) throw py::value_error(fmt::format("sensor {} of robot {} is no ranger", sensor, name));
  if (const std::size_t found = ranger->ranges.size(); found != rays) {
    throw py::value_error(
        fmt::format("the ranger of robot {} has {} rays, expected {} as the first robot's", name, found, rays));
  }
  return ranger->ranges;
}

std::pair<std::size_t, std::size_t> World::ImageShape(const std::vector<std::size_t>& sensors) {
  if (sensors.empty()) return {0, 0};
  const auto* const camera = simulation_.Read(RobotId(0), sensors[0]).As<CameraReading>();
  if (camera == nullptr) throw py::value_error(fmt::format("sensor {} of the first robot is no camera", sensors[0]));
  return {camera->height, camera->width};
}

const CameraReading& World::Image(RobotId robot, std::size_t sensor, std::pair<std::size_t, std::size_t> shape) const {
  const std::string& name = simulation_.world().robot(robot).name;
  const auto* const camera =
      sensor < sensor_count(robot) ? simulation_.Read(robot, sensor).As<CameraReading>() : nullptr;
  if (camera == nullptr) throw py::value_error(fmt::format("sensor {} of robot {} is no camera", sensor, name));
  if (camera->height != shape.first || camera->width != shape.second) {
    throw py::value_error(
        fmt::format("the images of robot {} have {} x {} pixels, expected {} x {} as the first robot's", name,
                    camera->width, camera->height, shape.second, shape.first));
  }
  return *camera;
}

void World::CheckRobots(std::size_t count) const {
  if (const std::size_t found = simulation_.world().robots.size(); found != count) {
    throw py::value_error(fmt::format("a world has {} robots, expected {}", found, count));
  }
}

void World::StepOnce() {
  const bool records = recorder_ && recorded_.ok();
  if (records) recorded_ = recorder_->BeforeStep(simulation_);
  simulation_.Step();
  if (records && recorded_.ok()) recorded_ = recorder_->AfterStep(simulation_);
  events.insert(events.end(), simulation_.events().begin(), simulation_.events().end());
  reports.insert(reports.end(), simulation_.reports().begin(), simulation_.reports().end());
  const std::vector<Simulation::FleetOutput>& sent = simulation_.fleet_outputs();
  fleet.insert(fleet.end(), sent.begin(), sent.end());
  if (page_) page_->Show(simulation_);
}

void World::Step(Tick ticks, const std::function<bool(const Simulation&)>& goes_on) {
  const Use use(*this);
  ClearOutputs();
  RunInterruptibly(calls_python_, [&](Interrupt& interrupt) {
    for (Tick i = 0; i < ticks && !interrupt.IsDue(); ++i) {
      StepOnce();
      if (goes_on && !goes_on(simulation_)) break;
    }
  });
  RaiseIfNotRecorded();
}

void World::StartRecording(const std::string& file, Tick keyframe_interval) {
  const Use use(*this);
  if (recorder_) throw std::runtime_error("the simulation is recorded already: stop_recording ends that");
  std::optional<Result<SimulationRecorder>> made;
  {
    const py::gil_scoped_release release;
    made.emplace(SimulationRecorder::Create(file, simulation_, {keyframe_interval}));
  }
  recorder_.emplace(ValueOf(*std::move(made)));
  recorded_ = {};
}

void World::StopRecording() {
  const Use use(*this);
  if (!recorder_) return;
  const Status closed = recorder_->Close();
  recorder_.reset();
  RaiseIfNotRecorded();
  RaiseIfBad(closed);
}

void World::RaiseIfNotRecorded() {
  if (recorded_.ok()) return;
  recorder_.reset();
  const Status failure = std::exchange(recorded_, Status());
  RaiseIfBad(failure);
}

void World::ForEachHit(const RangerReading& reading, const std::function<void(const std::array<double, 3>&)>& visit) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double* range = reading.ranges.data();
  for (const ScanGeometry& scan : *reading.geometry) {
    for (std::size_t plane = 0; plane < scan.planes(); ++plane) {
      const SinCosResult up = SinCos(scan.elevation(plane));
      for (std::size_t ray = 0; ray < scan.fan.count; ++ray, ++range) {
        const SinCosResult turn = SinCos(scan.fan.Bearing(ray) + scan.X_RS.heading);
        const double flat = *range * up.cos;
        if (*range < scan.limits.max) {
          visit({scan.X_RS.x + flat * turn.cos, scan.X_RS.y + flat * turn.sin, scan.X_RS.z + *range * up.sin});
        } else {
          visit({kNone, kNone, kNone});
        }
      }
    }
  }
}

void World::Restore(const Snapshot& snapshot) {
  const Use use(*this);
  RaiseIfBad(simulation_.Restore(snapshot));
  ClearOutputs();
  events = simulation_.events();
  Prepare();
  if (page_) page_->Show(simulation_);
}

void World::FollowEdit(std::size_t before) {
  const std::vector<Event>& now = simulation_.events();
  events.insert(events.end(), now.begin() + static_cast<std::ptrdiff_t>(before), now.end());
  Prepare();
  if (page_) page_->Show(simulation_);
}

std::string World::OpenPage(const SimulationPageOptions& options) {
  const Use use(*this);
  if (page_ && page_->is_open()) return page_->address();
  std::optional<Result<SimulationPage>> page;
  {
    const py::gil_scoped_release release;
    page_.reset();
    page.emplace(SimulationPage::Open(simulation_, options));
  }
  page_.emplace(ValueOf(*std::move(page)));
  return page_->address();
}

void World::ClosePage() {
  const Use use(*this);
  const py::gil_scoped_release release;
  page_.reset();
}

}  // namespace troupe::python
