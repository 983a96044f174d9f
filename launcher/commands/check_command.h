// `troupe check`: loads a world and prints a description of it, without running it.
//
// It uses the loader of a run and nothing else, so that a file that passes the check is one that a run loads. Warnings
// go to standard error, the description to standard output.
#pragma once

#include <optional>
#include <string>

#include "troupe/result.h"
#include "worldfile/load_world.h"

namespace troupe {

// Several lines, each with its end.
std::string DescribeWorld(const LoadedWorld& loaded);

// CheckControllers: finds bad controllers before any process is started, so that the error has a line of the scenario.
// Checks the controllers that `file` names, if it is a scenario (those of a Stage world are never an error), and
// `controller`, the value of --controller, if any.
Status CheckControllers(const std::string& file, const std::optional<std::string>& controller = {});

}  // namespace troupe
