// HeatSection: the heat maps of a test in a report, each the sum over its cases, drawn in the world of one case.
//
// It keeps the world as text (encoded_world.h), and draws what it reads from there: pictures are the same whether the
// world comes from this process or, in a merge, from the report of a shard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/base/json_reader.h"
#include "testing/cases/test_file.h"
#include "testing/reports/encoded_world.h"
#include "troupe/result.h"

namespace troupe {

nlohmann::json ToJson(const TestHeat& heat);
// Other JSON is an error of the reader.
TestHeat ReadTestHeat(const JsonReader& json);

class HeatSection {
 public:
  // Without maps.
  HeatSection() = default;
  explicit HeatSection(const TestHeat& heat) : maps_(heat.EmptyMaps()) {}

  // The world in which the maps are drawn, at its start.
  void SetWorld(const WorldDescription& world) { world_ = Encode(world); }
  // The maps of a case; none: it has none.
  void Add(const std::vector<HeatMap>& maps);
  // Adds the sums of the report of a shard. The error: maps of another test, or no maps.
  Status Merge(const JsonReader& json);

  bool empty() const { return maps_.empty(); }
  std::uint64_t merged() const { return merged_; }  // shards
  const std::vector<HeatMap>& maps() const { return maps_; }
  const EncodedWorld& world() const { return world_; }

  // The name of a file, behind the name of the test.
  static std::string FileName(const HeatMap& map);
  // The bytes of the PNG file of a map, which is the sum over so many runs. The error is a fault of the graphics
  // library.
  Result<std::string> Draw(const HeatMap& map, std::uint64_t runs) const;

 private:
  std::vector<HeatMap> maps_;
  EncodedWorld world_;
  std::uint64_t merged_ = 0;
};

nlohmann::json ToJson(const HeatSection& section);

}  // namespace troupe
