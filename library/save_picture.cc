#include "library/save_picture.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "common/picture/draw_picture.h"
#include "library/scan_fans.h"

namespace troupe {
namespace {

Status WriteFile(const std::string& path, const std::string& bytes) {
  const auto failure = [&] {
    return Error{{path, 0, 0}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kFailure};
  };
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return failure();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed) return failure();
  return {};
}

}  // namespace

Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays) {
  const Result<PictureFormat> format = PictureFormatOf(file);
  if (!format.ok()) return format.error();
  PictureOptions with_format = options;
  with_format.format = format.value();
  if (Status problem = CheckPictureOptions(with_format); !problem.ok()) return problem;
  const std::vector<ScanFan> fans =
      rays == PictureRays::kDrawn ? MeasureFans(scene, bodies, state) : std::vector<ScanFan>();
  const Result<std::string> bytes = DrawPicture(scene.world(), state, fans, with_format);
  if (!bytes.ok()) return Failure(bytes.error().message);
  return WriteFile(file, bytes.value());
}

}  // namespace troupe
