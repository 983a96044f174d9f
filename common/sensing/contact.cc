#include "common/sensing/contact.h"

#include <map>
#include <utility>

#include "common/sensing/contact_search.h"
#include "common/sensing/reading_json.h"

namespace troupe {
namespace {

class ContactSensor final : public Sensor {
 public:
  explicit ContactSensor(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"contacts\":[";
    for (const BodyContact& contact : std::get<ContactReading>(reading.content).contacts) {
      if (line.back() != '[') line += ',';
      line += "{\"part\":" + JsonString(world.model(contact.part).name) +
              ",\"other\":" + JsonString(world.model(contact.other).name) +
              ",\"point\":" + JsonNumbers({{contact.point.x(), contact.point.y()}}) +
              ",\"z\":" + JsonNumbers({{contact.z_min, contact.z_max}}) + "}";
    }
    return line + "]}\n";
  }

  void AddMarks(const SensedWorld& /*world*/, const SensorReading& reading, std::vector<Mark>& marks) const override {
    for (const BodyContact& contact : std::get<ContactReading>(reading.content).contacts) {
      marks.push_back({MarkShape::kDot, MarkRole::kTouched, 0.5 * (contact.z_min + contact.z_max), {contact.point}});
    }
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    std::map<std::pair<ModelId, ModelId>, Touch> nearest;  // by part and other
    for (const ConvexPiece& piece : world.bodies.pieces_in_world(world.scene.body_of(robot()))) {
      if (!piece.obstacle || !HasHeight(piece.z)) continue;
      for (const Touch& touch : FindTouches(world, robot(), piece.vertices, piece.z)) {
        const auto [known, is_new] = nearest.try_emplace({piece.model, touch.other}, touch);
        if (!is_new && touch.points.distance < known->second.points.distance) known->second = touch;
      }
    }
    reading.tick = tick;
    ContactReading& content = ContentOf<ContactReading>(reading);
    content.contacts.clear();
    for (const auto& [models, touch] : nearest) {
      content.contacts.push_back({.part = models.first,
                                  .other = models.second,
                                  .point = 0.5 * (touch.points.a + touch.points.b),
                                  .z_min = touch.z.min,
                                  .z_max = touch.z.max});
    }
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeContactSensor(const SensorMount& mount) {
  return std::make_unique<ContactSensor>(mount);
}

}  // namespace troupe
