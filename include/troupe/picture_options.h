// The choices of a picture: which view, which part of the world, which size and format.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

enum class PictureView : std::uint8_t {
  kTop,   // x to the right, y up
  kSide,  // x to the right, z up, looking along +y
};

enum class PictureFormat : std::uint8_t { kPng, kSvg };

inline constexpr int kMinPictureWidth = 200;   // pixels
inline constexpr int kMaxPictureWidth = 4096;  // pixels

struct PictureOptions {
  PictureView view = PictureView::kTop;
  PictureFormat format = PictureFormat::kPng;
  // Pixels, within the bounds above; nothing: about 1000 along the longer side. The height follows from the world.
  std::optional<int> width;
  // The part of the world to draw: a place in W (m) and a length along x (m). Nothing: the middle, the whole world. A
  // side view shows the solids within half of `meters` before and behind the centre.
  std::optional<Vec2> center;
  std::optional<double> meters;
};

// The error names the option out of bounds.
Status CheckPictureOptions(const PictureOptions& options);

// The format by a file's ending: .png or .svg. The error names the ending.
Result<PictureFormat> PictureFormatOf(const std::string& path);

}  // namespace troupe
