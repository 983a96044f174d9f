// The lanes of a site as a plant model of openTCS (its schema model-6.0.0.xsd, which openTCS 6 and 7 read), with the
// properties that its driver for VDA 5050 2.0 reads.
//
// Vertices of lanes are points, with the ids of layouts (lif_json.h), and each direction of a lane is a path. A dock is
// a location for loads, a charger one for energy. Lengths are millimetres.
#pragma once

#include <string>
#include <vector>

#include "worldfile/sites/site.h"

namespace troupe {

struct PlantVehicle {
  std::string name;
  std::string interface_name;
  std::string manufacturer;
  std::string serial_number;
  std::string map_id;   // empty: that of the points
  double length = 1.0;  // m
  double width = 1.0;   // m
  double height = 1.0;  // m
};

std::string PlantModelText(const Site& site, const std::vector<PlantVehicle>& vehicles);

}  // namespace troupe
