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

// The file of an image; the error tells that it cannot be opened.
Result<ImageFile> OpenImage(const std::string& path);
// True if the content begins with the signature of PNG.
bool IsPng(const ImageFile& file);

// The error for more than kMaxImagePixels pixels. REQUIRES: height > 0
Status CheckPixels(const ImageFile& file, std::int64_t width, std::int64_t height);
// "found 20 bytes, which cannot hold an image of 60000 x 60000 pixels".
Error TooShort(const ImageFile& file, std::int64_t width, std::int64_t height);

// Sets row y of the bitmap, which is all free, by its samples from left to right. `channels` of a pixel: 1 grey, 2 grey
// and opacity, 3 red, green and blue, 4 red, green, blue and opacity.
void SetRow(const PixelRule& rule, const std::uint8_t* samples, std::size_t channels, int y, Bitmap& bitmap);

Result<Bitmap> ReadPng(const ImageFile& file, const PixelRule& rule);
Result<GreyImage> ReadGreyPng(const ImageFile& file);
Result<Bitmap> ReadPgm(const ImageFile& file, const PixelRule& rule);
Result<Bitmap> ReadBmp(const ImageFile& file, const PixelRule& rule);
Result<Bitmap> ReadJpeg(const ImageFile& file, const PixelRule& rule);

}  // namespace troupe
