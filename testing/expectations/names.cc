#include "testing/expectations/names.h"

#include <algorithm>

#include "common/base/glob.h"
#include "common/base/text.h"

namespace troupe {
namespace {

// A robot has sensors of several kinds; a signal belongs to one of them.
bool Measures(const SensorParameters& parameters, SignalKind kind) {
  switch (kind) {
    case SignalKind::kPressed:
      return std::holds_alternative<BumperParameters>(parameters);
    case SignalKind::kHeard:
      return std::holds_alternative<RadioParameters>(parameters);
    default:
      return std::holds_alternative<RangerParameters>(parameters);
  }
}

const char* NameOfSensor(SignalKind kind) {
  return kind == SignalKind::kPressed ? "bumper" : kind == SignalKind::kHeard ? "radio" : "ranger";
}

}  // namespace

// A world may have thousands of names: an error lists the first.
std::string WorldNames::Listing(const std::vector<std::string>& names) {
  constexpr std::size_t kMax = 8;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMax; ++i) text += (i > 0 ? ", " : "") + names[i];
  return names.size() > kMax ? text + ", ..." : text;
}

std::string NameOfKinds(const std::vector<std::size_t>& kinds) {
  std::string text;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const std::string& name = StateTables()[kinds[i]].singular;
    const bool is_vowel = std::string_view("aeiou").find(name[0]) != std::string_view::npos;
    if (i == 0) text = is_vowel ? "an " : "a ";
    if (i > 0) text += i + 1 == kinds.size() ? " or " : ", ";
    text += name;
  }
  return text;
}

WorldNames::WorldNames(const ExpectationScope& scope)
    : scope_(scope), things_(std::make_shared<const Things>(scope.world)) {
  for (const ZoneDescription& zone : scope.world.zones) zones_.push_back({zone.name, zone.outline, zone.z});
}

// Made when first needed: most expectations do not look at values of the start.
const WorldState& WorldNames::placed() const {
  if (!placed_) placed_ = PlacedState(world());
  return *placed_;
}

// A pattern without a match is an error, as it is likely misspelt; a table without things is not.
Result<std::vector<ThingId>> WorldNames::Domain(const Syntax& bound) const {
  const std::span<const StateTable> tables = StateTables();
  const auto table =
      std::find_if(tables.begin(), tables.end(), [&](const StateTable& t) { return t.name == bound.domain; });
  if (table == tables.end() || table->varies) {
    std::vector<std::string> names;
    for (const StateTable& known : tables) {
      if (!known.varies) names.push_back(known.name);
    }
    std::string all;
    for (const std::string& name : names) all += name + ", ";
    return TextError(bound.domain_offset, "found '" + PlainLine(bound.domain, 40) + "', expected " + all +
                                              "or names as a text such as \"scout*\"" +
                                              DidYouMean(bound.domain, names));
  }
  const std::size_t kind = KindOf(table->name);
  std::vector<ThingId> found;
  std::vector<std::string> names;
  for (ThingId thing = things_->first(kind); thing < things_->first(kind) + things_->count(kind); ++thing) {
    if (!things_->exists(thing)) continue;
    names.push_back(things_->name(thing));
    if (!bound.pattern || MatchesGlob(*bound.pattern, names.back())) found.push_back(thing);
  }
  if (found.empty() && bound.pattern) {
    return TextError(bound.pattern_offset, "found the pattern '" + PlainLine(*bound.pattern, 40) +
                                               "' that matches no " + table->singular + ", expected one of the " +
                                               table->name + " (" + Listing(names) + ")" +
                                               DidYouMean(*bound.pattern, names));
  }
  return found;
}

std::optional<ModelId> WorldNames::FindStaticModel(const std::string& name) const {
  for (std::size_t i = 0; i < world().models.size(); ++i) {
    const ModelDescription& model = world().models[i];
    if (!model.removed && model.name == name) return ModelId(i);
  }
  return std::nullopt;
}

const NamedPlace* WorldNames::FindPlace(const std::string& name) const {
  for (const NamedPlace& place : world().places) {
    if (place.name == name) return &place;
  }
  return nullptr;
}

const NamedRegion* WorldNames::FindRegion(const std::string& name) const {
  for (const NamedRegion& region : scope_.regions) {
    if (region.name == name) return &region;
  }
  for (const NamedRegion& zone : zones_) {
    if (zone.name == name) return &zone;
  }
  return nullptr;
}

// m; nothing in a world without levels, where height does not matter.
std::optional<double> WorldNames::FloorAt(double z) const {
  const std::vector<LevelDescription>& levels = world().levels;
  if (levels.empty()) return std::nullopt;
  return levels[LevelNumberAt(levels, z)].z;
}

bool WorldNames::IsName(const std::string& name) const {
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    if (things_->Find(name, kind)) return true;
  }
  return FindStaticModel(name) || FindPlace(name) != nullptr || FindRegion(name) != nullptr;
}

// The most similar known name is a part of the message.
Error WorldNames::Unknown(const Syntax& at, const std::string& expected, const std::vector<std::string>& names) {
  std::string found = "something else";
  if (at.kind == SyntaxKind::kName || at.kind == SyntaxKind::kText) found = "'" + PlainLine(at.name, 40) + "'";
  if (at.kind == SyntaxKind::kCall) found = "'" + PlainLine(at.name, 40) + "(...)'";
  if (at.kind == SyntaxKind::kNumber) found = "a number";
  if (at.kind == SyntaxKind::kOperator) found = "'" + at.name + "' (a name with such a character needs quotes)";
  const std::string listing = names.empty() ? "" : " (" + Listing(names) + ")";
  return TextError(at.offset, "found " + found + ", expected " + expected + listing + DidYouMean(at.name, names));
}

std::vector<std::string> WorldNames::NamesOf(const std::vector<std::size_t>& kinds) const {
  std::vector<std::string> names;
  for (const std::size_t kind : kinds) {
    for (ThingId thing = things_->first(kind); thing < things_->first(kind) + things_->count(kind); ++thing) {
      names.push_back(things_->name(thing));
    }
  }
  return names;
}

std::vector<std::string> WorldNames::PlaceNames() const {
  std::vector<std::string> names;
  for (const NamedPlace& place : world().places) names.push_back(place.name);
  return names;
}

std::vector<std::string> WorldNames::RegionNames() const {
  std::vector<std::string> names;
  for (const NamedRegion& region : scope_.regions) names.push_back(region.name);
  for (const NamedRegion& zone : zones_) names.push_back(zone.name);
  return names;
}

// Names of parts are "ROBOT.PART"; in an expectation the part alone is written.
Result<ThingId> WorldNames::FindPart(ThingId robot, const std::vector<std::size_t>& kinds, const Syntax& at) const {
  const std::string& robot_name = things_->name(robot);
  std::vector<std::string> names;
  for (const std::size_t kind : kinds) {
    for (ThingId thing = things_->first(kind); thing < things_->first(kind) + things_->count(kind); ++thing) {
      if (things_->robot(thing) != RobotId(robot)) continue;
      names.push_back(things_->name(thing).substr(robot_name.size() + 1));
      if (names.back() == at.name) return thing;
    }
  }
  const std::string part = NameOfKinds(kinds);
  return Unknown(at,
                 (names.empty() ? "no part of robot " + robot_name + ", because it is without " : "") + part +
                     (names.empty() ? "" : " of robot " + robot_name),
                 names);
}

// An endless store never runs empty: kNone, as for a robot without a store.
std::uint32_t WorldNames::FindFiniteStore(ThingId robot) const {
  const std::vector<ModelId> stores = FindStores(world());
  for (std::size_t i = 0; i < stores.size(); ++i) {
    if (!IsInTree(world(), stores[i], world().robots[robot].root)) continue;
    return world().model(stores[i]).power.endless ? SignalUse::kNone : static_cast<std::uint32_t>(i);
  }
  return SignalUse::kNone;
}

Result<SensorPlace> WorldNames::FindSensor(ThingId sensor, SignalKind kind, const Syntax& at) const {
  const SensorPlace place = things_->sensors()[things_->row_of(sensor)];
  if (Measures(world().robot(place.robot).sensors[place.sensor].parameters, kind)) return place;
  return TextError(
      at.offset, "found '" + at.name + "' of sensor " + things_->name(sensor) + ", which is no " + NameOfSensor(kind) +
                     ", expected sensors that are, as with a pattern: in sensors \"*." + NameOfSensor(kind) + "*\"");
}

Result<std::uint32_t> WorldNames::FindSensor(ThingId robot, SignalKind kind, const Syntax* name,
                                             const Syntax& at) const {
  const std::vector<SensorDescription>& sensors = world().robots[robot].sensors;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!Measures(sensors[i].parameters, kind)) continue;
    if (name == nullptr || sensors[i].name == name->name) return static_cast<std::uint32_t>(i);
    names.push_back(sensors[i].name);
  }
  const std::string& robot_name = things_->name(robot);
  const std::string sensor = NameOfSensor(kind);
  if (name != nullptr && !names.empty()) return Unknown(*name, "a " + sensor + " of robot " + robot_name, names);
  return TextError(at.offset, "found '" + at.name + "' of robot " + robot_name + ", which has no " + sensor +
                                  ", expected robots that have one");
}

}  // namespace troupe
