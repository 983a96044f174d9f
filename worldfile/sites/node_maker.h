// NodeMaker: makes a node of a WorldTree, property by property.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "troupe/pose.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// Values are numbers with the text that a file would have, because a site is read by the same readers as a Stage file.
// Lengths in m; At takes radians and writes degrees, the unit of such files. All parts have the place `where` in the
// user's file, for messages.
class NodeMaker {
 public:
  NodeMaker(std::string type, const SourceLocation& where) {
    node.type = std::move(type);
    node.where = where;
  }

  NodeMaker& Text(const std::string& name, const std::string& text) { return Add(name, text); }
  NodeMaker& Number(const std::string& name, double value) { return Add(name, NumberOf(value)); }
  NodeMaker& Numbers(const std::string& name, const std::vector<double>& values) {
    Value::Tuple tuple;
    for (const double value : values) tuple.push_back(NumberOf(value));
    return Add(name, std::move(tuple));
  }
  NodeMaker& At(const Pose& pose) { return Numbers("pose", {pose.x, pose.y, pose.z, RadiansToDegrees(pose.heading)}); }
  NodeMaker& Child(WorldNode child) {
    node.children.Add(std::move(child));
    return *this;
  }

  WorldNode node;

 private:
  static Value::Number NumberOf(double value) { return {value, NumberText(value)}; }
  NodeMaker& Add(const std::string& name, decltype(Value::content) content) {
    node.Set({name, {std::move(content), node.where}, node.where});
    return *this;
  }
};

}  // namespace troupe
