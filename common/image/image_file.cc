#include "common/image/image_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

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
    return Error{where, "found something that is not a regular file, expected a PNG or PGM image"};
  }
  ImageFile file{std::unique_ptr<std::FILE, CloseFile>(std::fopen(path.c_str(), "rb")), path, 0};
  if (!file.stream)
    return Error{where, std::string("cannot read the image (") + std::strerror(errno) + "), expected a readable file"};
  const auto size = std::filesystem::file_size(path, ignored);
  file.size = ignored ? 0 : static_cast<std::int64_t>(size);
  return file;
}

namespace {

struct ImageStart {
  std::array<unsigned char, 8> bytes{};
  std::size_t count = 0;
};

ImageStart StartOf(const ImageFile& file) {
  ImageStart start;
  start.count = std::fread(start.bytes.data(), 1, start.bytes.size(), file.stream.get());
  std::rewind(file.stream.get());
  return start;
}

bool IsPngStart(const ImageStart& start) {
  return start.count == 8 && std::memcmp(start.bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
}

}  // namespace

bool IsPng(const ImageFile& file) {
  return IsPngStart(StartOf(file));
}

Result<Bitmap> ReadBitmap(const std::string& path, const PixelRule& rule) {
  const Result<ImageFile> opened = OpenImage(path);
  if (!opened.ok()) return opened.error();
  const ImageFile& file = opened.value();
  const ImageStart start = StartOf(file);
  if (IsPngStart(start)) return ReadPng(file, rule);
  if (start.count >= 3 && start.bytes[0] == 'P' && (start.bytes[1] == '2' || start.bytes[1] == '5'))
    return ReadPgm(file, rule);
  return Error{{path}, "found an unknown image format, expected PNG or PGM (P2 or P5)"};
}

Result<GreyImage> ReadGreyPng(const std::string& path) {
  const Result<ImageFile> file = OpenImage(path);
  if (!file.ok()) return file.error();
  if (!IsPng(file.value())) return Error{{path}, "found an image of another format, expected PNG"};
  return ReadGreyPng(file.value());
}

}  // namespace troupe
