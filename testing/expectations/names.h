// The names of a world that expectations use, with the errors for those that do not exist.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "testing/expectations/program.h"
#include "testing/expectations/signals.h"
#include "troupe/expectation.h"
#include "troupe/result.h"

namespace troupe {

class WorldNames {
 public:
  explicit WorldNames(const ExpectationScope& scope);

  const WorldDescription& world() const { return scope_.world; }
  // Robots by id, then objects by id, as bodies are numbered.
  const std::vector<std::string>& bodies() const { return bodies_; }
  bool is_robot(std::uint32_t body) const { return body < world().robots.size(); }

  // The bodies that exist and match; the error is a pattern without a match.
  Result<std::vector<std::uint32_t>> Domain(const Syntax& bound) const;

  // Nothing for a name that is none of these.
  std::optional<std::uint32_t> FindBody(const std::string& name) const;
  std::optional<ModelId> FindStaticModel(const std::string& name) const;
  const NamedPlace* FindPlace(const std::string& name) const;
  const NamedRegion* FindRegion(const std::string& name) const;

  // "found 'dok', expected a place (dock, home); did you mean 'dock'?" `names`: those that exist.
  static Error Unknown(const Syntax& at, const std::string& expected, const std::vector<std::string>& names);
  std::vector<std::string> RobotNames() const;
  std::vector<std::string> ObjectNames() const;
  std::vector<std::string> PlaceNames() const;
  std::vector<std::string> RegionNames() const;

  // The joint, the store of energy, or the sensor of a robot; an error at `at` if it has none. `name`: of the joint or
  // sensor; nothing: its first sensor of the kind.
  Result<std::uint32_t> FindJoint(std::uint32_t robot, const Syntax& at) const;
  Result<std::uint32_t> FindStore(std::uint32_t robot, const Syntax& at) const;
  Result<std::uint32_t> FindSensor(std::uint32_t robot, SignalKind kind, const Syntax* name, const Syntax& at) const;
  // SignalUse::kNone if the robot's store cannot become empty, or there is none.
  std::uint32_t FindFiniteStore(std::uint32_t robot) const;

 private:
  std::optional<std::uint32_t> StoreOf(std::uint32_t robot) const;

  ExpectationScope scope_;
  std::vector<std::string> bodies_;
  std::vector<bool> exists_;     // by body
  std::vector<ModelId> stores_;  // FindStores
};

}  // namespace troupe
