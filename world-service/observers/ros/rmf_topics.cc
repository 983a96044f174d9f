#include "world-service/observers/ros/rmf_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"
#include "world-service/observers/ros/request_values.h"

namespace troupe {
namespace {

constexpr std::int32_t kDepth = 100;  // as of the plugins of Open-RMF
constexpr std::size_t kMaxRefusals = 1000;
constexpr std::size_t kMaxText = 1000;  // bytes, of a request: as of names in world files

// Of any length: that of a request which is refused for it is not shown.
std::size_t LongestOf(std::initializer_list<std::string_view> texts) {
  return std::max(texts, [](std::string_view a, std::string_view b) { return a.size() < b.size(); }).size();
}

// Of the door or lift that a request is for.
const std::string& NameOf(const control::Request& request) {
  if (const auto* const door = std::get_if<control::Door>(&request)) return door->name;
  return std::get<control::Lift>(request).name;
}

}  // namespace

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
      reports_(std::move(report)),
      self_(std::make_shared<RmfTopics*>(this)),
      scene_(std::move(scene)) {
  FollowWorld();
}

RmfTopics::~RmfTopics() = default;

template <typename Call>
bool RmfTopics::Attempt(const Call& call) {
  try {
    call();
    return true;
  } catch (const std::exception& exception) {
    reports_.Add(exception.what());
    return false;
  }
}

void RmfTopics::ChangeWorld(std::shared_ptr<const Scene> scene) {
  scene_ = std::move(scene);
  intake_ = Intake::kAwaitsState;
  FollowWorld();
}

void RmfTopics::FollowWorld() {
  if (Attempt([this] { ExchangeTopics(); })) return;
  // They may refer to the world before.
  topics_.reset();
  workcells_.reset();
  fleets_.reset();
}

void RmfTopics::ExchangeTopics() {
  const WorldDescription& world = scene_->world();
  doors_ = ros::DoorsOf(world);
  const auto notify = [this] { has_arrived_ = true; };
  bool has_changed = false;
  // Makes or ends one of them.
  const auto follow = [&has_changed](auto& part, bool is_needed, const auto& make) {
    if (is_needed == (part != nullptr)) return;
    part = is_needed ? make() : nullptr;
    has_changed = true;
  };
  follow(topics_, !world.doors.empty() || !world.lifts.empty(),
         [&] { return std::make_unique<Topics>(node_, notify); });
  follow(workcells_, !FindWorkcells(world).empty(), [&] {
    return std::make_unique<RmfWorkcells>(node_, notify, results_,
                                          [this](const std::string& line) { reports_.Add(line); });
  });
  follow(fleets_, ros::HasRmf(world), [&] { return std::make_unique<RmfFleets>(node_); });
  if (workcells_) workcells_->ChangeWorld(world);
  if (fleets_) fleets_->ChangeWorld(world);
  if (has_changed) node_.connection->Announce();
}

void RmfTopics::OnCommit(const FrameMessage& frame, bool awaits_nodes) {
  intake_ = awaits_nodes ? Intake::kCollecting : Intake::kOpen;
  if (workcells_) {
    state_ = frame.state;
  } else {
    state_.doors = frame.state.doors;
    state_.lifts = frame.state.lifts;
  }
  std::erase_if(wanted_, [&](const auto& entry) {
    return entry.second.answered_at && *entry.second.answered_at != frame.state.tick;
  });
  AdvanceLifts();
}

void RmfTopics::AdvanceLifts() {
  const WorldDescription& world = scene_->world();
  for (std::size_t i = 0; i < state_.lifts.size(); ++i) {
    const LiftDescription& lift = world.lifts[i];
    const std::string& name = world.model(lift.model).name;
    const auto task = tasks_.find(name);
    if (task == tasks_.end() || task->second.is_done || wanted_.contains(name)) continue;
    const LiftState& state = state_.lifts[i];
    // Another tool may have called the lift meanwhile: then it is free, too.
    const bool is_called = lift.floors[state.floor].name == task->second.floor;
    task->second.is_done = !is_called || (state.z == lift.floors[state.floor].z &&
                                          ros::DoorsAt(lift, state_, state.floor) == ros::DoorMode::kOpen);
  }
}

void RmfTopics::OnWake() {
  if (intake_ == Intake::kOpen) ExecuteRequests();
  if (intake_ != Intake::kSettling) return;
  has_late_ = true;
  PlanMove();
}

// Late requests, which arrive in kSettling, are not of this tick, whose nodes have all answered: they are read after
// it, in a turn of their own, since a paused run may have no next tick.
bool RmfTopics::Settle() {
  if (intake_ == Intake::kCollecting) {
    intake_ = Intake::kSettling;
    has_late_ = false;
    ExecuteRequests();
  }
  if (intake_ != Intake::kSettling) return true;
  if (open_ > 0 || (workcells_ && workcells_->has_accepted())) return false;
  intake_ = Intake::kOpen;
  if (has_late_) control_.Wake();
  return true;
}

void RmfTopics::OnTick(const FrameMessage& frame) {
  Attempt([&] { WriteStates(frame); });
  if (intake_ == Intake::kOpen) ExecuteRequests();
}

void RmfTopics::WriteStates(const FrameMessage& frame) {
  const WorldDescription& world = scene_->world();
  const ros::Time stamp = ros::ToTime(frame.state.tick, world.interval_ns);
  const auto is_due_by = [&](double period) {
    return frame.paused || ros::IsDue(frame.state.tick, world.interval_ns, period);
  };
  if (fleets_) fleets_->OnTick(is_due_by(ros::kRobotStatePeriod));
  if (workcells_) workcells_->OnTick(frame.state.tick, stamp, is_due_by(ros::kWorkcellStatePeriod));
  if (topics_) {
    const bool is_due = is_due_by(ros::kDoorStatePeriod);
    if (topics_->door_states.wanted()) WriteDoors(frame, stamp, is_due);
    if (topics_->lift_states.wanted()) WriteLifts(frame, stamp, is_due);
  }
}

void RmfTopics::WriteDoors(const FrameMessage& frame, const ros::Time& stamp, bool is_due) {
  const WorldDescription& world = scene_->world();
  for (const std::size_t i : doors_) {
    const std::string& name = world.model(world.doors[i].model).name;
    const ros::DoorMode mode = ros::ModeOf(frame.state.doors[i]);
    const auto [shown, is_new] = shown_doors_.emplace(name, mode);
    if (!is_due && !is_new && shown->second == mode) continue;
    shown->second = mode;
    dds::WireArena arena;
    topics_->door_states.Write(ros::MakeDoorState(stamp, name, frame.state.doors[i], arena));
  }
}

void RmfTopics::WriteLifts(const FrameMessage& frame, const ros::Time& stamp, bool is_due) {
  const WorldDescription& world = scene_->world();
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

void RmfTopics::ExecuteRequests() {
  Attempt([this] { ReadRequests(); });
  PlanMove();
}

void RmfTopics::PlanMove() {
  if (!workcells_) return;
  Attempt([this] {
    if (const std::optional<control::SetPose> move = workcells_->PlanNext(scene_, state_)) Send(*move);
  });
  if (workcells_->has_accepted()) control_.Wake();
}

void RmfTopics::ReadRequests() {
  if (topics_) {
    std::vector<DoorAsk> doors;
    topics_->door_requests.Drain([&](const ros::DoorRequest& request) {
      const bool opens = request.requested_mode.value == static_cast<std::uint32_t>(ros::DoorMode::kOpen);
      DoorAsk ask{dds::Text(request.requester_id), dds::Text(request.door_name), opens};
      if (HasShortTexts("/door_requests", LongestOf({ask.requester, ask.door}))) doors.push_back(std::move(ask));
    });
    std::vector<LiftAsk> lifts;
    topics_->lift_requests.Drain([&](const ros::LiftRequest& request) {
      LiftAsk ask{dds::Text(request.session_id), dds::Text(request.lift_name), dds::Text(request.destination_floor),
                  request.request_type};
      if (HasShortTexts("/lift_requests", LongestOf({ask.session, ask.lift, ask.floor}))) {
        lifts.push_back(std::move(ask));
      }
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

bool RmfTopics::HasShortTexts(const char* topic, std::size_t longest) {
  if (longest <= kMaxText) return true;
  Refuse(fmt::format("{}: found a text of {} bytes, expected at most {}", topic, longest, kMaxText));
  return false;
}

void RmfTopics::OperateDoor(const DoorAsk& ask) {
  const WorldDescription& world = scene_->world();
  const auto door = std::find_if(doors_.begin(), doors_.end(),
                                 [&](std::size_t i) { return world.model(world.doors[i].model).name == ask.door; });
  if (door == doors_.end()) {
    return Refuse(fmt::format("/door_requests: the world has no door '{}' that takes requests", Shown(ask.door)));
  }
  const control::Door request{ask.door, ask.opens ? 1.0 : 0.0};
  Ask(request, state_.doors[*door].target == request.opening);
}

void RmfTopics::CallLift(const LiftAsk& ask) {
  const WorldDescription& world = scene_->world();
  const std::string& name = ask.lift;
  const std::optional<std::size_t> number = FindLift(world, name);
  if (!number) return Refuse(fmt::format("/lift_requests: the world has no lift '{}'", Shown(name)));
  const LiftDescription& lift = world.lifts[*number];
  const LiftState& state = state_.lifts[*number];
  LiftTask asked{ask.session, static_cast<ros::LiftRequestType>(ask.type), ask.floor, false};
  // RMF ends sessions so.
  if (asked.type == ros::LiftRequestType::kEndSession && asked.floor.empty())
    asked.floor = lift.floors[state.floor].name;
  if (std::none_of(lift.floors.begin(), lift.floors.end(),
                   [&](const LiftFloor& floor) { return floor.name == asked.floor; })) {
    return Refuse(fmt::format("/lift_requests: lift '{}' has no floor '{}'", name, Shown(asked.floor)));
  }
  if (ask.type > static_cast<std::uint8_t>(ros::LiftRequestType::kHuman)) {
    return Refuse(fmt::format("/lift_requests: lift '{}': found the type {}, expected 0 to 2", name, ask.type));
  }
  if (state.session) {
    return Refuse(fmt::format("/lift_requests: lift '{}' is in the session of robot '{}': ignored that of '{}'", name,
                              world.robot(*state.session).name, Shown(asked.session)));
  }
  LiftTask& task = tasks_[name];
  const LiftTask same{task.session, task.type, task.floor, false};
  // Repeated, and no other tool has called the lift meanwhile.
  if (asked == same && (!task.is_done || lift.floors[state.floor].name == asked.floor)) return;
  if (!task.is_done) {
    return Refuse(fmt::format("/lift_requests: lift '{}' is on its way to {} for '{}': ignored the request of '{}'",
                              name, task.floor, Shown(task.session), Shown(asked.session)));
  }
  task = asked;
  Ask(control::Lift{name, asked.floor}, lift.floors[state.floor].name == asked.floor);
}

template <typename Request>
void RmfTopics::Ask(const Request& request, bool already_there) {
  const auto wanted = wanted_.find(request.name);
  if (wanted != wanted_.end() ? wanted->second.request == control::Request(request) : already_there) return;
  wanted_[request.name] = {request};
  Send(request);
}

void RmfTopics::Send(const control::Request& request) {
  ++open_;
  const bool is_sent = Attempt([&] {
    control_.Request(request, [self = std::weak_ptr(self_), request](const ControlReply& reply) {
      if (const auto alive = self.lock()) (*alive)->OnReply(request, reply);
    });
  });
  if (!is_sent) OnReply(request, {.problem = "it was not sent"});
}

void RmfTopics::OnReply(const control::Request& request, const ControlReply& reply) {
  --open_;
  Attempt([&] { Finish(request, reply); });
  if (intake_ == Intake::kSettling && open_ == 0) control_.Wake();
}

void RmfTopics::Finish(const control::Request& request, const ControlReply& reply) {
  if (const auto* const move = std::get_if<control::SetPose>(&request)) {
    if (workcells_) workcells_->Finish(move->name, reply.done, reply.problem);
  } else {
    const auto wanted = std::find_if(wanted_.begin(), wanted_.end(),
                                     [&](const auto& entry) { return entry.second.request == request; });
    if (wanted != wanted_.end() && reply.done) {
      wanted->second.answered_at = reply.tick;
    } else if (wanted != wanted_.end()) {
      wanted_.erase(wanted);
    }
    if (!reply.done) reports_.Add(NameOf(request) + ": " + reply.problem);
  }
}

void RmfTopics::Refuse(const std::string& line) {
  if (refused_.size() >= kMaxRefusals) refused_.clear();
  if (refused_.insert(line).second) reports_.Add(line);
}

// That of a robot of the world, or that of the newest request.
std::string RmfTopics::SessionOf(std::size_t lift, const LiftState& state) const {
  const WorldDescription& world = scene_->world();
  if (const std::optional<RobotId>& robot = state.session) return world.robot(*robot).name;
  const auto task = tasks_.find(world.model(world.lifts[lift].model).name);
  if (task == tasks_.end() || task->second.type == ros::LiftRequestType::kEndSession) return "";
  return task->second.session;
}

}  // namespace troupe
