// FrameTree: named poses of one scope, each relative to another name, to poses in the scope's own frame.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "worldfile/gazebo/xml_values.h"

namespace troupe {

class FrameTree {
 public:
  // A frame at T in `relative_to`; empty: the scope's own frame. The first of two with one name counts.
  void Add(const std::string& name, const Transform3& T, const std::string& relative_to, const SourceLocation& where) {
    frames_.emplace(name, Frame{T, relative_to, where});
  }
  bool Has(const std::string& name) const { return frames_.contains(name); }

  // The pose of a frame in the scope's own. A name that is not known, or a cycle, is an error of the diagnostics.
  Transform3 Resolve(const std::string& name, const SourceLocation& where, Diagnostics& diagnostics) {
    return At(name, where, diagnostics, 0);
  }

  // All of them. REQUIRES: no error so far
  std::map<std::string, Transform3> All(Diagnostics& diagnostics) {
    std::map<std::string, Transform3> all;
    for (const auto& [name, frame] : frames_) all.emplace(name, At(name, frame.where, diagnostics, 0));
    return all;
  }

 private:
  struct Frame {
    Transform3 T;
    std::string relative_to;
    SourceLocation where;
    bool is_resolved = false;
    bool is_open = false;  // its own pose is being looked for
  };

  static constexpr int kMaxChain = 200;

  Transform3 At(const std::string& name, const SourceLocation& where, Diagnostics& diagnostics, int length) {
    if (name.empty() || name == "__model__" || name == "world") return {};
    const auto found = frames_.find(name);
    if (found == frames_.end()) {
      diagnostics.Fail(where, "found the frame " + Quoted(name) + ", expected a link, joint, model or frame beside it");
      return {};
    }
    Frame& frame = found->second;
    if (frame.is_resolved) return frame.T;
    if (frame.is_open || length > kMaxChain) {
      diagnostics.Fail(frame.where, "found the frame " + Quoted(name) + " relative to itself, expected no cycle");
      return {};
    }
    frame.is_open = true;
    frame.T = At(frame.relative_to, frame.where, diagnostics, length + 1) * frame.T;
    frame.is_open = false;
    frame.is_resolved = true;
    return frame.T;
  }

  std::map<std::string, Frame> frames_;
};

}  // namespace troupe
