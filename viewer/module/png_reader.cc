// PNG by the reader of stb, a header without a library; the samples are those that libpng gives (common/image).
#include <memory>

#include "common/image/image_reader.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Weverything"
#include <stb/stb_image.h>
#pragma clang diagnostic pop

namespace troupe {
namespace {

// Rows from the top, `channels` bytes for each pixel.
struct Image {
  struct Free {
    void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
  };
  int width = 0;
  int height = 0;
  int channels = 0;
  std::unique_ptr<stbi_uc, Free> samples;

  const std::uint8_t* Row(int y) const {
    return samples.get() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * Channels();
  }
  std::size_t Channels() const { return static_cast<std::size_t>(channels); }
};

Result<Image> Read(const ImageFile& file) {
  Image image;
  if (stbi_info_from_file(file.stream.get(), &image.width, &image.height, &image.channels) != 0) {
    if (Status fault = CheckPixels(file, image.width, image.height); !fault.ok()) return fault.error();
    image.samples.reset(stbi_load_from_file(file.stream.get(), &image.width, &image.height, &image.channels, 0));
  }
  if (image.samples == nullptr) {
    return Error{{file.path}, std::string("found a damaged PNG image (") + stbi_failure_reason() + ")"};
  }
  return image;
}

}  // namespace

Result<Bitmap> ReadPng(const ImageFile& file, const PixelRule& rule) {
  const Result<Image> read = Read(file);
  if (!read.ok()) return read.error();
  const Image& image = read.value();
  Bitmap bitmap(image.width, image.height);
  for (int y = 0; y < image.height; ++y) SetRow(rule, image.Row(y), image.Channels(), image.height - 1 - y, bitmap);
  return bitmap;
}

Result<GreyImage> ReadGreyPng(const ImageFile& file) {
  const Result<Image> read = Read(file);
  if (!read.ok()) return read.error();
  const Image& image = read.value();
  GreyImage grey{image.width, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* const row = image.Row(y);
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x) {
      grey.values.push_back(row[x * image.Channels()]);
    }
  }
  return grey;
}

}  // namespace troupe
