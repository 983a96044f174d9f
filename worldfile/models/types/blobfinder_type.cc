// `blobfinder`: a finder of colours.
#include <algorithm>

#include "worldfile/models/properties/color_names.h"
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

// The names of `colors`, as many as `colors_count` says, or all without it.
std::vector<Color> ReadColors(PropertyReader& reader) {
  std::vector<std::string> names = reader.Texts("colors");
  const auto count =
      static_cast<std::size_t>(reader.Integer("colors_count", static_cast<std::int64_t>(names.size()), 0, 1000));
  if (count > names.size()) {
    reader.diagnostics().Warn(reader.Where("colors_count"),
                              "found " + CountText(names.size(), "colour") + ", expected " + std::to_string(count));
  }
  names.resize(std::min(count, names.size()));
  std::vector<Color> colors;
  for (const std::string& name : names) {
    const std::optional<Color> color = FindColor(name);
    if (color) {
      colors.push_back(*color);
    } else {
      reader.diagnostics().Warn(reader.Where("colors"), "colour " + Quoted(name) + " is not known; it is not found");
    }
  }
  return colors;
}

class BlobfinderReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    BlobfinderParameters finder;
    if (const auto image = reader.Numbers("image", 2)) {
      finder.width = ImageSide(reader, "image", (*image)[0]);
      finder.height = ImageSide(reader, "image", (*image)[1]);
    }
    finder.range = ReadDistance(reader, "range", finder.range);
    finder.fov = ReadFov(reader, finder.fov);
    finder.X_MS = draft.X_MD * Pose{0.0, 0.0, 0.0, WrapAngle(ReadAngle(reader, "pan", 0.0))};
    finder.colors = ReadColors(reader);
    AddSensor(reader, draft, "blobfinder", std::move(finder), context);
  }
};

}  // namespace

ModelType BlobfinderType() {
  return {.name = "blobfinder", .has_body = false, .make_reader = MakeReader<BlobfinderReader>};
}

}  // namespace troupe
