// Pictures of a world at one tick: a plan seen from above, or an elevation seen from the south. A pure function of what
// is drawn: the same world, state and options give the same bytes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/pose.h"
#include "common/geometry/vec2.h"
#include "common/model/world_description.h"
#include "common/model/world_state.h"

namespace troupe {

enum class PictureView : std::uint8_t {
  kTop,   // x to the right, y up
  kSide,  // x to the right, z up, looking along +y
};

enum class PictureFormat : std::uint8_t { kPng, kSvg };

inline constexpr int kMinPictureWidth = 200;   // pixels
inline constexpr int kMaxPictureWidth = 4096;  // pixels

struct PictureOptions {
  PictureView view = PictureView::kTop;
  PictureFormat format = PictureFormat::kPng;
  // Pixels, within the bounds above; nothing: about 1000 along the longer side. The height follows from the world.
  std::optional<int> width;
  // The part of the world to draw: a place in W (m) and a length along x (m). Nothing: the middle, the whole world. A
  // side view shows what lies within half of `meters` before and behind the centre.
  std::optional<Vec2> center;
  std::optional<double> meters;
};

// What one ray sensor measured, to be drawn as a fan.
struct ScanFan {
  Pose X_WS;                     // of the sensor in W
  double fov = 0.0;              // rad, the width of a fan of a single ray
  double range_max = 0.0;        // m; a ray of this length met nothing
  std::vector<double> bearings;  // rad, in S
  std::vector<double> ranges;    // m, by bearing
};

// The error says which option is out of bounds.
Status CheckPictureOptions(const PictureOptions& options);

// The bytes of a PNG or SVG file. The error says which option is out of bounds, or what the graphics library could not
// do. REQUIRES: Validate(world) found nothing; `state` belongs to it.
Result<std::string> DrawPicture(const WorldDescription& world, const WorldState& state,
                                const std::vector<ScanFan>& fans, const PictureOptions& options);

}  // namespace troupe
