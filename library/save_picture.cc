#include "library/save_picture.h"

#include <vector>

#include "common/base/file_replacement.h"
#include "common/picture/draw_picture.h"
#include "library/scan_fans.h"

namespace troupe {
Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays) {
  const Result<PictureFormat> format = PictureFormatOf(file);
  if (!format.ok()) return format.error();
  PictureOptions with_format = options;
  with_format.format = format.value();
  if (Status problem = CheckPictureOptions(with_format); !problem.ok()) return problem;
  const std::vector<ScanFan> fans =
      rays == PictureRays::kDrawn ? MeasureFans(scene, bodies, state) : std::vector<ScanFan>();
  const std::vector<Mark> marks =
      rays == PictureRays::kDrawn ? MeasureMarks(scene, bodies, state) : std::vector<Mark>();
  const Result<std::string> bytes = DrawPicture(scene.world(), state, fans, with_format, marks);
  if (!bytes.ok()) return Failure(bytes.error().message);
  return WriteWholeFile(file, bytes.value());
}

}  // namespace troupe
