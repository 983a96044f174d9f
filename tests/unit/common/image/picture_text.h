// A picture as text, for tests of its readers.
#pragma once

#include <string>

#include "common/image/image_file.h"

namespace troupe {

// Rows from the top, '#' is occupied; or the error's message.
inline std::string PictureText(const std::string& path, const PixelRule& rule = StagePixelRule()) {
  const Result<Bitmap> bitmap = ReadBitmap(path, rule);
  if (!bitmap.ok()) return bitmap.error().message;
  std::string text;
  for (int y = bitmap.value().height() - 1; y >= 0; --y) {
    for (int x = 0; x < bitmap.value().width(); ++x) text += bitmap.value().occupied(x, y) ? '#' : '.';
    text += '\n';
  }
  return text;
}

}  // namespace troupe
