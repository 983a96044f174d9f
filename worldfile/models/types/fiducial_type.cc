// `fiducial`: a finder of models with a `fiducial_return`.
#include <utility>

#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"

namespace troupe {
namespace {

class FiducialReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    FiducialParameters finder;
    finder.X_MS = draft.X_MD;
    finder.range.min = ReadDistance(reader, "range_min", 0.0);
    finder.range.max = ReadDistance(reader, "range_max", 8.0);
    if (finder.range.max < finder.range.min) {
      std::swap(finder.range.min, finder.range.max);
      reader.diagnostics().Warn(
          reader.Where("range_max"),
          "found a 'range_max' below the 'range_min', expected the other way round; they are exchanged");
    }
    finder.id_range = ReadDistance(reader, "range_max_id", 5.0);
    finder.fov = ReadFov(reader, kPi);
    finder.key = draft.model.fiducial_key;
    finder.ignores_height = reader.Flag("ignore_zloc", false);
    AddSensor(reader, draft, "fiducial", finder, context);
  }
};

}  // namespace

ModelType FiducialType() {
  return {.name = "fiducial", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<FiducialReader>};
}

}  // namespace troupe
