#include "robot-agent/controller/site_controls.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe {
namespace {

constexpr double kOpen = 0.999;  // of a door

template <typename Info>
std::map<std::string, std::size_t> NumbersOf(const std::vector<Info>& infos) {
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < infos.size(); ++i) numbers.emplace(infos[i].name, i);
  return numbers;
}

std::optional<std::size_t> FindIn(const std::map<std::string, std::size_t>& numbers, const std::string& name) {
  const auto found = numbers.find(name);
  return found == numbers.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

SiteControls::SiteControls(const RobotInfo& info, std::shared_ptr<const LaneGraph> graph)
    : id_(info.id),
      graph_(std::move(graph)),
      door_infos_(info.doors),
      lift_infos_(info.lifts),
      doors_(NumbersOf(info.doors)),
      lifts_(NumbersOf(info.lifts)) {}

void SiteControls::Begin(const Observation& observation, Command& command) {
  now_ = &observation;
  command_ = &command;
}

std::optional<std::size_t> SiteControls::LiftOf(std::size_t vertex) const {
  return FindIn(lifts_, graph_->vertices[vertex].lift);
}

bool SiteControls::CallLift(std::size_t vertex) {
  const std::optional<std::size_t> lift = LiftOf(vertex);
  if (!lift) return true;
  const std::vector<std::string>& floors = lift_infos_[*lift].floors;
  const auto floor = std::find(floors.begin(), floors.end(), graph_->vertices[vertex].floor);
  if (floor == floors.end()) return true;
  const std::optional<RobotId>& session = now_->lifts[*lift].session;
  if (session && *session != id_) return false;
  command_->lifts.push_back({*lift, static_cast<std::size_t>(floor - floors.begin())});
  return session.has_value();
}

bool SiteControls::StandsOpenAt(std::size_t vertex) const {
  const std::optional<std::size_t> lift = LiftOf(vertex);
  if (!lift) return true;
  const LaneVertex& place = graph_->vertices[vertex];
  const LiftState& state = now_->lifts[*lift];
  const std::vector<std::string>& floors = lift_infos_[*lift].floors;
  if (state.floor >= floors.size() || floors[state.floor] != place.floor) return false;
  if (std::fabs(state.z - place.z) > 1e-6) return false;
  return std::all_of(place.lift_doors.begin(), place.lift_doors.end(), [&](const std::string& name) {
    const std::optional<std::size_t> door = FindIn(doors_, name);
    return !door || now_->doors[*door].opening >= kOpen;
  });
}

void SiteControls::EndSessions(const std::vector<std::size_t>& needed) {
  for (std::size_t i = 0; i < now_->lifts.size(); ++i) {
    if (now_->lifts[i].session != id_) continue;
    if (std::any_of(needed.begin(), needed.end(), [&](std::size_t vertex) { return LiftOf(vertex) == i; })) continue;
    std::erase_if(command_->lifts, [&](const LiftCommand& call) { return call.lift == i; });
    command_->lifts.push_back({i, 0, true});
  }
}

bool SiteControls::OpenDoor(const LaneDoor& door) {
  const std::optional<std::size_t> number = FindIn(doors_, door.name);
  if (!number) return true;
  command_->doors.push_back({*number, 1.0});
  return now_->doors[*number].opening >= kOpen;
}

bool SiteControls::IsBlocked(const LaneDoor& door) const {
  const std::optional<std::size_t> number = FindIn(doors_, door.name);
  return number && now_->doors[*number].blocked;
}

void SiteControls::Note(const Lane& lane) {
  for (const LaneDoor& door : lane.doors) {
    const std::optional<std::size_t> number = FindIn(doors_, door.name);
    const bool is_known = std::any_of(passing_.begin(), passing_.end(),
                                      [&](const Passing& passing) { return passing.door.name == door.name; });
    if (number && !is_known) passing_.push_back({door, *number});
  }
}

void SiteControls::CloseBehind(const Vec2& position, double radius, const std::vector<SeenRobot>& others) {
  for (Passing& passing : passing_) {
    const DoorInfo& place = door_infos_[passing.number];
    const double distance = (place.middle - position).norm();
    if (distance < radius + kDoorMargin) passing.is_through = true;
    if (!passing.is_through || distance < passing.door.clearance + radius + kDoorMargin) continue;
    const bool is_used = std::any_of(others.begin(), others.end(), [&](const SeenRobot& other) {
      return std::fabs(other.z - place.z) < kLevelGap &&
             (other.position - place.middle).norm() < passing.door.clearance + other.radius + kDoorMargin;
    });
    if (is_used) continue;  // it stays open until that is gone, too
    command_->doors.push_back({passing.number, 0.0});
    passing.is_done = true;
  }
  std::erase_if(passing_, [](const Passing& passing) { return passing.is_done; });
}

}  // namespace troupe
