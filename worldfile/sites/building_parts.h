// The vertices, doors and lanes of a level in a building file.
#pragma once

#include <optional>
#include <string>

#include "worldfile/sites/site.h"
#include "worldfile/sites/yaml_reader.h"

namespace troupe {

// The first two numbers of a list. `what`: "a vertex". REQUIRES: it has as many.
Vec2 ReadPoint(YamlReader& yaml, const YAML::Node& list, const std::string& what);

// `[x, y, z, name, {parameters}]`; the position is in coordinates of the file.
SiteVertex ReadVertex(YamlReader& yaml, const YAML::Node& node);

// Of one of the models of a level, in coordinates of the file; nothing if it is no workcell.
std::optional<SiteWorkcell> ReadWorkcell(YamlReader& yaml, const YAML::Node& model);

// From the parameters of an edge.
SiteDoor ReadDoor(YamlReader& yaml, const SiteEdge& edge, const YAML::Node& params);
SiteLane ReadLane(YamlReader& yaml, const SiteEdge& edge, const YAML::Node& params);
SiteHumanLane ReadHumanLane(YamlReader& yaml, const SiteEdge& edge, const YAML::Node& params);

}  // namespace troupe
