// The readers behind image_file.h, one for each format. Private to this folder.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "common/image/grey_image.h"
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

// The file of an image; the error tells that it cannot be opened.
Result<ImageFile> OpenImage(const std::string& path);
// True if the content begins as that of a PNG file.
bool IsPng(const ImageFile& file);

Result<Bitmap> ReadPng(const ImageFile& file, const PixelRule& rule);
Result<GreyImage> ReadGreyPng(const ImageFile& file);
Result<Bitmap> ReadPgm(const ImageFile& file, const PixelRule& rule);

}  // namespace troupe
