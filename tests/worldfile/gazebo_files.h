// Texts of SDF, and the bodies of the models that they give.
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "tests/worldfile/world_folder.h"
#include "troupe/rectangle.h"

namespace troupe {

// A world of SDF 1.9 with these models and other elements.
inline std::string SdfWorldText(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n<world name=\"w\">\n" + content + "\n</world>\n</sdf>\n";
}

// A static model with one collision.
inline std::string SdfModelText(const std::string& name, const std::string& pose, const std::string& geometry,
                                const std::string& link_pose = "0 0 0 0 0 0") {
  return "<model name=\"" + name + "\"><static>true</static><pose>" + pose + "</pose><link name=\"link\"><pose>" +
         link_pose + "</pose><collision name=\"c\"><geometry>" + geometry + "</geometry></collision></link></model>\n";
}

inline std::string SdfBox(const std::string& size) {
  return "<box><size>" + size + "</size></box>";
}

// The box around a model's blocks, in W.
struct Extent {
  Rectangle area = Rectangle::Nothing();
  ZRange z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::size_t blocks = 0;
};

inline Extent ExtentOf(const WorldDescription& world, const std::string& name) {
  Extent extent;
  for (const ModelDescription& model : world.models) {
    if (model.name != name) continue;
    const Transform2 X_WM(model.X_PM);
    for (const Block& block : world.shape(model.shape).blocks) {
      for (const Vec2& corner : block.outline) extent.area.Extend(X_WM * corner);
      extent.z = {std::min(extent.z.min, block.z.min + model.X_PM.z),
                  std::max(extent.z.max, block.z.max + model.X_PM.z)};
      ++extent.blocks;
    }
  }
  return extent;
}

inline void ExpectExtent(const Extent& extent, const Rectangle& area, const ZRange& z, double tolerance = 1e-6) {
  EXPECT_NEAR(extent.area.min_x, area.min_x, tolerance);
  EXPECT_NEAR(extent.area.min_y, area.min_y, tolerance);
  EXPECT_NEAR(extent.area.max_x, area.max_x, tolerance);
  EXPECT_NEAR(extent.area.max_y, area.max_y, tolerance);
  EXPECT_NEAR(extent.z.min, z.min, tolerance);
  EXPECT_NEAR(extent.z.max, z.max, tolerance);
}

}  // namespace troupe
