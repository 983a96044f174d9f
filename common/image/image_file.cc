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

Result<Bitmap> ReadBitmap(const std::string& path, const PixelRule& rule) {
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

  std::array<unsigned char, 8> start{};
  const std::size_t count = std::fread(start.data(), 1, start.size(), file.stream.get());
  std::rewind(file.stream.get());
  if (count == 8 && std::memcmp(start.data(), "\x89PNG\r\n\x1a\n", 8) == 0) return ReadPng(file, rule);
  if (count >= 3 && start[0] == 'P' && (start[1] == '2' || start[1] == '5')) return ReadPgm(file, rule);
  return Error{where, "found an unknown image format, expected PNG or PGM (P2 or P5)"};
}

}  // namespace troupe
