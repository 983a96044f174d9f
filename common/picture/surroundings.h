// The surroundings of the drawn world: grid and scales below it, frame and caption around it.
#pragma once

#include <string>

#include "common/picture/canvas.h"
#include "common/picture/viewport.h"

namespace troupe {

void DrawGrid(Canvas& canvas, const Viewport& viewport);

// The plot's frame and the metres along it.
void DrawFrame(Canvas& canvas, const Viewport& viewport);

struct Caption {
  std::string title;   // the world's name
  std::string detail;  // tick, time, robots
  std::string alarm;   // in red: stalled robots
};

// Title and details at the lower left, a scale bar of a round length at the lower right.
void DrawCaption(Canvas& canvas, const Viewport& viewport, const Caption& caption);

}  // namespace troupe
