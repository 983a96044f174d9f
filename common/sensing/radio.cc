#include "common/sensing/radio.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/hexadecimal.h"
#include "common/sensing/fan_marks.h"
#include "common/sensing/radio_path.h"
#include "common/sensing/reading_json.h"
#include "troupe/deterministic_math.h"
#include "troupe/radio_limits.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kRadioStream = 0x726164696f;  // "radio"

// Room reserved for the messages within range.
constexpr std::size_t kUsualSignals = 32;

enum class RadioDraw : std::uint64_t { kLoss = 0, kRange = 1, kBearing = 2 };

class Radio final : public Sensor {
 public:
  explicit Radio(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"received\":[";
    for (const RadioReception& reception : std::get<RadioReading>(reading.content).receptions) {
      if (line.back() != '[') line += ',';
      line += "{\"from\":" + JsonString(world.robot(reception.from).name) +
              ",\"to_all\":" + (reception.to_all ? "true" : "false") + ",\"bytes\":\"" +
              ToHexadecimal(std::as_bytes(std::span(reception.bytes))) + "\",\"rssi\":" + JsonNumber(reception.rssi) +
              ",\"tick\":" + std::to_string(reception.tick);
      if (reception.place) {
        line += ",\"range\":" + JsonNumber(reception.place->range) +
                ",\"bearing\":" + JsonNumber(reception.place->bearing) +
                ",\"elevation\":" + JsonNumber(reception.place->elevation);
      }
      line += '}';
    }
    return line + "]}\n";
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
    if (transmission.from == robot() || (to && *to != robot()) || !IsThere(description, transmission.from)) {
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
