#include "testing/expectations/names.h"

#include <algorithm>

#include "common/base/glob.h"
#include "common/base/text.h"

namespace troupe {
namespace {

// "a, b, c ..."
std::string Listing(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) text += (i > 0 ? ", " : "") + names[i];
  return names.size() > kMost ? text + ", ..." : text;
}

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

}  // namespace

WorldNames::WorldNames(const ExpectationScope& scope) : scope_(scope), stores_(FindStores(scope.world)) {
  for (std::size_t i = 0; i < world().robots.size(); ++i) {
    bodies_.push_back(world().robots[i].name);
    exists_.push_back(RobotExists(world(), RobotId(i)));
  }
  for (const ModelId object : world().objects) {
    bodies_.push_back(world().model(object).name);
    exists_.push_back(!world().model(object).removed);
  }
}

Result<std::vector<std::uint32_t>> WorldNames::Domain(const Syntax& bound) const {
  const bool robots = bound.domain == DomainKind::kRobots;
  std::vector<std::uint32_t> bodies;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!exists_[i] || is_robot(static_cast<std::uint32_t>(i)) != robots) continue;
    names.push_back(bodies_[i]);
    if (!bound.pattern || MatchesGlob(*bound.pattern, bodies_[i])) bodies.push_back(static_cast<std::uint32_t>(i));
  }
  if (bodies.empty() && bound.pattern) {
    const std::string kind = robots ? "robot" : "object";
    return TextError(bound.pattern_offset, "found the pattern '" + PlainLine(*bound.pattern, 40) +
                                               "' that matches no " + kind + ", expected one of the " + kind + "s (" +
                                               Listing(names) + ")" + DidYouMean(*bound.pattern, names));
  }
  return bodies;
}

std::optional<std::uint32_t> WorldNames::FindBody(const std::string& name) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (exists_[i] && bodies_[i] == name) return static_cast<std::uint32_t>(i);
  }
  return std::nullopt;
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
  return nullptr;
}

Error WorldNames::Unknown(const Syntax& at, const std::string& expected, const std::vector<std::string>& names) {
  std::string found = "something else";
  if (at.kind == SyntaxKind::kName || at.kind == SyntaxKind::kText) found = "'" + PlainLine(at.name, 40) + "'";
  if (at.kind == SyntaxKind::kCall) found = "'" + PlainLine(at.name, 40) + "(...)'";
  if (at.kind == SyntaxKind::kNumber) found = "a number";
  if (at.kind == SyntaxKind::kOperator) found = "'" + at.name + "' (a name with such a character needs quotes)";
  const std::string listing = names.empty() ? "" : " (" + Listing(names) + ")";
  return TextError(at.offset, "found " + found + ", expected " + expected + listing + DidYouMean(at.name, names));
}

std::vector<std::string> WorldNames::RobotNames() const {
  return {bodies_.begin(), bodies_.begin() + static_cast<std::ptrdiff_t>(world().robots.size())};
}

std::vector<std::string> WorldNames::ObjectNames() const {
  return {bodies_.begin() + static_cast<std::ptrdiff_t>(world().robots.size()), bodies_.end()};
}

std::vector<std::string> WorldNames::PlaceNames() const {
  std::vector<std::string> names;
  for (const NamedPlace& place : world().places) names.push_back(place.name);
  return names;
}

std::vector<std::string> WorldNames::RegionNames() const {
  std::vector<std::string> names;
  for (const NamedRegion& region : scope_.regions) names.push_back(region.name);
  return names;
}

Result<std::uint32_t> WorldNames::FindJoint(std::uint32_t robot, const Syntax& at) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world().joints.size(); ++i) {
    const JointDescription& joint = world().joints[i];
    if (joint.robot != RobotId(robot)) continue;
    if (joint.name == at.name) return static_cast<std::uint32_t>(i);
    names.push_back(joint.name);
  }
  return Unknown(
      at, (names.empty() ? "no joint, because there is none on robot " : "a joint of robot ") + bodies_[robot], names);
}

std::optional<std::uint32_t> WorldNames::StoreOf(std::uint32_t robot) const {
  for (std::size_t i = 0; i < stores_.size(); ++i) {
    if (IsInTree(world(), stores_[i], world().robots[robot].root)) return static_cast<std::uint32_t>(i);
  }
  return std::nullopt;
}

Result<std::uint32_t> WorldNames::FindStore(std::uint32_t robot, const Syntax& at) const {
  if (const std::optional<std::uint32_t> store = StoreOf(robot)) return *store;
  return TextError(at.offset, "found '" + at.name + "' of robot " + bodies_[robot] +
                                  ", which has no store of energy, expected robots that have one");
}

std::uint32_t WorldNames::FindFiniteStore(std::uint32_t robot) const {
  const std::optional<std::uint32_t> store = StoreOf(robot);
  return store && !world().model(stores_[*store]).power.endless ? *store : SignalUse::kNone;
}

Result<std::uint32_t> WorldNames::FindSensor(std::uint32_t robot, SignalKind kind, const Syntax* name,
                                             const Syntax& at) const {
  const std::vector<SensorDescription>& sensors = world().robots[robot].sensors;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!Measures(sensors[i].parameters, kind)) continue;
    if (name == nullptr || sensors[i].name == name->name) return static_cast<std::uint32_t>(i);
    names.push_back(sensors[i].name);
  }
  const std::string sensor = kind == SignalKind::kPressed ? "bumper" : kind == SignalKind::kHeard ? "radio" : "ranger";
  if (name != nullptr && !names.empty()) return Unknown(*name, "a " + sensor + " of robot " + bodies_[robot], names);
  return TextError(at.offset, "found '" + at.name + "' of robot " + bodies_[robot] + ", which has no " + sensor +
                                  ", expected robots that have one");
}

}  // namespace troupe
