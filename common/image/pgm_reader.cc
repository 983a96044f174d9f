// PGM: a header of text (P2 or P5, width, height, maximum; comments from # to the end of a line), then samples as text
// (P2) or bytes, two for each sample where the maximum is above 255 (P5).
#include <algorithm>
#include <optional>
#include <vector>

#include "common/image/image_reader.h"

namespace troupe {
namespace {

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
    if (*width * *height > (file_.size + 1) / bytes_per_sample) return TooShort(file_, *width, *height);
    lookup_.resize(static_cast<std::size_t>(*maximum) + 1);
    for (std::int64_t value = 0; value <= *maximum; ++value) {
      lookup_[static_cast<std::size_t>(value)] =
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

Result<Bitmap> ReadPgm(const ImageFile& file, const PixelRule& rule) {
  return PgmReader(file, rule).Read();
}

}  // namespace troupe
