// The values of a request of the page, checked. Private to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/pose.h"
#include "troupe/result.h"
#include "worldfile/edit/written_model.h"

namespace troupe {

// Empty without one.
std::string TextIn(const nlohmann::json& object, const char* key);
// A number of a list; nothing: none.
std::optional<std::size_t> IndexOf(const nlohmann::json& value);
// Finite and within the bounds of world files; nothing: none of that kind.
std::optional<double> NumberIn(const nlohmann::json& object, const char* key);
std::optional<std::vector<double>> NumbersIn(const nlohmann::json& object, const char* key, std::size_t count);
// [x, y, z, heading] in m and rad.
std::optional<Pose> PoseIn(const nlohmann::json& object, const char* key);

// The "blocks" of a request: [{"outline": [[x, y], ...], "z": [min, max]}], in metres. Up to 200 of up to 1000 corners.
struct DrawnBlock {
  std::vector<Vec2> outline;
  double z_min = 0.0;
  double z_max = 0.0;
};
Result<std::vector<DrawnBlock>> BlocksIn(const nlohmann::json& object, double metres_per_unit);

// A property to be set, as "property" and "value", its text, say.
struct PropertyChange {
  std::string property;
  std::optional<WrittenValue> value;  // nothing: it is removed
};
Result<PropertyChange> PropertyChangeIn(const nlohmann::json& object);

// "properties": {"color": "\"red\"", ...}, values as text of a world file. Up to 100.
using WrittenProperties = std::vector<std::pair<std::string, WrittenValue>>;
Result<WrittenProperties> PropertiesIn(const nlohmann::json& request);

// A name that fits between quotes on a line of both languages.
Status CheckName(const std::string& name);

}  // namespace troupe
