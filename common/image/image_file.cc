#include "common/image/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>

#include "common/image/foreign_format.h"
#include "common/image/image_reader.h"

namespace troupe {
namespace {

// PGM: a header of text (P2 or P5, width, height, maximum; comments from # to the end of a line), then samples as text
// (P2) or bytes, two for each sample where the maximum is above 255 (P5).

class PgmReader {
 public:
  PgmReader(const ImageFile& file, const PixelRule& rule) : file_(file), rule_(rule) {}

  Result<Bitmap> Read() {
    ReadByte();  // 'P'
    const bool binary = ReadByte() == '5';
    const std::optional<std::int64_t> width = Number(1'000'000'000);
    const std::optional<std::int64_t> height = Number(1'000'000'000);
    const std::optional<std::int64_t> maximum = Number(65535);
    if (!width || !height || !maximum || *width == 0 || *height == 0 || *maximum == 0) {
      return Fail("found a damaged PGM header, expected width, height and maximum as whole numbers above 0");
    }
    if (Status fault = CheckPixels(file_, *width, *height); !fault.ok()) return fault.error();
    const std::int64_t bytes_per_sample = binary && *maximum <= 255 ? 1 : 2;
    // As text a sample has at least a digit and a blank, but for the last one.
    if (*width * *height > (file_.size + 1) / bytes_per_sample) return TooShort(file_, *width, *height);
    lookup_.resize(static_cast<std::size_t>(*maximum) + 1);
    for (std::int64_t value = 0; value <= *maximum; ++value) {
      lookup_[static_cast<std::size_t>(value)] =
          // Once for each value instead of once for each pixel.
          rule_.occupied[static_cast<std::size_t>((value * 255 + *maximum / 2) / *maximum)];
    }
    Bitmap bitmap(static_cast<int>(*width), static_cast<int>(*height));
    for (int y = bitmap.height() - 1; y >= 0; --y) {
      if (!(binary ? ReadBinaryRow(bitmap, y, bytes_per_sample) : ReadTextRow(bitmap, y))) {
        return Fail("found a damaged PGM image, expected " + std::to_string(*width) + " x " + std::to_string(*height) +
                    " pixels of values up to " + std::to_string(*maximum));
      }
    }
    return bitmap;
  }

 private:
  Error Fail(const std::string& message) const { return Error{{file_.path}, message}; }
  int ReadByte() { return std::getc(file_.stream.get()); }

  // The next number after blanks and comments; consumes one more character, which must be a blank or the end.
  std::optional<std::int64_t> Number(std::int64_t maximum) {
    int c = ReadByte();
    while (c == '#' || IsBlank(c)) {
      if (c == '#') {
        while (c != '\n' && c != '\r' && c != EOF) c = ReadByte();
      } else {
        c = ReadByte();
      }
    }
    if (c < '0' || c > '9') return std::nullopt;
    std::int64_t value = 0;
    for (; c >= '0' && c <= '9'; c = ReadByte()) {
      value = value * 10 + (c - '0');
      if (value > maximum) return std::nullopt;
    }
    // A comment may begin right behind a number.
    if (c == '#') std::ungetc(c, file_.stream.get());
    if (c != '#' && c != EOF && !IsBlank(c)) return std::nullopt;
    return value;
  }

  bool IsOccupied(std::size_t sample) const { return lookup_[std::min(sample, lookup_.size() - 1)]; }

  static bool IsBlank(int c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

  bool ReadTextRow(Bitmap& bitmap, int y) {
    for (int x = 0; x < bitmap.width(); ++x) {
      const std::optional<std::int64_t> value = Number(65535);
      if (!value) return false;
      if (IsOccupied(static_cast<std::size_t>(*value))) bitmap.set_occupied(x, y, true);
    }
    return true;
  }

  bool ReadBinaryRow(Bitmap& bitmap, int y, std::int64_t bytes_per_sample) {
    const std::size_t step = static_cast<std::size_t>(bytes_per_sample);
    row_.resize(static_cast<std::size_t>(bitmap.width()) * step);
    if (std::fread(row_.data(), 1, row_.size(), file_.stream.get()) != row_.size()) return false;
    for (int x = 0; x < bitmap.width(); ++x) {
      const unsigned char* sample = row_.data() + static_cast<std::size_t>(x) * step;
      const std::size_t value = step == 1 ? sample[0] : static_cast<std::size_t>(sample[0]) * 256 + sample[1];
      if (IsOccupied(value)) bitmap.set_occupied(x, y, true);
    }
    return true;
  }

  const ImageFile& file_;
  const PixelRule& rule_;
  std::vector<bool> lookup_;  // occupied, by sample up to the maximum
  std::vector<unsigned char> row_;
};

}  // namespace

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
    // A whole word at a time: setting bit by bit would read and write the bitmap 64 times.
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

Result<Bitmap> ReadPgm(const ImageFile& file, const PixelRule& rule) {
  return PgmReader(file, rule).Read();
}

}  // namespace troupe
