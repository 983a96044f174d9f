#include "world-service/observers/ros/rmf_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "common/base/or_failure.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"

namespace troupe {
namespace {

constexpr std::int32_t kDepth = 100;  // as of the plugins of Open-RMF
constexpr std::size_t kMaxRefusals = 1000;

// Of the entity, door or lift that a request of this file is for.
const std::string& NameOf(const control::Request& request) {
  if (const auto* const door = std::get_if<control::Door>(&request)) return door->name;
  if (const auto* const lift = std::get_if<control::Lift>(&request)) return lift->name;
  return std::get<control::SetPose>(request).name;
}

// The pending work of the thread. Its lock is the innermost one: a caller of Add may hold any other lock, and no other
// lock is requested while it is held.
class Duties {
 public:
  struct Due {
    bool stop = false;
    bool follow = false;    // the scene is new
    bool arrived = false;   // a sample
    bool answered = false;  // an edit
    bool any() const { return stop || follow || arrived || answered; }
  };

  void Add(bool Due::*duty) {
    const std::lock_guard lock(mutex_);
    due_.*duty = true;
    changed_.notify_one();
  }
  Due Await() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return due_.any(); });
    return std::exchange(due_, {});
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  Due due_;
};

}  // namespace

// The state that replies to requests use: they may arrive after the end of the object, so they share its ownership.
struct RmfTopics::Shared {
  Duties duties;
  std::mutex mutex;      // guards the members below
  std::size_t open = 0;  // edits without a reply
  // The newest request to a door or a lift, until the state has it.
  struct Wanted {
    control::Request request;
    std::optional<Tick> answered_at = {};  // an input of the tick after this one; nothing: not answered yet
  };
  std::map<std::string, Wanted> wanted;  // by door or lift
  struct Moved {
    std::string item;
    bool is_done = false;
    std::string problem;
  };
  std::vector<Moved> moved;  // replies to edits of workcells, with room for those of open ones

  // The reply to a request. A pose has no name any more then.
  void Finish(control::Request& edit, bool is_done, Tick tick, const std::string& problem) noexcept {
    const std::lock_guard lock(mutex);
    --open;
    const auto found = wanted.find(NameOf(edit));
    if (found != wanted.end() && found->second.request == edit) {
      if (is_done) {
        found->second.answered_at = tick;
      } else {
        wanted.erase(found);
      }
    }
    if (auto* const move = std::get_if<control::SetPose>(&edit)) {
      moved.push_back({std::move(move->name), is_done, {}});
      try {
        moved.back().problem = problem;
        // A reply must not throw: the run would fail for a line of text.
      } catch (const std::bad_alloc&) {  // the report has no reason
      }
    }
    duties.Add(&Duties::Due::answered);
  }
};

struct RmfTopics::Topics {
  Topics(const ros::RosNode& node, const std::function<void()>& notify)
      : door_states(node, "/door_states", ros::Stream(kDepth)),
        lift_states(node, "/lift_states", ros::Stream(kDepth)),
        door_requests(node, "/door_requests", ros::Stream(kDepth), ros::Part::kOnlyReader, notify),
        lift_requests(node, "/lift_requests", ros::Stream(kDepth), ros::Part::kOnlyReader, notify) {}

  ros::RosWriter<ros::DoorStateMessage> door_states;
  ros::RosWriter<ros::LiftStateMessage> lift_states;
  ros::RosReader<ros::DoorRequest> door_requests;
  ros::RosReader<ros::LiftRequest> lift_requests;
};

RmfTopics::RmfTopics(const ros::RosNode& node, std::shared_ptr<const Scene> scene, WorldControl& control,
                     RmfWorkcells::Results results, std::function<void(const std::string&)> report)
    : node_(node),
      control_(control),
      results_(results),
      reports_(std::make_shared<FloodLimiter>(std::move(report))),
      shared_(std::make_shared<Shared>()),
      scene_(std::move(scene)),
      has_workcells_(!FindWorkcells(scene_->world()).empty()),
      doors_(ros::DoorsOf(scene_->world())) {
  shared_->duties.Add(&Duties::Due::follow);
  thread_ = std::thread([this] { Run(); });
}

RmfTopics::~RmfTopics() {
  shared_->duties.Add(&Duties::Due::stop);
  thread_.join();
}

void RmfTopics::ChangeWorld(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(shared_->mutex);
  scene_ = std::move(scene);
  doors_ = ros::DoorsOf(scene_->world());
  has_workcells_ = !FindWorkcells(scene_->world()).empty();
  state_ = {};
  if (workcells_) workcells_->ChangeWorld(scene_);
  if (fleets_) fleets_->ChangeWorld(scene_->world());
  shared_->duties.Add(&Duties::Due::follow);
}

void RmfTopics::Run() {
  for (;;) {
    const Duties::Due due = shared_->duties.Await();
    if (due.stop) break;
    bool wakes = due.answered;
    try {
      if (due.follow) Follow();
      {
        const std::lock_guard lock(shared_->mutex);
        FinishMoves();
        has_held_ |= holds_;
        if (!holds_) ReadRequests();
      }
      SendEdits();
      wakes = PlanMoves() || wakes;
    } catch (const std::exception& exception) {  // of DDS, as without memory
      reports_->Add(exception.what());
      wakes = true;
    }
    if (wakes) control_.Wake();
  }
  // Without the mutex: the thread of the connection may wait for it.
  topics_.reset();
  workcells_.reset();
  fleets_.reset();
}

// Only this thread changes the pointers. The mutex is not held while a part is made or ends.
template <typename Part, typename Make, typename Enter>
bool RmfTopics::FollowPart(std::unique_ptr<Part>& part, bool is_needed, const Make& make, const Enter& enter) {
  if (is_needed == (part != nullptr)) return false;
  std::unique_ptr<Part> other;  // the one before ends after the lock
  if (is_needed) other = make();
  const std::lock_guard lock(shared_->mutex);
  if (other) enter(*other);  // its world may be newer than the one that needs it
  other.swap(part);
  return true;
}

void RmfTopics::Follow() {
  std::unique_lock lock(shared_->mutex);
  const std::shared_ptr<const Scene> scene = scene_;
  const bool has_workcells = has_workcells_;
  lock.unlock();
  const WorldDescription& world = scene->world();
  const auto notify = [this] { shared_->duties.Add(&Duties::Due::arrived); };
  bool has_changed = FollowPart(
      topics_, !world.doors.empty() || !world.lifts.empty(), [&] { return std::make_unique<Topics>(node_, notify); },
      [](Topics&) {});
  has_changed |= FollowPart(
      workcells_, has_workcells,
      [&] {
        const auto report = [reports = reports_](const std::string& line) { reports->Add(line); };
        return std::make_unique<RmfWorkcells>(node_, notify, results_, report);
      },
      [this](RmfWorkcells& workcells) { workcells.ChangeWorld(scene_); });
  has_changed |= FollowPart(
      fleets_, ros::HasRmf(world), [&] { return std::make_unique<RmfFleets>(node_); },
      [this](RmfFleets& fleets) { fleets.ChangeWorld(scene_->world()); });
  if (fleets_ && fleets_->IsToFollow()) {
    fleets_->Follow();
    has_changed = true;
  }
  if (has_changed) node_.connection->Announce();
}

bool RmfTopics::PlanMoves() {
  for (bool has_planned = false;; has_planned = true) {
    std::unique_lock lock(shared_->mutex);
    if (!workcells_ || !KnowsState()) return has_planned;
    if (!holds_) workcells_->Read();
    const std::optional<RmfWorkcells::Question> question = workcells_->NextQuestion();
    if (!question) return has_planned;
    ReserveEdit();
    const std::shared_ptr<const Scene> scene = scene_;
    const WorldState state = state_;
    lock.unlock();
    const Result<ItemMove> planned =
        OrFailure([&] { return PlanMove(scene, state, question->workcell, question->order, question->moving); });
    lock.lock();
    if (scene != scene_) continue;  // it is planned again
    if (std::optional<control::SetPose> edit = workcells_->Plan(planned)) AddEdit(std::move(*edit));
    lock.unlock();
    SendEdits();
  }
}

void RmfTopics::OnCommit(const FrameMessage& frame) {
  const std::lock_guard lock(shared_->mutex);
  const WorldDescription& world = scene_->world();
  if (!KnowsState()) shared_->duties.Add(&Duties::Due::arrived);  // the samples have waited for it
  if (has_workcells_) {
    state_ = frame.state;
  } else {
    state_.doors = frame.state.doors;
    state_.lifts = frame.state.lifts;
  }
  std::erase_if(shared_->wanted, [&](const auto& entry) {
    return entry.second.answered_at && *entry.second.answered_at != frame.state.tick;
  });
  for (std::size_t i = 0; i < state_.lifts.size(); ++i) {
    const LiftDescription& lift = world.lifts[i];
    const std::string& name = world.model(lift.model).name;
    const auto task = tasks_.find(name);
    if (task == tasks_.end() || task->second.is_done || shared_->wanted.contains(name)) continue;
    const LiftState& state = state_.lifts[i];
    // Another tool may have called the lift meanwhile: then it is free, too.
    const bool is_called = lift.floors[state.floor].name == task->second.floor;
    task->second.is_done = !is_called || (state.z == lift.floors[state.floor].z &&
                                          ros::DoorsAt(lift, state_, state.floor) == ros::DoorMode::kOpen);
  }
}

void RmfTopics::OnTick(const FrameMessage& frame) {
  const std::lock_guard lock(shared_->mutex);
  const WorldDescription& world = scene_->world();
  const ros::Time stamp = ros::ToTime(frame.state.tick, world.interval_ns);
  const auto is_due_by = [&](double period) {
    return frame.paused || ros::IsDue(frame.state.tick, world.interval_ns, period);
  };
  if (fleets_) {
    if (fleets_->IsToFollow()) shared_->duties.Add(&Duties::Due::follow);
    fleets_->OnTick(is_due_by(ros::kRobotStatePeriod));
  }
  if (workcells_) workcells_->OnTick(frame.state.tick, stamp, is_due_by(ros::kWorkcellStatePeriod));
  if (!topics_ || frame.state.doors.size() != world.doors.size() || frame.state.lifts.size() != world.lifts.size()) {
    return;
  }
  const bool is_due = is_due_by(ros::kDoorStatePeriod);
  for (const std::size_t i : topics_->door_states.wanted() ? doors_ : std::vector<std::size_t>()) {
    const std::string& name = world.model(world.doors[i].model).name;
    const ros::DoorMode mode = ros::ModeOf(frame.state.doors[i]);
    const auto [shown, is_new] = shown_doors_.emplace(name, mode);
    if (!is_due && !is_new && shown->second == mode) continue;
    shown->second = mode;
    dds::WireArena arena;
    topics_->door_states.Write(ros::MakeDoorState(stamp, name, frame.state.doors[i], arena));
  }
  if (!topics_->lift_states.wanted()) return;
  for (std::size_t i = 0; i < world.lifts.size(); ++i) {
    const LiftDescription& lift = world.lifts[i];
    const std::string& name = world.model(lift.model).name;
    LiftView view{.floor = ros::FloorOf(lift, frame.state.lifts[i]), .state = frame.state.lifts[i]};
    view.doors = ros::DoorsAt(lift, frame.state, view.floor);
    view.state.z = 0.0;  // it is not shown
    if (const auto task = tasks_.find(name); task != tasks_.end()) view.task = task->second;
    const auto [shown, is_new] = shown_lifts_.emplace(name, view);
    if (!is_due && !is_new && shown->second == view) continue;
    shown->second = view;
    dds::WireArena arena;
    const auto mode = view.task.type == ros::LiftRequestType::kHuman ? ros::LiftMode::kHuman : ros::LiftMode::kAgv;
    topics_->lift_states.Write(
        ros::MakeLiftState(stamp, world, i, frame.state, mode, SessionOf(i, frame.state.lifts[i]), arena));
  }
}

void RmfTopics::Hold() {
  const std::lock_guard lock(shared_->mutex);
  holds_ = true;
}

bool RmfTopics::Settle() {
  {
    const std::lock_guard lock(shared_->mutex);
    has_held_ = false;
    ReadRequests();
  }
  SendEdits();
  const std::lock_guard lock(shared_->mutex);
  FinishMoves();
  const bool is_to_plan = workcells_ && workcells_->has_requests();
  if (is_to_plan) shared_->duties.Add(&Duties::Due::arrived);
  if (is_to_plan || shared_->open > 0) return false;
  holds_ = false;
  if (std::exchange(has_held_, false)) shared_->duties.Add(&Duties::Due::arrived);
  return true;
}

bool RmfTopics::KnowsState() const {
  const WorldDescription& world = scene_->world();
  return state_.doors.size() == world.doors.size() && state_.lifts.size() == world.lifts.size() &&
         (!has_workcells_ ||
          (state_.robots.size() == world.robots.size() && state_.objects.size() == world.objects.size()));
}

void RmfTopics::ReadRequests() {
  if (!KnowsState()) return;
  if (topics_) {
    std::vector<DoorAsk> doors;
    topics_->door_requests.Drain([&](const ros::DoorRequest& request) {
      const bool opens = request.requested_mode.value == static_cast<std::uint32_t>(ros::DoorMode::kOpen);
      doors.push_back({dds::Text(request.requester_id), dds::Text(request.door_name), opens});
    });
    std::vector<LiftAsk> lifts;
    topics_->lift_requests.Drain([&](const ros::LiftRequest& request) {
      lifts.push_back({dds::Text(request.session_id), dds::Text(request.lift_name),
                       dds::Text(request.destination_floor), request.request_type});
    });
    if (results_ == RmfWorkcells::Results::kWithTicks) {
      std::stable_sort(doors.begin(), doors.end(),
                       [](const DoorAsk& a, const DoorAsk& b) { return a.requester < b.requester; });
      std::stable_sort(lifts.begin(), lifts.end(),
                       [](const LiftAsk& a, const LiftAsk& b) { return a.session < b.session; });
    }
    for (const DoorAsk& ask : doors) OperateDoor(ask);
    for (const LiftAsk& ask : lifts) CallLift(ask);
  }
  if (workcells_) workcells_->Read();
}

void RmfTopics::FinishMoves() {
  for (const Shared::Moved& moved : shared_->moved) {
    if (workcells_) workcells_->Finish(moved.item, moved.is_done, moved.problem);
  }
  shared_->moved.clear();
}

void RmfTopics::OperateDoor(const DoorAsk& ask) {
  const WorldDescription& world = scene_->world();
  const auto door = std::find_if(doors_.begin(), doors_.end(),
                                 [&](std::size_t i) { return world.model(world.doors[i].model).name == ask.door; });
  if (door == doors_.end()) {
    return Refuse(fmt::format("/door_requests: the world has no door '{}' that takes requests", ask.door));
  }
  const control::Door request{ask.door, ask.opens ? 1.0 : 0.0};
  Ask(request, state_.doors[*door].target == request.opening);
}

void RmfTopics::CallLift(const LiftAsk& ask) {
  const WorldDescription& world = scene_->world();
  const std::string& name = ask.lift;
  const std::optional<std::size_t> number = FindLift(world, name);
  if (!number) return Refuse(fmt::format("/lift_requests: the world has no lift '{}'", name));
  const LiftDescription& lift = world.lifts[*number];
  const LiftState& state = state_.lifts[*number];
  LiftTask asked{ask.session, static_cast<ros::LiftRequestType>(ask.type), ask.floor, false};
  // RMF ends sessions so.
  if (asked.type == ros::LiftRequestType::kEndSession && asked.floor.empty())
    asked.floor = lift.floors[state.floor].name;
  if (std::none_of(lift.floors.begin(), lift.floors.end(),
                   [&](const LiftFloor& floor) { return floor.name == asked.floor; })) {
    return Refuse(fmt::format("/lift_requests: lift '{}' has no floor '{}'", name, asked.floor));
  }
  if (ask.type > static_cast<std::uint8_t>(ros::LiftRequestType::kHuman)) {
    return Refuse(fmt::format("/lift_requests: lift '{}': found the type {}, expected 0 to 2", name, ask.type));
  }
  if (state.session) {
    return Refuse(fmt::format("/lift_requests: lift '{}' is in the session of robot '{}': ignored that of '{}'", name,
                              world.robot(*state.session).name, asked.session));
  }
  LiftTask& task = tasks_[name];
  const LiftTask same{task.session, task.type, task.floor, false};
  // Repeated, and no other tool has called the lift meanwhile.
  if (asked == same && (!task.is_done || lift.floors[state.floor].name == asked.floor)) return;
  if (!task.is_done) {
    return Refuse(fmt::format("/lift_requests: lift '{}' is on its way to {} for '{}': ignored the request of '{}'",
                              name, task.floor, task.session, asked.session));
  }
  task = asked;
  Ask(control::Lift{name, asked.floor}, lift.floors[state.floor].name == asked.floor);
}

template <typename Request>
void RmfTopics::Ask(const Request& request, bool already_there) {
  const auto wanted = shared_->wanted.find(request.name);
  if (wanted != shared_->wanted.end() ? wanted->second.request == control::Request(request) : already_there) return;
  ReserveEdit();
  shared_->wanted[request.name] = {request};
  AddEdit(request);
}

void RmfTopics::ReserveEdit() {
  edits_.reserve(edits_.size() + 1);
  shared_->moved.reserve(shared_->moved.size() + shared_->open + 1);
}

void RmfTopics::AddEdit(control::Request edit) {
  edits_.push_back(std::move(edit));
  ++shared_->open;
}

void RmfTopics::Refuse(const std::string& line) {
  if (refused_.size() >= kMaxRefusals) refused_.clear();
  if (refused_.insert(line).second) reports_->Add(line);
}

// That of a robot of the world, or that of the newest request.
std::string RmfTopics::SessionOf(std::size_t lift, const LiftState& state) const {
  const WorldDescription& world = scene_->world();
  if (const std::optional<RobotId>& robot = state.session) return world.robot(*robot).name;
  const auto task = tasks_.find(world.model(world.lifts[lift].model).name);
  if (task == tasks_.end() || task->second.type == ros::LiftRequestType::kEndSession) return "";
  return task->second.session;
}

void RmfTopics::SendEdits() {
  std::vector<control::Request> edits;
  {
    const std::lock_guard lock(shared_->mutex);
    edits.swap(edits_);
  }
  for (control::Request& edit : edits) {
    try {
      control_.Request(edit, [shared = shared_, reports = reports_,
                              sent = std::make_shared<control::Request>(edit)](const ControlReply& reply) {
        try {
          if (!reply.done && !control::Is<control::SetPose>(*sent)) reports->Add(NameOf(*sent) + ": " + reply.problem);
        } catch (const std::bad_alloc&) {  // the line is missing
        }
        shared->Finish(*sent, reply.done, reply.tick, reply.problem);
      });
    } catch (const std::exception& exception) {  // as without memory
      reports_->Add(exception.what());
      shared_->Finish(edit, false, 0, {});
    }
  }
}

}  // namespace troupe
