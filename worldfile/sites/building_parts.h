// The vertices, doors and lanes of a level in a building file.
//
// Parameters are `key: [type, value]` in files of the editor and `key: value` in hand-written ones; the reader takes
// both (YamlReader::Parameter). Unknown parameters are warnings, once per key: files of newer editors must load.
#pragma once

#include <optional>
#include <string>

#include "worldfile/sites/site.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {

// The first two numbers of a list. `what`: "a vertex". REQUIRES: it has as many.
Vec2 ReadPoint(YamlReader& yaml, const YamlNode& list, const std::string& what);

// `[x, y, z, name, {parameters}]`; the position is in coordinates of the file.
SiteVertex ReadVertex(YamlReader& yaml, const YamlNode& node);

// Of one of the models of a level, in coordinates of the file; nothing if it is no workcell.
std::optional<SiteWorkcell> ReadWorkcell(YamlReader& yaml, const YamlNode& model);

// From the parameters of an edge.
SiteDoor ReadDoor(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params);
SiteLane ReadLane(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params);
SiteHumanLane ReadHumanLane(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params);

}  // namespace troupe
