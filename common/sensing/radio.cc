// The radio: which messages arrive, and how strong. Strength falls by the log-distance model, 10 n log10(d) below the
// strength at 1 m, and by a loss for each wall and each body on the straight line. A message is received within its
// range if its strength is at least that at its range in free space.
//
// Messages are a part of the state until they are due; each receiver decides by itself, from the state, so that no
// process has to tell another one who hears whom. Draws have keys of both radios, tick and number: the result does not
// depend on the order of receivers.
//
// Cost: most of a swarm's messages are out of range, then clear or too weak: exact counts of obstacles are the rare
// last step.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
#include "common/spatial/column_cast.h"
#include "common/spatial/ray_cast.h"
#include "troupe/deterministic_math.h"
#include "troupe/radio_limits.h"
#include "troupe/random.h"
#include "troupe/vec2.h"

namespace troupe {
namespace {

// The bodies between two antennas: the straight line between them crosses their volume.

struct RadioObstacles {
  // Stretches of the line inside of static bodies. Stretches with less than kWallGap between them are one wall, so that
  // the pixels of a slanted wall count once.
  std::size_t walls = 0;
  std::size_t bodies = 0;  // robots and objects
};
constexpr double kWallGap = 0.05;  // m

// An antenna of a robot, in W.
struct Antenna {
  RobotId robot;
  Vec2 at{0.0, 0.0};  // m
  double z = 0.0;     // m
};

// A part of the line between two antennas: m from the receiver, along the line's foot.
struct LinePart {
  double enter;
  double leave;
};

// The part of the line that is in an obstacle.
struct ObstacleOnLine {
  LinePart part;
  std::optional<BodyId> body;  // nothing: static
};

// A message on its way from an antenna, as strong as without obstacles.
struct RadioSignal {
  Antenna from;
  const RadioParameters* sender = nullptr;  // never null
  double clear = 0.0;                       // dBm
  double weakest = 0.0;                     // dBm, of messages that are received

  double LossBy(const RadioObstacles& obstacles) const {
    return sender->wall_loss * static_cast<double>(obstacles.walls) +
           sender->body_loss * static_cast<double>(obstacles.bodies);
  }
  bool Passes(const RadioObstacles& obstacles) const {
    const double loss = LossBy(obstacles);
    return loss == 0.0 || clear - loss >= weakest;
  }
};

// The lines from one antenna to the senders of signals on other robots. A line ends where it enters the other robot;
// bodies of its own robot, objects that either robot holds, and bodies that rangers do not see do not count; on a
// vertical line none does.
class RadioPaths {
 public:
  // REQUIRES: the world stays as it is; `signals` outlive the paths.
  RadioPaths(const SensedWorld& world, const Antenna& to, std::span<const RadioSignal> signals);

  // The strength of signal i behind all its obstacles, dBm; nothing if it is too weak.
  std::optional<double> StrengthOf(std::size_t i);

 private:
  RadioObstacles CountObstacles(const Antenna& from);

  const SensedWorld& world_;
  Antenna to_;
  std::span<const RadioSignal> signals_;
  std::vector<RadioObstacles> first_;  // by signal: obstacles that it has at the least; all, if it has none
  std::vector<bool> is_clear_;         // by signal: it surely has no obstacle
  std::optional<ColumnCaster> caster_;
  // The cuts of one line; a member so that their memory is used again.
  std::vector<ColumnCut> cuts_;
  std::vector<ObstacleOnLine> obstacles_;
  std::vector<LinePart> walls_;
  std::vector<BodyId> bodies_;
};

// The part of a line that climbs by `slope` m for each m, from height `z`, within a cut.
std::optional<LinePart> PartIn(const ColumnCut& cut, double z, double slope, double length) {
  LinePart part{cut.enter, std::min(cut.leave, length)};
  if (slope == 0.0) {
    if (!cut.z.Contains(z)) return std::nullopt;
  } else {
    const double at_min = (cut.z.min - z) / slope;
    const double at_max = (cut.z.max - z) / slope;
    part.enter = std::max(part.enter, std::min(at_min, at_max));
    part.leave = std::min(part.leave, std::max(at_min, at_max));
  }
  if (!(part.leave - part.enter > kTouchTolerance)) return std::nullopt;
  return part;
}

std::size_t CountWalls(std::vector<LinePart>& parts) {
  std::sort(parts.begin(), parts.end(), [](const LinePart& a, const LinePart& b) { return a.enter < b.enter; });
  std::size_t walls = 0;
  double end = -std::numeric_limits<double>::infinity();
  for (const LinePart& part : parts) {
    // From minus infinity: the first part is always a wall.
    if (part.enter - end >= kWallGap) ++walls;
    end = std::max(end, part.leave);
  }
  return walls;
}

// Horizontal rays are cast all together. Nearly all lines are clear, or of no use beyond their first obstacle.
RadioPaths::RadioPaths(const SensedWorld& world, const Antenna& to, std::span<const RadioSignal> signals)
    : world_(world), to_(to), signals_(signals), first_(signals.size()), is_clear_(signals.size(), false) {
  std::vector<Ray> rays;
  std::vector<std::size_t> signal_of_ray;
  rays.reserve(signals.size());
  signal_of_ray.reserve(signals.size());
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Antenna& from = signals[i].from;
    const Vec2 way = from.at - to.at;
    const double length = std::sqrt(way.squaredNorm());
    const bool ignores_obstacles = signals[i].sender->wall_loss == 0.0 && signals[i].sender->body_loss == 0.0;
    if (!(length > kTouchTolerance) || ignores_obstacles) {
      is_clear_[i] = true;
    } else if (from.z == to.z) {
      rays.push_back({to.at, way / length, to.z, length});
      signal_of_ray.push_back(i);
    }
  }
  std::vector<std::optional<RayHit>> hits;
  CastRays(world.scene, world.bodies, rays, to.robot, hits);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t i = signal_of_ray[k];
    const std::optional<BodyId> body = hits[k] ? world.scene.body_of(hits[k]->model) : std::nullopt;
    // A ray that meets nothing, or the sender's robot first, is clear.
    if (!hits[k] || (body && world.bodies.owner(*body) == signals[i].from.robot)) {
      is_clear_[i] = true;
    } else if (!body) {
      // A lower bound: at least one wall. If already that is too much, the exact count is spared.
      first_[i].walls = 1;
    } else {
      first_[i].bodies = 1;
    }
  }
}

std::optional<double> RadioPaths::StrengthOf(std::size_t i) {
  const RadioSignal& signal = signals_[i];
  if (is_clear_[i]) return signal.clear;
  if (!signal.Passes(first_[i])) return std::nullopt;
  const RadioObstacles obstacles = CountObstacles(signal.from);
  if (!signal.Passes(obstacles)) return std::nullopt;
  return signal.clear - signal.LossBy(obstacles);
}

RadioObstacles RadioPaths::CountObstacles(const Antenna& from) {
  const Vec2 way = from.at - to_.at;
  const double length = std::sqrt(way.squaredNorm());
  if (!caster_) {
    double reach = 0.0;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      if (is_clear_[i] || !signals_[i].Passes(first_[i])) continue;
      reach = std::max(reach, std::sqrt((signals_[i].from.at - to_.at).squaredNorm()));
    }
    caster_.emplace(world_.scene, world_.bodies, to_.at, reach, to_.robot, Sight::kRangers);
  }
  caster_->Cut(way / length, {std::min(to_.z, from.z), std::max(to_.z, from.z)}, length, cuts_);
  const double slope = (from.z - to_.z) / length;
  obstacles_.clear();
  double end = length;
  for (const ColumnCut& cut : cuts_) {
    if (cut.enter >= length) break;
    const std::optional<LinePart> part = PartIn(cut, to_.z, slope, length);
    if (!part) continue;
    const std::optional<BodyId> body = world_.scene.body_of(cut.model);
    if (body && world_.bodies.owner(*body) == from.robot) {
      // Behind the surface of the sender's robot nothing counts: its own body does not shield it.
      end = std::min(end, part->enter);
    } else {
      obstacles_.push_back({*part, body});
    }
  }
  walls_.clear();
  bodies_.clear();
  for (const ObstacleOnLine& obstacle : obstacles_) {
    if (!(std::min(obstacle.part.leave, end) - obstacle.part.enter > kTouchTolerance)) continue;
    if (obstacle.body) {
      bodies_.push_back(*obstacle.body);
    } else {
      walls_.push_back(obstacle.part);
    }
  }
  std::sort(bodies_.begin(), bodies_.end());
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
  return {CountWalls(walls_), bodies_.size()};
}

constexpr std::uint64_t kRadioStream = 0x726164696f;  // "radio"

// Room reserved for the messages within range.
constexpr std::size_t kUsualSignals = 32;

enum class RadioDraw : std::uint64_t { kLoss = 0, kRange = 1, kBearing = 2 };

class Radio final : public Sensor {
 public:
  explicit Radio(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("received").BeginList();
    for (const RadioReception& reception : std::get<RadioReading>(reading.content).receptions) {
      json.BeginObject().Member("from", world.robot(reception.from).name).Member("to_all", reception.to_all);
      json.Member("bytes", ToHexadecimal(std::as_bytes(std::span(reception.bytes))));
      json.Member("rssi", reception.rssi).Member("tick", reception.tick);
      if (const auto& place = reception.place) {
        json.Member("range", place->range).Member("bearing", place->bearing).Member("elevation", place->elevation);
      }
      json.EndObject();
    }
    json.EndList().EndObject();
    return line + "\n";
  }

  void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const override {
    const Pose X_WS = world.bodies.X_WM(description().model) * parameters().X_MS;
    marks.push_back(SectorMark(X_WS, 2.0 * kPi, parameters().range));
    for (const RadioReception& reception : std::get<RadioReading>(reading.content).receptions) {
      const Vec2 from = world.bodies.X_WB(world.scene.body_of(reception.from)).translation();
      marks.push_back({MarkShape::kLine, MarkRole::kFound, X_WS.z, {X_WS.translation(), from}});
    }
  }

 private:
  const RadioParameters& parameters() const { return std::get<RadioParameters>(description().parameters); }

  // A message that arrives unless there is too much in its way.
  struct Candidate {
    const RadioTransmission* transmission;
    const RadioParameters* sender;
    Pose X_WT;        // of the sender's antenna
    double distance;  // m
  };

  // The strength at its range of one radio after another: most are alike.
  class WeakestStrength {
   public:
    double Of(const RadioParameters& radio) {
      if (radio.range != range_ || radio.power != power_ || radio.path_loss_exponent != exponent_) {
        range_ = radio.range;
        power_ = radio.power;
        exponent_ = radio.path_loss_exponent;
        strength_ = RadioStrength(radio, radio.range, 0.0);
      }
      return strength_;
    }

   private:
    double range_ = -1.0;
    double power_ = 0.0;
    double exponent_ = 0.0;
    double strength_ = 0.0;
  };

  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    reading.tick = tick;
    RadioReading& content = ContentOf<RadioReading>(reading);
    content.X_RS = MountAt(world) * parameters().X_MS;
    content.range = parameters().range;
    content.receptions.clear();
    if (world.state == nullptr || world.state->transmissions.empty()) return;
    const Pose X_WS = world.bodies.X_WM(description().model) * parameters().X_MS;
    std::vector<Candidate> candidates;
    std::vector<RadioSignal> signals;
    candidates.reserve(kUsualSignals);
    signals.reserve(kUsualSignals);
    WeakestStrength weakest;
    const double reach = world.scene.max_radio_reach();
    for (const RadioTransmission& transmission : world.state->transmissions) {
      if (transmission.due != tick) continue;
      const Pose& X_WB = world.bodies.X_WB(world.scene.body_of(transmission.from));
      // By the robot's place and the largest reach of all radios: one comparison discards most messages of a swarm.
      if ((X_WB.translation() - X_WS.translation()).squaredNorm() > reach * reach) continue;
      const std::optional<Candidate> candidate = FindCandidate(world, transmission, X_WS);
      if (!candidate) continue;
      candidates.push_back(*candidate);
      signals.push_back({.from = {transmission.from, candidate->X_WT.translation(), candidate->X_WT.z},
                         .sender = candidate->sender,
                         .clear = RadioStrength(*candidate->sender, candidate->distance, 0.0),
                         .weakest = weakest.Of(*candidate->sender)});
    }
    if (candidates.empty()) return;
    content.receptions.reserve(candidates.size());
    RadioPaths paths(world, {robot(), X_WS.translation(), X_WS.z}, signals);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const RadioTransmission* const transmission = candidates[i].transmission;
      const std::optional<double> strength = paths.StrengthOf(i);
      if (!strength) continue;
      content.receptions.push_back({.from = transmission->from,
                                    .to_all = !transmission->message.to,
                                    .bytes = transmission->message.bytes,
                                    .rssi = *strength,
                                    .tick = transmission->sent,
                                    .place = PlaceIn(world, *transmission, X_WS, candidates[i].X_WT)});
    }
  }

  // The radio that sent the message; null if this one cannot receive it, wherever the two are.
  const RadioParameters* SenderOf(const SensedWorld& world, const RadioTransmission& transmission) const {
    const WorldDescription& description = world.scene.world();
    const std::optional<RobotId>& to = transmission.message.to;
    if (transmission.from == robot() || (to && *to != robot()) || !RobotExists(description, transmission.from)) {
      return nullptr;
    }
    const RadioParameters* const radio = FindRadio(description.robot(transmission.from), transmission.message.radio);
    return radio != nullptr && radio->channel == parameters().channel ? radio : nullptr;
  }

  double Random(const SensedWorld& world, const RadioTransmission& transmission, RadioDraw draw) const {
    return RandomUniform({kRadioStream, world.scene.world().seed, transmission.from.index(), transmission.message.radio,
                          robot().index(), index(), transmission.sent, transmission.number,
                          static_cast<std::uint64_t>(draw)});
  }

  double Noise(const SensedWorld& world, const RadioTransmission& transmission, RadioDraw draw) const {
    return RandomNormal({kRadioStream, world.scene.world().seed, transmission.from.index(), transmission.message.radio,
                         robot().index(), index(), transmission.sent, transmission.number,
                         static_cast<std::uint64_t>(draw)});
  }

  // Nothing if it is out of range, or lost.
  std::optional<Candidate> FindCandidate(const SensedWorld& world, const RadioTransmission& transmission,
                                         const Pose& X_WS) const {
    const RadioParameters* const sender = SenderOf(world, transmission);
    if (sender == nullptr) return std::nullopt;
    const ModelId model = world.scene.world().robot(transmission.from).sensors[transmission.message.radio].model;
    const Pose X_WM = world.bodies.X_WM(model);
    const Pose X_WT = sender->X_MS == Pose() ? X_WM : X_WM * sender->X_MS;
    const double height = X_WT.z - X_WS.z;
    const double distance = std::sqrt((X_WT.translation() - X_WS.translation()).squaredNorm() + height * height);
    if (distance > sender->range) return std::nullopt;
    const double by_distance = sender->range > 0.0 ? sender->range_loss * (distance / sender->range) : 0.0;
    const double received = (1.0 - sender->loss) * (1.0 - by_distance);
    // No draw for a radio without losses: the common case costs no random number.
    if (received < 1.0 && Random(world, transmission, RadioDraw::kLoss) >= received) return std::nullopt;
    return Candidate{&transmission, sender, X_WT, distance};
  }

  std::optional<RadioReception::Place> PlaceIn(const SensedWorld& world, const RadioTransmission& transmission,
                                               const Pose& X_WS, const Pose& X_WT) const {
    if (!parameters().range_and_bearing) return std::nullopt;
    const Pose X_ST = Inverse(X_WS) * X_WT;
    const double across = std::sqrt(X_ST.x * X_ST.x + X_ST.y * X_ST.y);
    RadioReception::Place place{.range = std::sqrt(across * across + X_ST.z * X_ST.z),
                                .bearing = Atan2(X_ST.y, X_ST.x),
                                .elevation = Atan2(X_ST.z, across)};
    if (parameters().range_noise > 0.0) {
      const double noise = parameters().range_noise * Noise(world, transmission, RadioDraw::kRange);
      place.range = std::max(0.0, place.range + noise);
    }
    if (parameters().bearing_noise > 0.0) {
      place.bearing =
          WrapAngle(place.bearing + parameters().bearing_noise * Noise(world, transmission, RadioDraw::kBearing));
    }
    return place;
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeRadio(const SensorMount& mount) {
  return std::make_unique<Radio>(mount);
}

double RadioStrength(const RadioParameters& radio, double distance, double losses) {
  static constexpr double kNearest = 0.01;                 // m
  static constexpr double kDecade = 2.302585092994045684;  // ln 10
  const double decades = Log(std::max(distance, kNearest)) / kDecade;
  return radio.power - 10.0 * radio.path_loss_exponent * decades - losses;
}

}  // namespace troupe
