#include "library/save_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/file_replacement.h"
#include "common/picture/image_png.h"

namespace troupe {
namespace {

// Grey, from white at the nearest depth to black at the farthest and beyond.
std::vector<std::uint8_t> DepthPixels(const CameraReading& reading) {
  const double reach = std::max(reading.limits.max - reading.limits.min, 1e-9);
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * reading.depths.size());
  for (const float depth : reading.depths) {
    const double share = std::clamp((static_cast<double>(depth) - reading.limits.min) / reach, 0.0, 1.0);
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - share)));
    rgb.insert(rgb.end(), 3, grey);
  }
  return rgb;
}

}  // namespace

Status SaveView(const CameraReading& reading, const std::string& file, CameraImage image) {
  const Result<PictureFormat> format = PictureFormatOf(file);
  if (!format.ok()) return format.error();
  if (format.value() != PictureFormat::kPng) {
    return Error{{file, 0, 0}, "found a camera's picture as .svg, expected .png", ErrorCode::kBadInput};
  }
  const std::vector<std::uint8_t> rgb = image == CameraImage::kDepths ? DepthPixels(reading) : reading.colors;
  const Result<std::string> bytes = EncodePng(static_cast<int>(reading.width), static_cast<int>(reading.height), rgb);
  if (!bytes.ok()) return Failure(bytes.error().message);
  return WriteWholeFile(file, bytes.value());
}

}  // namespace troupe
