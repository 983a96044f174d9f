#include "robot-agent/controller/vehicle_zones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/point_distance.h"
#include "fleet/vehicle_zones.h"

namespace troupe {
namespace {

constexpr double kStepOnWay = 0.05;      // m, between the points of the way that are looked at
constexpr double kZoneMargin = 0.1;      // m, between a vehicle that waits and the zone
constexpr double kRequestAhead = 5.0;    // m of the way to a zone, from which it asks
constexpr std::int64_t kRefused = 5000;  // ms, until it asks again

Polygon OutlineOf(const fleet::Zone& zone) {
  Polygon outline;
  for (const fleet::ZoneVertex& vertex : zone.vertices) outline.push_back({vertex.x, vertex.y});
  return outline;
}

// m along the way to the first place where the circle touches the zone; nothing: it does not.
std::optional<double> EntryOf(const Polygon& outline, double radius, const VehicleWay* way) {
  if (way == nullptr) return std::nullopt;
  Rectangle box = BoundingBox(outline);
  double before = 0.0;
  for (std::size_t i = 0; i + 1 < way->points.size(); ++i) {
    const Vec2& from = way->points[i].place;
    const Vec2 leg = way->points[i + 1].place - from;
    const double length = leg.norm();
    const auto steps = static_cast<std::size_t>(std::ceil(length / kStepOnWay));
    for (std::size_t step = 0; step <= steps; ++step) {
      const double along = std::min(kStepOnWay * static_cast<double>(step), length);
      const Vec2 p = length > 0.0 ? Vec2(from + along / length * leg) : from;
      const bool is_near = p.x() >= box.min_x - radius && p.x() <= box.max_x + radius && p.y() >= box.min_y - radius &&
                           p.y() <= box.max_y + radius;
      if (is_near && (Contains(outline, p) || DistanceToEdges(outline, p) <= radius)) return before + along;
    }
    before += length;
  }
  return std::nullopt;
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

}  // namespace

struct VehicleZones::Meeting {
  const fleet::Zone& zone;
  const std::string& set;
  bool is_inside = false;
  std::optional<double> entry = {};  // m along the way; nothing: it is not on it
};

// `keeps`: it does not look ahead now, and may go on later.
void VehicleZones::Enter(const fleet::VehicleMemory& memory, const Place& place, const Meeting& meeting, bool keeps,
                         Limit& limit) {
  const std::string key = meeting.set + "/" + meeting.zone.id;
  const bool is_wanted = meeting.is_inside || (meeting.entry && *meeting.entry <= kRequestAhead);
  const fleet::AccessRequest* const request = fleet::FindRequest(memory, meeting.set, meeting.zone.id);
  bool is_granted = false;
  if (request == nullptr) {
    const auto refused = refused_until_.find(key);
    const bool may_ask = refused == refused_until_.end() || place.now_ms >= refused->second;
    if (is_wanted && may_ask) limit.inputs.emplace_back(fleet::AccessWanted{meeting.set, meeting.zone.id});
  } else {
    const std::string& id = request->request.id;
    is_granted = request->request.status == fleet::RequestStatus::kGranted;
    const bool has_lost = request->request.status == fleet::RequestStatus::kRevoked ||
                          request->request.status == fleet::RequestStatus::kExpired;
    const std::optional<std::int64_t> lease =
        is_granted && request->lease_expiry ? fleet::ParseTimestamp(*request->lease_expiry) : std::nullopt;
    if (lease && *lease <= place.now_ms) {
      is_granted = false;
      limit.inputs.emplace_back(fleet::LeaseEnded{id});
    } else if (!meeting.is_inside && ((!is_wanted && !keeps) || has_lost)) {
      limit.inputs.emplace_back(fleet::AccessEnded{id});
      if (has_lost) refused_until_[key] = place.now_ms + kRefused;
    }
  }
  if (is_granted) return;
  const bool stops = meeting.zone.release_loss_behavior.value_or(fleet::ZoneLoss::kStop) == fleet::ZoneLoss::kStop;
  if (!meeting.is_inside && meeting.entry) StandBefore(*meeting.entry, limit);
  if (meeting.is_inside && stops) limit.room = 0.0;
}

VehicleZones::Limit VehicleZones::Look(const fleet::VehicleMemory& memory, const Place& place, const VehicleWay* way) {
  Limit limit;
  const VehicleWay here{{{place.at, false, {}}, {place.at, false, {}}}};
  const bool keeps = way == nullptr && !memory.nodes.empty();
  const fleet::Zone* inside = nullptr;
  const fleet::Zone* ahead = nullptr;
  const fleet::Zone* lost = nullptr;
  for (const fleet::StoredZoneSet& stored : memory.zone_sets) {
    if (stored.status != fleet::StoredStatus::kEnabled || stored.set.map_id != place.map) continue;
    for (const fleet::Zone& zone : stored.set.zones) {
      const Polygon outline = OutlineOf(zone);
      const Meeting meeting{zone, stored.set.zone_set_id, EntryOf(outline, place.radius, &here).has_value(),
                            EntryOf(outline, place.radius, way)};
      switch (zone.type) {
        case fleet::ZoneType::kBlocked:
          if (meeting.is_inside) {
            inside = &zone;
          } else if (meeting.entry) {
            StandBefore(*meeting.entry, limit);
            if (*meeting.entry <= 2.0 * kZoneMargin) ahead = &zone;
          }
          break;
        case fleet::ZoneType::kRelease: {
          const fleet::AccessRequest* const request = fleet::FindRequest(memory, meeting.set, zone.id);
          if (meeting.is_inside && request != nullptr &&
              (request->request.status == fleet::RequestStatus::kRevoked ||
               request->request.status == fleet::RequestStatus::kExpired)) {
            lost = &zone;
          }
          Enter(memory, place, meeting, keeps, limit);
          break;
        }
        case fleet::ZoneType::kSpeedLimit: {
          const double most = zone.maximum_speed.value_or(std::numeric_limits<double>::infinity());
          if (meeting.is_inside) limit.speed = std::min(limit.speed, most);
          if (meeting.entry) {
            const double room = std::max(*meeting.entry - kZoneMargin, 0.0);
            limit.speed = std::min(limit.speed, std::sqrt(most * most + 2.0 * place.braking * room));
          }
          break;
        }
        default:
          break;  // about the choice of a way
      }
    }
  }
  const auto name = [](const fleet::Zone* zone) { return zone != nullptr ? zone->id : std::string(); };
  Report(inside != nullptr, has_told_inside_,
         ErrorOf("BLOCKED_ZONE_VIOLATION", fleet::ErrorLevel::kCritical,
                 "the vehicle is in the blocked zone " + name(inside), name(inside)),
         limit);
  Report(ahead != nullptr, has_told_ahead_,
         ErrorOf("NODE_UNREACHABLE", fleet::ErrorLevel::kWarning, "the blocked zone " + name(ahead) + " is on the way",
                 name(ahead)),
         limit);
  const bool stops =
      lost != nullptr && lost->release_loss_behavior.value_or(fleet::ZoneLoss::kStop) == fleet::ZoneLoss::kStop;
  Report(lost != nullptr, has_told_lost_,
         ErrorOf("RELEASE_LOST", stops ? fleet::ErrorLevel::kCritical : fleet::ErrorLevel::kWarning,
                 "the vehicle is in the zone " + name(lost) + " without a release", name(lost)),
         limit);
  return limit;
}

}  // namespace troupe
