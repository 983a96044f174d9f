// The fuzz targets: each feeds any bytes to a reader of input from outside. It returns for all bytes, and stops the
// program where a promise of the reader is broken.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>

// The targets share a rule: any bytes end in a value or in one error with a text and a place, never in a crash, a hang
// or a value that Validate would refuse. Check aborts, which the fuzzer reports with its input. Work is bounded by
// limits on sizes, so that executions stay short.
namespace troupe::fuzz {

using Bytes = std::span<const std::byte>;

// Files of users.
void World(Bytes bytes);       // a Stage world
void Scenario(Bytes bytes);    // a JSON scenario
void Image(Bytes bytes);       // an image, to the body of a model
void MapYaml(Bytes bytes);     // a ROS map's YAML, and behind a zero byte its image
void Building(Bytes bytes);    // a building of Open-RMF
void Layout(Bytes bytes);      // a layout in LIF
void RouteGraph(Bytes bytes);  // a graph of Nav2's route server
void FloorPlan(Bytes bytes);   // a drawing: SVG if it begins with "<", else DXF
void Gazebo(Bytes bytes);      // SDF; URDF or xacro if it has a "<robot"
void Mesh(Bytes bytes);        // COLLADA if it begins with "<", OBJ if with "v", "o" or "#", else STL
void ZoneMask(Bytes bytes);    // a mask of Nav2, and behind a zero byte its image
void Recording(Bytes bytes);   // a recorded run: behind a zero byte a file, behind another one its messages

// The language of expectations: a text, as an expectation, or behind a space as a metric.
void Expectation(Bytes bytes);

// Tests and their reports.
void TestFile(Bytes bytes);  // a test, and behind a zero byte its kept cases
void Report(Bytes bytes);    // the lines of a report that is merged

// A request of the page, or of the page of an editor.
void PageRequest(Bytes bytes);

// Messages of the types in idl/, as CDR.
void Session(Bytes bytes);
void Join(Bytes bytes);
void Admissions(Bytes bytes);
void Frame(Bytes bytes);    // a whole one
void Changes(Bytes bytes);  // a frame after another one
void FrameRequest(Bytes bytes);
void History(Bytes bytes);
void Proposal(Bytes bytes);
void Control(Bytes bytes);
void ControlReply(Bytes bytes);
void Status(Bytes bytes);

// A ROS message or request: the first byte selects its type, the others are CDR.
void RosSample(Bytes bytes);

// Lines between a launcher and its processes.
void HostMessage(Bytes bytes);
void ServiceReport(Bytes bytes);

// Helpers of the fuzz targets.

// Stops the program, which is a finding.
inline void Check(bool holds) {
  if (!holds) std::abort();
}

inline std::string TextOf(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace troupe::fuzz
