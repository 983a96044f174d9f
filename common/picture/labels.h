// Labels: names beside boxes, if there is room for them.
//
// Greedy and in the order of the requests: a label never moves another one. Quadratic in the number of labels in the
// worst case.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "troupe/rectangle.h"

namespace troupe {

struct LabelRequest {
  std::string text;
  Rectangle box;  // px: to be labelled
};

struct PlacedLabel {
  std::size_t request = 0;
  Rectangle box;  // px
};

struct LabelPlan {
  double size = 0.0;  // px, of the letters
  std::vector<PlacedLabel> labels;
};

// Finds a place for each label beside its box, inside `page`, over no other label or requested box, and off `walls`
// where possible. Tries the sizes in their order and uses the first at which every label finds a place; at the last
// one, labels without a place are left out, and all of them if fewer than half have one.
LabelPlan PlaceLabels(const std::vector<LabelRequest>& requests, const std::vector<Rectangle>& walls,
                      const Rectangle& page, const std::vector<double>& sizes,
                      const std::function<double(const std::string&, double)>& text_width);

}  // namespace troupe
