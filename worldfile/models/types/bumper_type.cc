// `bumper` and `contact`: sensors of touch.
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"

namespace troupe {
namespace {

std::string Indexed(const std::string& name, std::size_t index) {
  return name + "[" + std::to_string(index) + "]";
}

class BumperReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    BumperParameters bumper;
    bumper.height = draft.size.z;
    const double length = ReadDistance(reader, "blength", 0.0);
    const auto count = static_cast<std::size_t>(reader.Integer("bcount", 0, 0, kMaxBumpers));
    for (std::size_t i = 0; i < count; ++i) {
      const Pose X_DB = reader.ReadPose(Indexed("bpose", i)).value_or(Pose{});
      bumper.segments.push_back({draft.X_MD * X_DB, ReadDistance(reader, Indexed("blength", i), length)});
      if (!IsWithinReach(bumper.segments.back().X_MB)) {
        reader.diagnostics().Fail(reader.Where(Indexed("bpose", i)),
                                  "found a segment beyond 1000 km, expected it nearer");
      }
    }
    if (bumper.segments.empty()) {
      reader.diagnostics().Warn(reader.node().where, "this bumper has no 'bcount', so it feels nothing");
    }
    AddSensor(reader, draft, "bumper", std::move(bumper), context);
  }
};

class ContactReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    AddSensor(reader, draft, "contact", ContactParameters(), context);
  }
};

}  // namespace

ModelType BumperType() {
  return {.name = "bumper", .make_reader = MakeReader<BumperReader>};
}

ModelType ContactType() {
  return {.name = "contact", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<ContactReader>};
}

}  // namespace troupe
