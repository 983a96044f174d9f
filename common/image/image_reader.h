// The readers behind image_file.h, one for each format. Private to this folder.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "common/image/image_file.h"

namespace troupe {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// An open image file, at its start.
struct ImageFile {
  std::unique_ptr<std::FILE, CloseFile> stream;
  std::string path;
  std::int64_t size = 0;  // bytes
};

Result<Bitmap> ReadPng(const ImageFile& file, const PixelRule& rule);
Result<Bitmap> ReadPgm(const ImageFile& file, const PixelRule& rule);

}  // namespace troupe
