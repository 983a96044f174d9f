#include "viewer/editor/edit_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "common/base/identity.h"
#include "common/model/states.h"
#include "robot-agent/drive/drive.h"
#include "viewer/editor/editable_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::size_t kMaxRectangles = 64;       // of a model that is shown as an object
constexpr double kProbeSpeed = 0.4;              // m/s
constexpr std::uint64_t kMaxStepsAtOnce = 1000;  // of a request

// With the static models as objects; without models of maps, which the scene draws in another way.
// Only the world in view: the file, and a test, keep them as static models.
WorldDescription WithAllAsObjects(WorldDescription world) {
  std::vector<bool> is_robot(world.models.size(), false);
  for (const RobotDescription& robot : world.robots) is_robot[robot.root.index()] = true;
  std::vector<std::size_t> roots(world.models.size());
  std::vector<bool> can_be(world.models.size(), true);
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    roots[i] = model.parent ? roots[model.parent->index()] : i;
    const Shape& shape = world.shape(model.shape);
    if (shape.area || shape.rectangles.size() > kMaxRectangles || model.removed) can_be[roots[i]] = false;
  }
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const bool is_object = std::find(world.objects.begin(), world.objects.end(), ModelId(i)) != world.objects.end();
    if (roots[i] != i || is_robot[i] || is_object || !can_be[i]) continue;
    world.models[i].gripper_return = true;
    world.objects.emplace_back(i);
  }
  const std::vector<ModelId> before = world.objects;
  std::sort(world.objects.begin(), world.objects.end());
  const auto follow = [&](ObjectId& object) {
    const auto place = std::lower_bound(world.objects.begin(), world.objects.end(), before[object.index()]);
    object = ObjectId(static_cast<std::size_t>(place - world.objects.begin()));
  };
  for (DoorDescription& door : world.doors) {
    for (DoorLeaf& leaf : door.leaves) follow(leaf.object);
  }
  for (LiftDescription& lift : world.lifts) follow(lift.cabin);
  return world;
}

}  // namespace

class EditLink::Observation final : public RunObservation {
 public:
  Observation(EditLink& link, ObserverHandler& handler) : link_(link), handler_(handler) {}
  ~Observation() override { link_.Forget(handler_); }
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

 private:
  EditLink& link_;
  ObserverHandler& handler_;
};

// The thread starts last: it uses all other members.
EditLink::EditLink(std::unique_ptr<Editor> editor) : run_(MakeRandomId()), editor_(std::move(editor)) {
  session_.run = frame_.run = run_;
  session_.begun = true;
  session_.host = HostName();
  const std::lock_guard lock(mutex_);
  ShowEdited();
  thread_ = std::thread([this] { Run(); });
}

EditLink::~EditLink() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool EditLink::has_unsaved_edits() const {
  const std::lock_guard lock(mutex_);
  return editor_->has_unsaved_edits();
}

Result<std::unique_ptr<RunObservation>> EditLink::Observe(ObserverHandler& handler) {
  const std::lock_guard lock(mutex_);
  handler_ = &handler;
  PostAll();
  return std::unique_ptr<RunObservation>(std::make_unique<Observation>(*this, handler));
}

void EditLink::Forget(ObserverHandler& handler) {
  const std::lock_guard lock(mutex_);
  if (handler_ == &handler) handler_ = nullptr;
}

void EditLink::PostAll() {
  if (handler_ == nullptr) return;
  handler_->OnSession(session_);
  handler_->OnFrame(std::make_shared<const FrameMessage>(frame_));
}

void EditLink::PostWorld(const WorldDescription& world, const WorldState& state) {
  session_.world = world;
  session_.world_edition = frame_.world_edition = frame_.edition = ++edition_;
  frame_.state = state;
  frame_.state_hash = StateHash(state);
  frame_.paused = !playing_;
  frame_.events.clear();
  PostAll();
}

void EditLink::PostState(const WorldState& state, const std::vector<Event>& events) {
  frame_.state = state;
  frame_.state_hash = StateHash(state);
  frame_.paused = !playing_;
  frame_.events = events;
  if (handler_ != nullptr) handler_->OnFrame(std::make_shared<const FrameMessage>(frame_));
}

void EditLink::ShowEdited() {
  shown_version_ = editor_->version();
  WorldDescription world;
  if (editor_->world() != nullptr) world = WithAllAsObjects(editor_->world()->loaded.world);
  if (world.name.empty()) world.name = std::filesystem::path(editor_->path()).filename().string();
  const Scene scene(world);
  PostWorld(world, InitialState(scene));
}

void EditLink::ShowTest() {
  PostWorld(test_->world(), test_->state());
}

// The page may have written another controller into the text: libraries run only if the user's own file named them.
Status EditLink::StartTest(const std::string& model, double probe_height) {
  if (editor_->world() == nullptr) return Failure("no world is loaded");
  WorldDescription world = editor_->world()->loaded.world;
  if (!model.empty()) {
    Result<LoadedWorld> made = MakeTestWorld(editor_->world()->tree, model, probe_height, editor_->files());
    if (!made.ok()) return made.error();
    world = std::move(made.value().world);
    world.name = "test of " + model;
  }
  for (const RobotDescription& robot : world.robots) {
    if (!NamesLibrary(robot.controller.name) || editor_->MayRun(robot.controller.name)) continue;
    return Failure("controller '" + robot.controller.name + "' of " + robot.name +
                   " is a library that the file did not name when it was opened: save, and open it again to test it");
  }
  tested_ = model;
  test_world_ = std::move(world);
  return Restart();
}

// The probe drives towards the model from the start, as it has no controller.
Status EditLink::Restart() {
  Result<Simulation> simulation = Simulation::Create(*test_world_);
  if (!simulation.ok()) return simulation.error();
  test_.emplace(std::move(simulation).value());
  driven_.clear();
  playing_ = false;
  if (const auto probe = test_->FindRobot(kProbe); probe && !tested_.empty()) {
    const DriveDescription& drive = test_->world().robot(*probe).drive;
    if (Status failure = test_->Drive(*probe, CommandFromTwist({kProbeSpeed, 0.0, 0.0}, drive)); !failure.ok()) {
      return failure;
    }
  }
  ShowTest();
  return {};
}

void EditLink::EndTest() {
  if (!test_) return;
  test_.reset();
  test_world_.reset();
  playing_ = false;
  ShowEdited();
}

// A command of the page counts down in ticks, as in a run.
void EditLink::StepTest() {
  test_->Step();
  for (auto it = driven_.begin(); it != driven_.end();) {
    if (--it->second.ticks_left > 0) {
      ++it;
      continue;
    }
    test_->Release(it->first);
    it = driven_.erase(it);
  }
  PostState(test_->state(), test_->events());
}

// The next time follows from the one before and not from now, so that the mean rate is exact; after a delay no ticks
// are made up for.
void EditLink::Run() {
  std::unique_lock lock(mutex_);
  Clock::time_point next = Clock::now();
  while (!ending_) {
    if (!playing_ || !test_) {
      changed_.wait(lock, [this] { return ending_ || (playing_ && test_); });
      next = Clock::now();
      continue;
    }
    const auto interval = std::chrono::duration<double>(speed_ ? test_->world().interval_seconds() / *speed_ : 1e-4);
    next = std::max(next + std::chrono::duration_cast<Clock::duration>(interval), Clock::now());
    changed_.wait_until(lock, next, [this] { return ending_ || !playing_ || !test_; });
    if (ending_ || !playing_ || !test_ || Clock::now() < next) continue;
    try {
      StepTest();
    } catch (const std::exception&) {  // as without memory: the test pauses
      playing_ = false;
    }
  }
}

// The same checks as in a run.
Status EditLink::Drive(const control::CommandRobot& request) {
  if (!test_) return Failure("a robot is driven in a test: start one");
  const std::optional<RobotId> robot = test_->FindRobot(request.name);
  if (!robot) return Error{{}, "found no robot '" + request.name + "'"};
  const RobotCommand order{*robot, request.twist, request.grippers, request.goal};
  if (Status wrong = CheckRobotCommand(test_->world(), order); !wrong.ok()) return wrong;
  if (order.goal) return Failure("goals are for runs");
  Command command;
  if (order.twist) command = CommandFromTwist(*order.twist, test_->world().robot(*robot).drive);
  for (const GripperOrder& gripper : order.grippers) {
    command.grippers.push_back({.gripper = gripper.gripper, .lift = gripper.lift, .opening = gripper.opening});
  }
  driven_[*robot].ticks_left = request.ticks;
  return test_->Drive(*robot, std::move(command));
}

// One call operator for each request; the template refuses all others. REQUIRES: the mutex of the link is locked.
struct EditLink::RequestOfPage {
  EditLink& link;
  ControlReply& reply;

  Status Begin() const { return link.test_ ? Status() : link.StartTest("", 0.0); }
  void Report(const std::string& name, const std::string& type) const {
    reply.entities.push_back({.name = name, .type = type});
  }
  // Of the file, which no test uses.
  template <typename Edit>
  Status Change(const Edit& edit) const {
    return link.test_ ? Status(Failure("the world is in a test: end the test to edit it")) : edit();
  }

  template <typename Request>
  Status operator()(const Request&) const {
    return Change([] { return Status(Failure("a file in editing has no such command")); });
  }
  Status operator()(const control::GetStatus&) const { return {}; }
  Status operator()(const control::Pause&) const {
    link.playing_ = false;
    if (link.test_) link.PostState(link.test_->state(), {});
    return {};
  }
  Status operator()(const control::Play&) const {
    if (Status failure = Begin(); !failure.ok()) return failure;
    link.playing_ = true;
    link.PostState(link.test_->state(), {});
    link.changed_.notify_all();
    return {};
  }
  Status operator()(const control::Step& step) const {
    if (step.ticks > kMaxStepsAtOnce) {
      return Error{{}, fmt::format("found {} steps, expected at most {} at once", step.ticks, kMaxStepsAtOnce)};
    }
    if (Status failure = Begin(); !failure.ok()) return failure;
    link.playing_ = false;
    for (std::uint64_t i = 0; i < step.ticks; ++i) link.StepTest();
    return {};
  }
  Status operator()(const control::Reset&) const { return link.test_ ? link.Restart() : Status(); }
  Status operator()(const control::Speed& speed) const {
    link.speed_ = speed.speed;
    link.changed_.notify_all();
    return {};
  }
  Status operator()(const control::CommandRobot& command) const { return link.Drive(command); }
  Status operator()(const control::Spawnables&) const {
    if (link.editor_->world() == nullptr) return {};
    for (const PaletteModel& model : PaletteOf(link.editor_->world()->tree)) Report(model.name, model.type);
    return {};
  }
  Status operator()(const control::Spawn& spawn) const {
    return Change([&]() -> Status {
      const Result<std::string> name = link.editor_->Add(spawn.source, spawn.pose);
      if (!name.ok()) return name.error();
      Report(name.value(), spawn.source);
      return {};
    });
  }
  Status operator()(const control::Delete& removal) const {
    return Change([&] { return link.editor_->Remove(removal.name); });
  }
  Status operator()(const control::SetPose& move) const {
    return Change([&] { return link.editor_->SetPose(move.name, move.pose); });
  }
};

Status EditLink::Apply(const control::Request& request, ControlReply& reply) {
  return std::visit(RequestOfPage{*this, reply}, request);
}

// A refused request is a reply, too: the error is for the page. Messages about the edited file need no name of it.
Result<ControlReply> EditLink::Ask(const control::Request& request) {
  const std::lock_guard lock(mutex_);
  ControlReply reply;
  const Status status = Apply(request, reply);
  if (!test_ && editor_->version() != shown_version_) ShowEdited();
  reply.done = status.ok();
  if (!status.ok())
    reply.problem = status.error().where.file.empty() ? status.error().message : status.error().ToString();
  reply.state = playing_ ? RunState::kPlaying : RunState::kPaused;
  reply.tick = frame_.state.tick;
  return reply;
}

Result<Json> EditLink::Execute(const edit::Test& operation) {
  const Status started = StartTest(operation.model, operation.probe_height);
  if (started.ok()) return Json::object();
  if (!test_) test_world_.reset();
  return started.error();
}

Result<Json> EditLink::Execute(const edit::EndTest&) {
  EndTest();
  return Json::object();
}

// An edit ends the test.
template <typename Operation>
Result<Json> EditLink::Execute(const Operation& operation) {
  constexpr bool kChangesNothing =
      std::is_base_of_v<edit::Question, Operation> || std::is_same_v<edit::Save, Operation>;
  if (!kChangesNothing) EndTest();
  Result<Json> reply = editor_->Execute(operation);
  if (!test_ && editor_->version() != shown_version_) ShowEdited();
  return reply;
}

Result<Json> EditLink::Edit(const EditOperation& operation) {
  const std::lock_guard lock(mutex_);
  Result<Json> reply = std::visit([this](const auto& each) { return Execute(each); }, operation);
  if (!reply.ok()) {
    const Error& error = reply.error();
    return Error{{}, error.where.file.empty() ? error.message : error.ToString(), error.code};
  }
  if (std::holds_alternative<edit::Document>(operation)) {
    reply.value()["edition"] = edition_;
    reply.value()["testing"] = test_.has_value();
    reply.value()["tested"] = tested_;
    if (test_ && !test_->failures().empty()) reply.value()["failure"] = test_->failures().back();
  }
  return reply;
}

}  // namespace troupe
