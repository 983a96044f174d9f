// WorldNames: the names of one world as expectations see them (robots, objects, people, places, regions, joints,
// sensors and the rows of the state's tables), and the error messages for a name that does not exist. A message lists
// what exists and proposes the nearest spelling, since a wrong name is the most frequent mistake in a test.
//
// Owned by the compiler of one expectation, and used by its thread alone: `placed` builds the initial state at the
// first question and keeps it. It borrows the world of its scope, which outlives it. Names are compared whole and with
// case; patterns use * and ?.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/signals/state_tables.h"
#include "testing/expectations/program.h"
#include "testing/expectations/signals.h"
#include "troupe/expectation.h"
#include "troupe/result.h"

namespace troupe {

class WorldNames {
 public:
  explicit WorldNames(const ExpectationScope& scope);

  const WorldDescription& world() const { return scope_.world; }
  const Things& things() const { return *things_; }
  const std::shared_ptr<const Things>& things_of_world() const { return things_; }
  // The state at load, for what a thing has at all.
  const WorldState& placed() const;

  // The things of a quantifier that exist and match; the error is a kind that does not exist, or a pattern without a
  // match.
  Result<std::vector<ThingId>> Domain(const Syntax& bound) const;

  // Nothing for a name that is none of these.
  std::optional<ModelId> FindStaticModel(const std::string& name) const;
  const NamedPlace* FindPlace(const std::string& name) const;
  const NamedRegion* FindRegion(const std::string& name) const;  // a region, or the area of a zone
  // The height of the level that is nearest to `z`; nothing in a world without levels.
  std::optional<double> FloorAt(double z) const;
  // True for any name of the world. The compiler uses it to tell a free variable of a metric ("r") from a robot that is
  // called so.
  bool IsName(const std::string& name) const;

  // "found 'dok', expected a place (dock, home); did you mean 'dock'?" `names`: those that exist.
  static Error Unknown(const Syntax& at, const std::string& expected, const std::vector<std::string>& names);
  // "a, b, c, ..."
  static std::string Listing(const std::vector<std::string>& names);
  std::vector<std::string> NamesOf(const std::vector<std::size_t>& kinds) const;
  std::vector<std::string> PlaceNames() const;
  std::vector<std::string> RegionNames() const;

  // The part of a robot that `at` names, of one of these kinds.
  Result<ThingId> FindPart(ThingId robot, const std::vector<std::size_t>& kinds, const Syntax& at) const;
  // The sensor of a robot that makes readings of a signal; an error at `at` if it has none. `name`: of the sensor;
  // nothing: its first one.
  Result<std::uint32_t> FindSensor(ThingId robot, SignalKind kind, const Syntax* name, const Syntax& at) const;
  // The same of a thing that is a sensor.
  Result<SensorPlace> FindSensor(ThingId sensor, SignalKind kind, const Syntax& at) const;
  // The first store of energy of the robot, a row of WorldState::stores; SignalUse::kNone if it cannot become empty, or
  // there is none.
  std::uint32_t FindFiniteStore(ThingId robot) const;

 private:
  ExpectationScope scope_;
  std::shared_ptr<const Things> things_;
  std::vector<NamedRegion> zones_;  // of the world: regions behind those of the scope
  mutable std::optional<WorldState> placed_;
};

// "a robot, object or person".
std::string NameOfKinds(const std::vector<std::size_t>& kinds);

}  // namespace troupe
