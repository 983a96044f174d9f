// Pictures of a world at one tick: a plan seen from above, or an elevation seen from the south. A pure function: the
// same world, state, fans, marks and options give the same bytes.
//
// Drawn in layers: ground and grid, scans, walls, solids from low to high, names and marks, then frame and caption. No
// GPU and no window, so that a picture can be made on any machine, in tests and on servers. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/model/mark.h"
#include "troupe/picture_options.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The measurement of one ray sensor, drawn as a fan.
struct ScanFan {
  Pose X_WS;                     // of the sensor in W
  double fov = 0.0;              // rad, the width of a fan of a single ray
  double range_max = 0.0;        // m; a ray of this length has no hit
  std::vector<double> bearings;  // rad, in S
  std::vector<double> ranges;    // m, by bearing
};

class HeatMap;

// The bytes of a PNG or SVG file. `heat`: a map under the bodies of a view from above; null: none. The error names the
// option out of bounds, or the fault of the graphics library. REQUIRES: Validate(world) found nothing; `state` belongs
// to it.
Result<std::string> DrawPicture(const WorldDescription& world, const WorldState& state,
                                const std::vector<ScanFan>& fans, const PictureOptions& options,
                                const std::vector<Mark>& marks = {}, const HeatMap* heat = nullptr);

// The bytes of a PNG file of an image: red, green and blue of each pixel, row by row from the top. The error is a fault
// of the graphics library. REQUIRES: rgb has 3 * width * height bytes; both sides are at least 1
Result<std::string> EncodePng(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace troupe
