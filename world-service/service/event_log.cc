#include "world-service/service/event_log.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "world-service/service/live_run.h"

namespace troupe {
namespace {

constexpr int kReportedPerSecond = 10;
constexpr std::size_t kAgentsTold = 10;

// The name of a model; without one, of the ground.
std::string Name(const WorldDescription& world, const std::optional<ModelId>& model) {
  return model ? world.model(*model).name : "the ground";
}

}  // namespace

void EventLog::Add(EventType type, Tick tick, std::optional<RobotId> robot, std::string detail) {
  unreported_.push_back({tick, type, robot, std::nullopt, std::move(detail)});
  between_frames_.push_back(unreported_.back());
}

bool EventLog::Reject(Tick tick, std::optional<RobotId> robot, std::string reason, double now) {
  ++rejected_;
  if (now - second_began_ >= 1.0) {
    second_began_ = now;
    rejected_this_second_ = 0;
    // The sum belongs to the second before, and is told by the first rejection after it: no timer is needed, and a
    // flood that has ended costs nothing further.
    if (const std::uint64_t count = std::exchange(silent_, 0); count > 0) {
      Add(EventType::kProposalRejected, tick, std::nullopt, std::to_string(count) + " more, not shown");
    }
  }
  if (++rejected_this_second_ > kReportedPerSecond) {
    ++silent_;
    return false;
  }
  Add(EventType::kProposalRejected, tick, robot, std::move(reason));
  return true;
}

void EventLog::Report(Tick tick, std::optional<RobotId> robot, std::string_view text) {
  // Frame and report are drained at different times, so each has a count of its own: a long pause fills the frame's
  // list while the console goes on reporting.
  const bool enters_frame = reports_between_frames_ < kMaxReports;
  const bool is_told = unreported_reports_ < kMaxReports;
  if (!enters_frame && !is_told) return;
  const Event event{.tick = tick, .type = EventType::kReported, .robot = robot, .detail = PlainLine(text, kMaxReport)};
  if (enters_frame) between_frames_.push_back(event);
  if (is_told) unreported_.push_back(event);
  reports_between_frames_ += enters_frame;
  unreported_reports_ += is_told;
}

std::vector<Event> EventLog::CompleteFrame(Tick tick, std::vector<Event> of_step) {
  reports_between_frames_ = 0;
  for (const Event& event : of_step) {
    stalls_ += event.type == EventType::kStallBegan;
    if (event.type == EventType::kSaid && event.robot) said_[*event.robot] = event;
  }
  unreported_.insert(unreported_.end(), of_step.begin(), of_step.end());
  // The usual tick: nothing to merge.
  if (between_frames_.empty()) return of_step;
  // They arrived in the order of the network; ordered by robot, records of two runs are easier to compare.
  std::stable_sort(between_frames_.begin(), between_frames_.end(),
                   [](const Event& a, const Event& b) { return a.robot < b.robot; });
  // A frame's events all have its tick, also those that arrived while the tick before was the newest.
  for (Event& event : between_frames_) event.tick = tick;
  between_frames_.insert(between_frames_.end(), std::make_move_iterator(of_step.begin()),
                         std::make_move_iterator(of_step.end()));
  return std::exchange(between_frames_, {});
}

std::vector<Event> EventLog::DrainUnreported() {
  unreported_reports_ = 0;
  return std::exchange(unreported_, {});
}

const Event* EventLog::LastSaid(RobotId robot) const {
  const auto said = said_.find(robot);
  return said != said_.end() ? &said->second : nullptr;
}

std::string EventText(const WorldDescription& world, const Event& event) {
  const std::string robot = event.robot ? world.robot(*event.robot).name : "";
  std::string text = "tick " + std::to_string(event.tick) + ": ";
  switch (event.type) {
    case EventType::kStallBegan:
      text += robot + " stalled";
      if (event.other) text += " at " + world.model(*event.other).name;
      break;
    case EventType::kStallEnded:
      text += robot + " moves freely again";
      break;
    case EventType::kJoined:
      text += robot + " has an agent";
      break;
    case EventType::kLeft:
      text += robot + " has lost its agent";
      break;
    case EventType::kProposalRejected:
      text += "proposal rejected";
      if (event.robot) text += " for " + robot;
      break;
    case EventType::kBlocked:
      text += robot + " is blocked by " + Name(world, event.other);
      break;
    case EventType::kGripped:
      text += robot + " holds " + Name(world, event.object);
      break;
    case EventType::kReleased:
      text += robot + " released " + Name(world, event.object);
      break;
    case EventType::kLanded:
      text += Name(world, event.object) + " landed on " + Name(world, event.other);
      break;
    case EventType::kUnstable:
      text += Name(world, event.object) + " landed out of balance on " + Name(world, event.other);
      break;
    case EventType::kOutOfEnergy:
      text += robot + " has no energy";
      break;
    case EventType::kDoorOpened:
      text += Name(world, event.object) + " is open";
      break;
    case EventType::kDoorClosed:
      text += Name(world, event.object) + " is closed";
      break;
    case EventType::kDoorBlocked:
    case EventType::kLiftBlocked:
      text += Name(world, event.object) + " is blocked";
      break;
    case EventType::kLiftLeft:
      return text + Name(world, event.object) + " leaves floor " + event.detail;
    case EventType::kLiftArrived:
      return text + Name(world, event.object) + " is at floor " + event.detail;
    case EventType::kPersonBoarded:
      return text + Name(world, event.object) + " gets on " + Name(world, event.other) + " at " + event.detail;
    case EventType::kPersonAlighted:
      return text + Name(world, event.object) + " gets off " + Name(world, event.other) + " at " + event.detail;
    case EventType::kPersonArrived:
      return text + Name(world, event.object) + " has reached " + event.detail;
    case EventType::kPersonEntered:
      return text + Name(world, event.object) + " has entered";
    case EventType::kPersonLeft:
      return text + Name(world, event.object) + " has left";
    case EventType::kLiftOverloaded:
      return text + Name(world, event.object) + " carries no more at floor " + event.detail;
    case EventType::kLaneSwitched:
      return text + "lane " + event.detail;
    case EventType::kZoneSwitched:
      return text + "zone " + event.detail;
    case EventType::kGoodsArrived:
      return text + "goods of " + event.detail + " have arrived";
    case EventType::kGoodsRefused:
      return text + "there is no room for goods of " + event.detail;
    case EventType::kGoodsLoaded:
      return text + robot + " has goods of " + event.detail;
    case EventType::kDelivered:
      return text + robot + " has delivered goods of " + event.detail;
    case EventType::kWaitBegan:
      text += robot + " has waited for 10 s";
      if (event.other) text += " for " + world.model(*event.other).name;
      break;
    case EventType::kWaitEnded:
      text += robot + " goes on";
      break;
    case EventType::kDeadlockBroken:
      text += robot + " goes on; these had waited for each other";
      break;
    case EventType::kReplanned:
      text += robot + " has its way planned anew";
      if (event.other) text += " because of " + world.model(*event.other).name;
      break;
    case EventType::kNoWay:
      return text + robot + " has had no way to its goal for 10 s: " + event.detail;
    case EventType::kSaid:
      return text + robot + " says: " + event.detail;
    case EventType::kReported:
      return text + (event.robot ? "robot " + robot + ": " : "") + event.detail;
  }
  if (!event.detail.empty()) text += " (" + event.detail + ")";
  return text;
}

std::vector<ToldEvent> ToldEvents(const WorldDescription& world, const std::vector<Event>& events) {
  std::vector<ToldEvent> told;
  std::map<EventType, std::size_t> agents;
  std::map<EventType, std::size_t> robots;  // of the other agents
  for (std::size_t begin = 0, end = 0; begin < events.size(); begin = end) {
    const Event& event = events[begin];
    const bool of_agent = event.type == EventType::kJoined || event.type == EventType::kLeft;
    for (end = begin + 1; of_agent && end < events.size(); ++end) {
      const Event& next = events[end];
      if (next.type != event.type || next.tick != event.tick || next.detail != event.detail) break;
    }
    if (of_agent && ++agents[event.type] > kAgentsTold) {
      robots[event.type] += end - begin;
    } else if (end == begin + 1) {
      told.push_back({event, EventText(world, event)});
    } else {
      std::vector<RobotId> ids;
      for (std::size_t i = begin; i < end; ++i) ids.push_back(*events[i].robot);
      told.push_back({event, "tick " + std::to_string(event.tick) + ": " + ListNames(world, ids) +
                                 (event.type == EventType::kJoined ? " have an agent (" : " have lost their agent (") +
                                 event.detail + ")"});
    }
  }
  for (const auto& [type, count] : robots) {
    const Tick tick = events.back().tick;
    told.push_back({{.tick = tick, .type = type},
                    "tick " + std::to_string(tick) + ": " + std::to_string(count) + " more robots have " +
                        (type == EventType::kJoined ? "agents" : "lost their agents")});
  }
  return told;
}

nlohmann::json EventJson(const WorldDescription& world, const Event& event) {
  nlohmann::json json = {{"event", NameOf(event.type)}};
  if (event.robot) json["robot"] = world.robot(*event.robot).name;
  if (event.object) json["object"] = world.model(*event.object).name;
  if (event.other) json["other"] = world.model(*event.other).name;
  return json;
}

std::string EventLine(const WorldDescription& world, const Event& event) {
  nlohmann::json json = EventJson(world, event);
  json["tick"] = event.tick;
  json["detail"] = event.detail;
  return JsonText(json);
}

}  // namespace troupe
