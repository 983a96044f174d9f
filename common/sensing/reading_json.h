// Parts of the JSON lines of readings. Private to this folder.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "troupe/ids.h"

namespace troupe {

// `{"tick":12,"robot":"r0","sensor":"ranger:0"`, without a closing brace.
std::string LineStart(Tick tick, const std::string& robot, const std::string& sensor);

// A string in quotes; bytes that are not UTF-8 are replaced.
std::string JsonString(const std::string& text);

// `[0.1,5]`: each number as the shortest decimal that reads back as the same double.
std::string JsonNumbers(std::span<const double> values);

std::string JsonNumber(double value);

}  // namespace troupe
