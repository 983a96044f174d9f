// Numbers of the edited file: in its units, and each in its old form where it has not changed. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "troupe/pose.h"
#include "viewer/editor/editable_world.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

inline constexpr int kLengthDecimals = 4;   // a tenth of a millimetre in metres
inline constexpr int kHeadingDecimals = 2;  // of degrees
inline constexpr int kRadianDecimals = 5;

// To (-180, 180].
double WrappedDegrees(double degrees);

// The numbers of a property of the node, as in the file; 0 for a text. Empty: it has no such tuple.
std::vector<Value::Number> NumbersOf(const WorldNode& node, const std::string& name);

// A tuple of numbers that replaces `old`, which may have fewer.
WrittenValue ChangedTuple(const std::vector<Value::Number>& old, const std::vector<double>& numbers,
                          int decimals = kLengthDecimals);

// A pose that replaces `old`. `pose`: in m and rad, in the frame of the property.
WrittenValue ChangedPose(std::vector<Value::Number> old, const Pose& pose, const FileUnits& units);

// An angle in rad in the file's unit, without wrapping, and its decimals there.
double AngleInFile(double angle, const FileUnits& units);
int AngleDecimals(const FileUnits& units);

}  // namespace troupe
