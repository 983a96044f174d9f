// Layouts in LIF, the Layout Interchange Format of VDMA for driverless vehicles (version 1), to a Site.
//
// A layout is a graph for vehicles, without walls, doors or heights: the world that comes of it is a floorless plan
// with lanes and places. Angles are radians by the standard, degrees in many files (see AngleOf). The reader is strict
// about references and types, and lenient about everything optional; unknown keys are ignored, because vendors add
// their own. Another version, and keys of version 2, which would be ignored in silence, are errors.
#pragma once

#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/sites/site.h"

namespace troupe {

// True if a file is one, of any version: JSON with one of the keys `metaInformation`, `layouts` and `origins`.
bool IsLayoutPath(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// Layouts of one `layoutLevelId` are a level, and levels are kLayoutStorey apart, in the order of the file. Nodes are
// vertices with the name of their id, edges are lanes in the graph of their vehicle type, whose number is that of its
// first edge, and an interaction node of a station has a dock of the station's id.
Result<Site> ReadLayout(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// The same from text; `path` names it in messages.
Result<Site> ReadLayoutText(const std::string& text, const std::string& path);

// The ids of vertices, by level and number: the names of their places, or LEVEL.NUMBER.
std::vector<std::vector<std::string>> NodeIds(const Site& site);

// The vertices of lanes, the lanes and the docks of a site as such a text. The vehicle types are `graph_N`; nodes have
// their NodeIds. Groups, doors, lifts and the other roles of vertices have no place in it.
// `timestamp`: of the export, as ISO 8601 in UTC.
std::string LayoutText(const Site& site, const std::string& timestamp);

inline constexpr double kLayoutStorey = 4.0;  // m: a layout does not say its height

}  // namespace troupe
