#include "common/image/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>

#include "common/image/foreign_format.h"
#include "common/image/image_reader.h"

namespace troupe {

PixelRule StagePixelRule() {
  PixelRule rule;
  for (std::size_t value = 0; value <= 127; ++value) rule.occupied[value] = true;
  return rule;
}

Result<ImageFile> OpenImage(const std::string& path) {
  const SourceLocation where{path};
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    return Error{where, "found something that is not a regular file, expected an image"};
  }
  ImageFile file{std::unique_ptr<std::FILE, CloseFile>(std::fopen(path.c_str(), "rb")), path, 0};
  if (!file.stream)
    return Error{where, std::string("cannot read the image (") + std::strerror(errno) + "), expected a readable file"};
  const auto size = std::filesystem::file_size(path, ignored);
  file.size = ignored ? 0 : static_cast<std::int64_t>(size);
  return file;
}

namespace {

std::string StartOf(const ImageFile& file) {
  std::string start(kFormatBytes, '\0');
  start.resize(std::fread(start.data(), 1, start.size(), file.stream.get()));
  std::rewind(file.stream.get());
  return start;
}

bool IsPngStart(std::string_view start) {
  return start.starts_with("\x89PNG\r\n\x1a\n");
}

bool IsPgmStart(std::string_view start) {
  return start.size() >= 3 && (start.starts_with("P2") || start.starts_with("P5"));
}

std::string PixelsText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

bool IsOccupied(const PixelRule& rule, const std::uint8_t* pixel, std::size_t channels) {
  const bool has_alpha = channels == 2 || channels == 4;
  if (has_alpha && rule.transparent_is_free && pixel[channels - 1] != 255) return false;
  if (channels >= 3 && rule.mean_of_channels) {
    return rule.occupied[(static_cast<std::size_t>(pixel[0]) + pixel[1] + pixel[2] + 1) / 3];
  }
  return rule.occupied[pixel[0]];
}

}  // namespace

bool IsPng(const ImageFile& file) {
  return IsPngStart(StartOf(file));
}

Status CheckPixels(const ImageFile& file, std::int64_t width, std::int64_t height) {
  // A division, because the product could overflow.
  if (width <= kMaxImagePixels / height) return {};
  return Error{{file.path}, "found an image of " + PixelsText(width, height) + ", expected at most 4000000000 pixels"};
}

Error TooShort(const ImageFile& file, std::int64_t width, std::int64_t height) {
  return Error{
      {file.path},
      "found " + std::to_string(file.size) + " bytes, which cannot hold an image of " + PixelsText(width, height)};
}

void SetRow(const PixelRule& rule, const std::uint8_t* samples, std::size_t channels, int y, Bitmap& bitmap) {
  const std::span<std::uint64_t> words = bitmap.row(y);
  const std::size_t width = static_cast<std::size_t>(bitmap.width());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t count = std::min<std::size_t>(64, width - 64 * i);
    std::uint64_t word = 0;
    for (std::size_t bit = 0; bit < count; ++bit) {
      word |= std::uint64_t{IsOccupied(rule, samples, channels)} << bit;
      samples += channels;
    }
    words[i] = word;
  }
}

Result<Bitmap> ReadBitmap(const std::string& path, const PixelRule& rule) {
  const Result<ImageFile> opened = OpenImage(path);
  if (!opened.ok()) return opened.error();
  const ImageFile& file = opened.value();
  const std::string start = StartOf(file);
  if (IsPngStart(start)) return ReadPng(file, rule);
  if (IsPgmStart(start)) return ReadPgm(file, rule);
  if (start.starts_with("BM")) return ReadBmp(file, rule);
  if (start.starts_with("\xff\xd8\xff")) return ReadJpeg(file, rule);
  return Error{{path}, DescribeForeignFormat(start)};
}

Result<GreyImage> ReadGreyPng(const std::string& path) {
  const Result<ImageFile> file = OpenImage(path);
  if (!file.ok()) return file.error();
  if (!IsPng(file.value())) return Error{{path}, "found an image of another format, expected PNG"};
  return ReadGreyPng(file.value());
}

}  // namespace troupe
