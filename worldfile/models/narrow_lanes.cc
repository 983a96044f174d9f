#include "worldfile/models/narrow_lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include "common/spatial/convex_piece.h"
#include "worldfile/models/robot_outlines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxLaneMessages = 20;
constexpr double kRobotHeight = 1.0;  // m above the lane: a leaf that begins higher is in no way

// m: half of the smallest side of the boxes around the robots; nothing without robots.
std::optional<double> HalfWidthOfNarrowestRobot(const WorldDescription& world) {
  if (world.robots.empty()) return std::nullopt;
  double narrowest = std::numeric_limits<double>::infinity();
  for (const auto& [box, radius] : OutlinesOfRobots(world)) {
    // The smallest side of the box in the robot's frame: a robot passes a gap at best along its longer axis.
    const double width = box.empty() ? 0.0 : std::min(box.width(), box.height());
    narrowest = std::min(narrowest, 0.5 * width);
  }
  return narrowest;
}

// A leaf of a door as it stands when the door is open.
struct OpenLeaf {
  ModelId model;
  std::vector<ConvexPiece> pieces;  // in W
};

std::vector<OpenLeaf> OpenLeavesOf(const WorldDescription& world) {
  std::vector<OpenLeaf> leaves;
  for (const DoorDescription& door : world.doors) {
    const double opening = door.is_operated ? 1.0 : door.opening;
    if (opening == 0.0) continue;  // no lane leads through it
    for (const DoorLeaf& leaf : door.leaves) {
      const ModelId model = world.objects[leaf.object.index()];
      leaves.push_back({model, MakePieces(world, model, leaf.X_WH_at(opening))});
    }
  }
  return leaves;
}

std::string NameOf(const LaneVertex& vertex) {
  return vertex.name.empty() ? fmt::format("({:g}, {:g})", vertex.position.x(), vertex.position.y())
                             : Quoted(vertex.name);
}

// Finds lanes on which no robot of the world could pass an open door, a frequent fault of drawn buildings.
class NarrowLanes {
 public:
  explicit NarrowLanes(const WorldDescription& world)
      : world_(world), half_width_(HalfWidthOfNarrowestRobot(world)), leaves_(OpenLeavesOf(world)) {}

  std::vector<std::string> Find() {
    for (const LaneGraph& graph : world_.lane_graphs) {
      for (const Lane& lane : graph.lanes) Check(graph, lane);
    }
    if (count_ > kMaxLaneMessages)
      messages_.push_back(fmt::format("{} more lanes at open doors", count_ - kMaxLaneMessages));
    return std::move(messages_);
  }

 private:
  void Check(const LaneGraph& graph, const Lane& lane) {
    const LaneVertex& start = graph.vertices[lane.start];
    const LaneVertex& end = graph.vertices[lane.end];
    const Vec2 line[] = {start.position, end.position};
    const ZRange height{start.z, start.z + kRobotHeight};
    for (const OpenLeaf& leaf : leaves_) {
      const std::optional<double> gap = GapTo(leaf, line, height);
      if (!gap || *gap >= half_width_.value_or(kNoticeableDepth)) continue;
      // Counted on, for the last message.
      if (++count_ > kMaxLaneMessages) continue;
      const std::string lane_name = fmt::format("lane from {} to {}", NameOf(start), NameOf(end));
      const std::string leaf_name = fmt::format("the open leaf {}", Quoted(world_.model(leaf.model).name));
      messages_.push_back(*gap < kNoticeableDepth
                              ? fmt::format("{} passes through {}, so robots may be stuck there", lane_name, leaf_name)
                              : fmt::format("{} is {:.2f} m from {}, expected {:.2f} m, half the width of the "
                                            "narrowest robot, or more; robots may be stuck there",
                                            lane_name, *gap, leaf_name, *half_width_));
    }
  }

  // m; nothing for a leaf at other heights or without a body.
  static std::optional<double> GapTo(const OpenLeaf& leaf, std::span<const Vec2> line, const ZRange& height) {
    std::optional<double> gap;
    for (const ConvexPiece& piece : leaf.pieces) {
      if (!piece.obstacle || !piece.z.Overlaps(height)) continue;
      const double distance = FindNearestPoints(line, piece.vertices).distance;
      if (!gap || distance < *gap) gap = distance;
    }
    return gap;
  }

  const WorldDescription& world_;
  const std::optional<double> half_width_;  // m
  const std::vector<OpenLeaf> leaves_;
  std::size_t count_ = 0;
  std::vector<std::string> messages_;
};

}  // namespace

// Warnings: a robot that is not known yet might be narrower.
std::vector<std::string> FindNarrowLanes(const WorldDescription& world) {
  if (world.lane_graphs.empty() || world.doors.empty()) return {};
  return NarrowLanes(world).Find();
}

}  // namespace troupe
