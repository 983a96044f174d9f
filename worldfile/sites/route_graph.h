// Route graphs of Nav2's route server (GeoJSON) as lanes, and lanes as such a graph.
//
// The format is that of nav2_route: a FeatureCollection whose points are nodes and whose lines are directed edges from
// `startid` to `endid`; ids are whole numbers, each of one feature; coordinates are metres in the frame `map`, whatever
// the reference system of the file is called. A graph has no walls and one level.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "troupe/site_description.h"
#include "worldfile/sites/site.h"

namespace troupe {

// By the ending, .geojson.
bool IsRouteGraphPath(const std::string& path);

// Nodes are vertices with the `name` of their metadata, or their ids; edges are lanes of graph 0, of which two to and
// fro with one limit are one lane in both directions. `abs_speed_limit` is the limit. Costs, penalties, operations and
// limits in percent have no effect, with a warning.
Result<Site> ReadRouteGraph(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());
Result<Site> ReadRouteGraphText(const std::string& text, const std::string& path);

// The vertices and whole lanes of a graph that are within half a storey (kLevelGap) of a height z (m, W), as such a
// text. Names, docks and chargers are metadata of nodes, limits and groups of edges.
std::string RouteGraphText(const LaneGraph& graph, double z);

}  // namespace troupe
