// The robot models that building files name: defines of the tree of every building, so that scenarios may use them by
// name. A file's robot type is looked up by name without regard to case (site_tree.cc).
#pragma once

#include <map>
#include <string>

#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// By name: boxes of about their size, with the speeds of the fleets of Open-RMF's demos and a scanner; "SiteRobot"
// stands for any other one. `where`: of all nodes.
std::map<std::string, Define> SiteRobots(const SourceLocation& where);

}  // namespace troupe
