#include "robot-agent/controller/vehicle_zones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/point_distance.h"
#include "fleet/vehicle_zones.h"
#include "robot-agent/controller/vehicle_readings.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kStepOnWay = 0.05;      // m, between the points of the way that are looked at
constexpr double kZoneMargin = 0.1;      // m, between a vehicle that waits and the zone
constexpr double kRequestAhead = 5.0;    // m of the way to a zone, from which it asks
constexpr double kLeaveMargin = 0.05;    // m, from a zone that it has left
constexpr double kStraight = 0.2;        // the tangent of the angle between a line and the direction of a zone
constexpr double kFirstLeg = 0.6;        // m: a shorter way back to its line says nothing about the line
constexpr std::int64_t kRefused = 5000;  // ms, until it asks again

Polygon OutlineOf(const fleet::Zone& zone) {
  Polygon outline;
  for (const fleet::ZoneVertex& vertex : zone.vertices) outline.push_back({vertex.x, vertex.y});
  return outline;
}

bool Touches(const Polygon& outline, const Rectangle& box, double radius, const Vec2& p) {
  const bool is_near = p.x() >= box.min_x - radius && p.x() <= box.max_x + radius && p.y() >= box.min_y - radius &&
                       p.y() <= box.max_y + radius;
  return is_near && (Contains(outline, p) || (radius > 0.0 && DistanceToEdges(outline, p) <= radius));
}

// m along the way to the first place on one of its legs where the circle touches the zone; nothing: it does not.
// `counts`: whether leg i, which ends at point i + 1, is looked at.
template <typename Counts>
std::optional<double> EntryOf(const Polygon& outline, double radius, const VehicleWay* way, const Counts& counts) {
  if (way == nullptr) return std::nullopt;
  const Rectangle box = BoundingBox(outline);
  double before = 0.0;
  for (std::size_t i = 0; i + 1 < way->points.size(); ++i) {
    const Vec2& from = way->points[i].place;
    const Vec2 leg = way->points[i + 1].place - from;
    const double length = leg.norm();
    const auto steps = counts(i, leg) ? static_cast<std::size_t>(std::ceil(length / kStepOnWay)) + 1 : 0;
    for (std::size_t step = 0; step < steps; ++step) {
      const double along = std::min(kStepOnWay * static_cast<double>(step), length);
      const Vec2 p = length > 0.0 ? Vec2(from + along / length * leg) : from;
      if (Touches(outline, box, radius, p)) return before + along;
    }
    before += length;
  }
  return std::nullopt;
}

std::optional<double> EntryOf(const Polygon& outline, double radius, const VehicleWay* way) {
  return EntryOf(outline, radius, way, [](std::size_t, const Vec2&) { return true; });
}

bool IsIn(const Polygon& outline, double radius, const Vec2& p) {
  return Touches(outline, BoundingBox(outline), radius, p);
}

// Whether a DIRECTED or BIDIRECTED zone lets a vehicle drive along a line with that direction.
bool LetsDrive(const fleet::Zone& zone, const Vec2& direction) {
  const bool is_directed = zone.type == fleet::ZoneType::kDirected;
  const fleet::DirectionLimit limit =
      (is_directed ? zone.directed_limitation : zone.bidirected_limitation).value_or(fleet::DirectionLimit::kSoft);
  if (limit == fleet::DirectionLimit::kSoft) return true;
  const SinCosResult turn = SinCos(zone.direction.value_or(0.0));
  const double along = turn.cos * direction.x() + turn.sin * direction.y();
  const double across = std::fabs(turn.cos * direction.y() - turn.sin * direction.x());
  if (!is_directed) return across <= kStraight * std::fabs(along);
  return limit == fleet::DirectionLimit::kRestricted ? along >= 0.0 : across <= kStraight * along;
}

// m along the way to where its centre would drive in a direction that the zone does not allow. Trajectories of the
// order come before the zone.
std::optional<double> WrongWayIn(const fleet::Zone& zone, const Polygon& outline, const VehicleWay* way) {
  return EntryOf(outline, 0.0, way, [&](std::size_t leg, const Vec2& line) {
    const double length = line.norm();
    return length > 0.0 && (leg > 0 || length >= kFirstLeg) && !way->points[leg + 1].is_traced &&
           !LetsDrive(zone, line);
  });
}

fleet::VehicleError ErrorOf(const char* type, fleet::ErrorLevel level, const std::string& description,
                            const std::string& zone) {
  fleet::VehicleError error;
  error.type = type;
  error.level = level;
  error.description = description;
  error.references = {{{"zoneId", zone}}};
  return error;
}

void StandBefore(double entry, VehicleZones::Limit& limit) {
  const double room = std::max(entry - kZoneMargin, 0.0);
  limit.room = std::min(limit.room.value_or(room), room);
}

// Once when it begins, and when it ends.
void Report(bool is_so, bool& is_told, const fleet::VehicleError& error, VehicleZones::Limit& limit) {
  if (std::exchange(is_told, is_so) == is_so) return;
  if (is_so) {
    limit.inputs.emplace_back(fleet::ErrorRaised{error});
  } else {
    limit.inputs.emplace_back(fleet::ErrorCleared{error.type});
  }
}

bool HasLost(const fleet::AccessRequest* request) {
  return request != nullptr && (request->request.status == fleet::RequestStatus::kRevoked ||
                                request->request.status == fleet::RequestStatus::kExpired);
}

}  // namespace

struct VehicleZones::Meeting {
  const fleet::Zone& zone;
  const std::string& set;
  std::string key;  // "SET/ZONE"
  const VehicleWay* way = nullptr;
  bool keeps = false;  // it does not look ahead now, and may go on later
  bool is_inside = false;
  std::optional<double> entry = {};  // m along the way; nothing: it is not on it
};

struct VehicleZones::Sight {
  const fleet::Zone* inside = nullptr;  // blocked
  const fleet::Zone* ahead = nullptr;   // behind whose border it may not drive on
  std::string ahead_key = {};
  const fleet::Zone* lost = nullptr;  // a release
  std::string lost_path = {};
  bool holds_unreachable = false;                // that zone is enabled still
  std::vector<fleet::ZoneEntered> touched = {};  // ACTION zones
};

// RELEASE and COORDINATED_REPLANNING: they may be entered with a grant only.
void VehicleZones::Enter(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, Sight& sight,
                         Limit& limit) {
  const bool is_of_path = meeting.zone.type == fleet::ZoneType::kCoordinatedReplanning;
  const bool is_near = meeting.is_inside || (meeting.entry && *meeting.entry <= kRequestAhead);
  const bool is_wanted = is_near && (!is_of_path || meeting.way != nullptr);
  const fleet::AccessRequest* const request = fleet::FindRequest(memory, meeting.set, meeting.zone.id);
  const bool has_lost = HasLost(request);
  bool is_granted = false;
  if (request == nullptr) {
    const auto refused = refused_until_.find(meeting.key);
    const bool may_ask = refused == refused_until_.end() || place.now_ms >= refused->second;
    fleet::AccessWanted wanted{meeting.set, meeting.zone.id};
    if (is_of_path && meeting.way != nullptr) wanted.path = TrajectoryOf(*meeting.way);
    if (is_wanted && may_ask) limit.inputs.emplace_back(std::move(wanted));
  } else {
    const std::string& id = request->request.id;
    is_granted = request->request.status == fleet::RequestStatus::kGranted;
    const std::optional<std::int64_t> lease =
        is_granted && request->lease_expiry ? fleet::ParseTimestamp(*request->lease_expiry) : std::nullopt;
    if (lease && *lease <= place.now_ms) {
      is_granted = false;
      limit.inputs.emplace_back(fleet::LeaseEnded{id});
    } else if ((!meeting.is_inside && ((!is_near && !meeting.keeps) || has_lost)) || (is_of_path && has_lost)) {
      limit.inputs.emplace_back(fleet::AccessEnded{id});
      if (has_lost) refused_until_[meeting.key] = place.now_ms + kRefused;
    }
  }
  if (meeting.is_inside && has_lost && !is_of_path) sight.lost = &meeting.zone;
  if (meeting.is_inside && is_of_path && (has_lost || (meeting.key == lost_path_ && !is_granted))) {
    sight.lost_path = meeting.key;
  }
  if (is_granted) return;
  const bool stops =
      is_of_path || meeting.zone.release_loss_behavior.value_or(fleet::ZoneLoss::kStop) == fleet::ZoneLoss::kStop;
  if (!meeting.is_inside && meeting.entry) StandBefore(*meeting.entry, limit);
  if (meeting.is_inside && stops) limit.room = 0.0;
}

void VehicleZones::Heed(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, Sight& sight,
                        Limit& limit) {
  const auto stand = [&](const std::optional<double>& entry) {
    if (!entry) return;
    StandBefore(*entry, limit);
    if (*entry > 2.0 * kZoneMargin || sight.ahead != nullptr) return;
    sight.ahead = &meeting.zone;
    sight.ahead_key = meeting.key;
  };
  switch (meeting.zone.type) {
    case fleet::ZoneType::kBlocked:
      if (meeting.is_inside) {
        sight.inside = &meeting.zone;
      } else {
        stand(meeting.entry);
      }
      return;
    case fleet::ZoneType::kRelease:
    case fleet::ZoneType::kCoordinatedReplanning:
      return Enter(memory, place, meeting, sight, limit);
    case fleet::ZoneType::kSpeedLimit: {
      const double most = meeting.zone.maximum_speed.value_or(std::numeric_limits<double>::infinity());
      if (meeting.is_inside) limit.speed = std::min(limit.speed, most);
      if (meeting.entry) {
        const double room = std::max(*meeting.entry - kZoneMargin, 0.0);
        limit.speed = std::min(limit.speed, std::sqrt(most * most + 2.0 * place.braking * room));
      }
      return;
    }
    case fleet::ZoneType::kAction:
      if (meeting.is_inside) sight.touched.push_back({meeting.set, meeting.zone.id});
      return;
    case fleet::ZoneType::kDirected:
    case fleet::ZoneType::kBidirected:
      return stand(WrongWayIn(meeting.zone, OutlineOf(meeting.zone), meeting.way));
    case fleet::ZoneType::kLineGuided:  // it drives on lines always
    case fleet::ZoneType::kPriority:    // about the choice of a way, as the next one
    case fleet::ZoneType::kPenalty:
      return;
  }
}

void VehicleZones::TellUnreachable(const fleet::VehicleMemory& memory, const Sight& sight, Limit& limit) {
  constexpr char kType[] = "NODE_UNREACHABLE";
  if (unreachable_) {
    const bool holds = sight.holds_unreachable && !memory.nodes.empty() &&
                       memory.nodes.front().sequence_id == unreachable_->sequence_id &&
                       memory.order_id == unreachable_->order_id &&
                       memory.order_update_id == unreachable_->order_update_id;
    if (holds) return;
    unreachable_.reset();
    limit.inputs.emplace_back(fleet::ErrorCleared{kType});
  }
  if (sight.ahead == nullptr || memory.nodes.empty()) return;
  const fleet::Node& node = memory.nodes.front();
  unreachable_ = Unreachable{sight.ahead_key, memory.order_id, memory.order_update_id, node.sequence_id};
  const bool is_blocked = sight.ahead->type == fleet::ZoneType::kBlocked;
  fleet::VehicleError error = ErrorOf(kType, fleet::ErrorLevel::kCritical,
                                      is_blocked ? "the blocked zone " + sight.ahead->id + " is on the way"
                                                 : "the zone " + sight.ahead->id + " allows no way in this direction",
                                      sight.ahead->id);
  error.references->insert(error.references->begin(), {"nodeId", node.id});
  limit.inputs.emplace_back(fleet::ErrorRaised{error});
}

VehicleZones::Limit VehicleZones::Look(const fleet::VehicleMemory& memory, const Place& place, const VehicleWay* way) {
  Limit limit;
  Sight sight;
  for (const fleet::StoredZoneSet& stored : memory.zone_sets) {
    if (stored.status != fleet::StoredStatus::kEnabled || stored.set.map_id != place.map) continue;
    const std::string& set = stored.set.zone_set_id;
    for (const fleet::Zone& zone : stored.set.zones) {
      const Polygon outline = OutlineOf(zone);
      const bool was_inside = std::any_of(
          memory.zones_inside.begin(), memory.zones_inside.end(),
          [&](const fleet::EnteredZone& each) { return each.zone_set_id == set && each.zone_id == zone.id; });
      Meeting meeting{.zone = zone, .set = set, .key = set + "/" + zone.id, .way = way};
      meeting.keeps = way == nullptr && !memory.nodes.empty();
      meeting.is_inside = IsIn(outline, place.radius + (was_inside ? kLeaveMargin : 0.0), place.at);
      meeting.entry = EntryOf(outline, place.radius, way);
      sight.holds_unreachable = sight.holds_unreachable || (unreachable_ && unreachable_->zone == meeting.key);
      Heed(memory, place, meeting, sight, limit);
    }
  }
  for (const fleet::EnteredZone& zone : memory.zones_inside) {
    const bool is_inside = std::any_of(sight.touched.begin(), sight.touched.end(), [&](const fleet::ZoneEntered& each) {
      return each.zone_set_id == zone.zone_set_id && each.zone_id == zone.zone_id;
    });
    if (!is_inside) limit.inputs.emplace_back(fleet::ZoneLeft{zone.zone_set_id, zone.zone_id});
  }
  for (fleet::ZoneEntered& zone : sight.touched) limit.inputs.emplace_back(std::move(zone));  // known ones: no effect
  TellUnreachable(memory, sight, limit);
  lost_path_ = sight.lost_path;
  const auto name = [](const fleet::Zone* zone) { return zone != nullptr ? zone->id : std::string(); };
  Report(sight.inside != nullptr, has_told_inside_,
         ErrorOf("BLOCKED_ZONE_VIOLATION", fleet::ErrorLevel::kCritical,
                 "the vehicle is in the blocked zone " + name(sight.inside), name(sight.inside)),
         limit);
  const bool stops = sight.lost != nullptr &&
                     sight.lost->release_loss_behavior.value_or(fleet::ZoneLoss::kStop) == fleet::ZoneLoss::kStop;
  Report(sight.lost != nullptr, has_told_lost_,
         ErrorOf("RELEASE_LOST", stops ? fleet::ErrorLevel::kCritical : fleet::ErrorLevel::kWarning,
                 "the vehicle is in the zone " + name(sight.lost) + " without a release", name(sight.lost)),
         limit);
  const std::string path_zone = lost_path_.substr(lost_path_.rfind('/') + 1);
  Report(!lost_path_.empty(), has_told_path_,
         ErrorOf("PATH_GRANT_LOST", fleet::ErrorLevel::kWarning,
                 "the vehicle is in the zone " + path_zone + " without a granted path", path_zone),
         limit);
  return limit;
}

}  // namespace troupe
