#include "troupe/picture_options.h"

#include <cmath>

#include "common/picture/viewport.h"

namespace troupe {

Status CheckPictureOptions(const PictureOptions& options) {
  if (options.width && (*options.width < kMinPictureWidth || *options.width > kMaxPictureWidth)) {
    return Error{{},
                 "found a picture width of " + std::to_string(*options.width) + ", expected " +
                     std::to_string(kMinPictureWidth) + " to " + std::to_string(kMaxPictureWidth) + " pixels"};
  }
  const auto out_of_bounds = [](double value) { return !(std::abs(value) <= 1e9); };
  if (options.center && (out_of_bounds(options.center->x()) || out_of_bounds(options.center->y()))) {
    return Error{{}, "found a picture centre that is not a place, expected x and y within 1e9 m"};
  }
  if (options.meters && !(*options.meters >= 0.01 && *options.meters <= 1e9)) {
    return Error{{}, "found a picture " + Label(*options.meters) + " m wide, expected 0.01 m to 1e9 m"};
  }
  return Status();
}

Result<PictureFormat> PictureFormatOf(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  const std::string ending = dot == std::string::npos ? "" : name.substr(dot);
  if (ending == ".png") return PictureFormat::kPng;
  if (ending == ".svg") return PictureFormat::kSvg;
  const std::string found = ending.empty() ? "no file ending" : "the file ending '" + ending + "'";
  return Error{{path, 0, 0}, "found " + found + ", expected .png or .svg"};
}

}  // namespace troupe
