// BMP: a header, a palette, then rows from the bottom (or, with a negative height, from the top), each padded to four
// bytes; or runs of equal pixels (RLE). All kinds that programs write; opacity is ignored, because most write zeros for
// it.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <optional>
#include <vector>

#include "common/image/image_reader.h"

namespace troupe {
namespace {

constexpr std::size_t kFileHeader = 14;  // bytes
constexpr std::size_t kOldHeader = 12;   // of OS/2 1.x, with numbers of 16 bits and a palette of three bytes a colour
constexpr std::size_t kUsualHeader = 40;
constexpr std::size_t kMaxHeader = 124;

enum Compression : std::uint32_t { kNone = 0, kRuns8 = 1, kRuns4 = 2, kMasks = 3, kMasksAndOpacity = 6 };

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

// A channel of a pixel as the bits of a mask, spread to 0..255.
std::uint8_t Channel(std::uint32_t pixel, std::uint32_t mask) {
  if (mask == 0) return 0;
  const int shift = std::countr_zero(mask);
  // A mask with gaps is read as a number, too.
  const std::uint64_t most = mask >> shift;
  return static_cast<std::uint8_t>((std::uint64_t{(pixel & mask) >> shift} * 255 + most / 2) / most);
}

class BmpReader {
 public:
  BmpReader(const ImageFile& file, const PixelRule& rule) : file_(file), rule_(rule) {}

  Result<Bitmap> Read() {
    if (Status fault = ReadHeader(); !fault.ok()) return fault.error();
    if (Status fault = CheckSize(); !fault.ok()) return fault.error();
    if (!ReadPalette() || std::fseek(file_.stream.get(), static_cast<long>(data_at_), SEEK_SET) != 0) return Damaged();
    Bitmap bitmap(static_cast<int>(width_), static_cast<int>(height_));
    samples_.resize(3 * static_cast<std::size_t>(width_));
    const bool ok = HasRuns() ? ReadRuns(bitmap) : ReadRows(bitmap);
    if (!ok) return Damaged();
    return bitmap;
  }

 private:
  Error Damaged() const { return Error{{file_.path}, "found a damaged BMP image, expected a whole one"}; }
  bool HasRuns() const { return compression_ == kRuns8 || compression_ == kRuns4; }
  bool ReadBytes(std::uint8_t* bytes, std::size_t count) {
    return std::fread(bytes, 1, count, file_.stream.get()) == count;
  }

  // Little-endian, of the header.
  std::uint32_t Number(std::size_t at, std::size_t bytes) const {
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < bytes; ++i) number |= std::uint32_t{header_[at + i]} << (8 * i);
    return number;
  }

  Status ReadHeader() {
    if (!ReadBytes(header_.data(), kFileHeader + 4)) return Damaged();
    data_at_ = Number(10, 4);
    header_size_ = Number(kFileHeader, 4);
    const bool is_old = header_size_ == kOldHeader;
    // Before the read: the size of the header is a number of the file.
    if (!is_old && (header_size_ < kUsualHeader || header_size_ > kMaxHeader)) return Damaged();
    if (!ReadBytes(header_.data() + kFileHeader + 4, header_size_ - 4)) return Damaged();
    if (is_old) {
      width_ = Number(18, 2);
      height_ = Number(20, 2);
      bits_ = Number(24, 2);
    } else {
      width_ = static_cast<std::int32_t>(Number(18, 4));
      height_ = static_cast<std::int32_t>(Number(22, 4));
      bits_ = Number(28, 2);
      compression_ = Number(30, 4);
      colors_ = Number(46, 4);
    }
    from_top_ = height_ < 0;
    height_ = std::abs(height_);
    if (width_ <= 0 || height_ == 0 || data_at_ < static_cast<std::int64_t>(kFileHeader + header_size_))
      return Damaged();
    return ReadMasks();
  }

  // The bits of red, green and blue in a pixel without a palette; the header's kind is checked along with them.
  Status ReadMasks() {
    const bool has_masks = compression_ == kMasks || compression_ == kMasksAndOpacity;
    const bool fits = compression_ == kNone
                          ? bits_ == 1 || bits_ == 4 || bits_ == 8 || bits_ == 16 || bits_ == 24 || bits_ == 32
                          : (compression_ == kRuns8 && bits_ == 8) || (compression_ == kRuns4 && bits_ == 4) ||
                                (has_masks && (bits_ == 16 || bits_ == 32));
    if (!fits || (HasRuns() && from_top_)) {
      return Error{{file_.path},
                   "found a BMP image of " + std::to_string(bits_) + " bits a pixel and compression " +
                       std::to_string(compression_) + ", expected a usual one; save it as PNG"};
    }
    if (!has_masks) {
      if (bits_ == 16) masks_ = {0x7c00, 0x03e0, 0x001f};
      return {};
    }
    constexpr std::size_t kMasksAt = kFileHeader + kUsualHeader;
    if (header_size_ < kUsualHeader + 12 && !ReadBytes(header_.data() + kMasksAt, 12)) return Damaged();
    for (std::size_t i = 0; i < masks_.size(); ++i) masks_[i] = Number(kMasksAt + 4 * i, 4);
    return {};
  }

  std::int64_t RowBytes() const { return (width_ * bits_ + 31) / 32 * 4; }

  Status CheckSize() const {
    if (Status fault = CheckPixels(file_, width_, height_); !fault.ok()) return fault;
    if (HasRuns()) {
      // Two bytes make at most 255 pixels, and end at most a row.
      const bool fits = width_ * height_ <= 128 * file_.size && 2 * height_ <= file_.size;
      return fits ? Status() : Status(TooShort(file_, width_, height_));
    }
    // The padding of the last row may be missing.
    const std::int64_t bytes = RowBytes() * (height_ - 1) + (width_ * bits_ + 7) / 8;
    return data_at_ + bytes <= file_.size ? Status() : Status(TooShort(file_, width_, height_));
  }

  bool ReadPalette() {
    if (bits_ > 8) return true;
    const bool is_old = header_size_ == kOldHeader;
    const std::size_t most = std::size_t{1} << bits_;
    const std::size_t count = colors_ == 0 ? most : std::min<std::size_t>(colors_, most);
    for (std::size_t i = 0; i < count; ++i) {
      std::array<std::uint8_t, 4> color{};
      if (!ReadBytes(color.data(), is_old ? 3 : 4)) return false;
      palette_[i] = {color[2], color[1], color[0]};
    }
    return true;
  }

  void SetSample(std::size_t x, const Rgb& color) {
    samples_[3 * x] = color.red;
    samples_[3 * x + 1] = color.green;
    samples_[3 * x + 2] = color.blue;
  }

  Rgb Pixel(const std::uint8_t* row, std::size_t x) const {
    switch (bits_) {
      case 16:
      case 32: {
        std::uint32_t pixel = 0;
        const std::size_t bytes = bits_ / 8;
        for (std::size_t i = 0; i < bytes; ++i) pixel |= std::uint32_t{row[bytes * x + i]} << (8 * i);
        return {Channel(pixel, masks_[0]), Channel(pixel, masks_[1]), Channel(pixel, masks_[2])};
      }
      case 24:
        return {row[3 * x + 2], row[3 * x + 1], row[3 * x]};
      default: {
        const std::size_t bit = x * bits_;
        const unsigned shift = static_cast<unsigned>(8 - bits_ - bit % 8);
        return palette_[static_cast<std::size_t>(row[bit / 8] >> shift) & ((std::size_t{1} << bits_) - 1)];
      }
    }
  }

  bool ReadRows(Bitmap& bitmap) {
    std::vector<std::uint8_t> row(static_cast<std::size_t>(RowBytes()));
    const std::size_t needed = static_cast<std::size_t>((width_ * bits_ + 7) / 8);
    for (int i = 0; i < bitmap.height(); ++i) {
      const std::size_t count = i + 1 < bitmap.height() ? row.size() : needed;
      if (!ReadBytes(row.data(), count)) return false;
      for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) SetSample(x, Pixel(row.data(), x));
      SetRow(rule_, samples_.data(), 3, from_top_ ? bitmap.height() - 1 - i : i, bitmap);
    }
    return true;
  }

  // Pairs of bytes: a number of pixels and their colours, or, after a 0, the end of a row (0) or of the image (1), a
  // step to the right and up (2), or a number of pixels with a colour each. Pixels that are left out have colour 0.
  bool ReadRuns(Bitmap& bitmap) {
    const std::size_t width = static_cast<std::size_t>(width_);
    std::vector<std::uint8_t> row(width, 0);
    std::size_t x = 0;
    int y = 0;
    const auto end_row = [&] {
      for (std::size_t i = 0; i < width; ++i) SetSample(i, palette_[row[i]]);
      SetRow(rule_, samples_.data(), 3, y++, bitmap);
      std::fill(row.begin(), row.end(), std::uint8_t{0});
    };
    std::array<std::uint8_t, 256> bytes{};
    while (y < bitmap.height()) {
      if (!ReadBytes(bytes.data(), 2)) return false;
      const std::size_t count = bytes[0];
      const std::uint8_t second = bytes[1];
      if (count > 0) {
        // Runs must end within their row: the buffer has one row.
        if (count > width - x) return false;
        for (std::size_t i = 0; i < count; ++i) row[x++] = Nibble(second, i);
      } else if (second == 0) {
        end_row();
        x = 0;
      } else if (second == 1) {
        while (y < bitmap.height()) end_row();
      } else if (second == 2) {
        if (!ReadBytes(bytes.data(), 2)) return false;
        if (bytes[0] > width - x || bytes[1] >= bitmap.height() - y) return false;
        x += bytes[0];
        for (int i = 0; i < bytes[1]; ++i) end_row();
      } else {
        const std::size_t size = compression_ == kRuns8 ? second : (second + 1u) / 2;
        if (second > width - x || !ReadBytes(bytes.data(), size + size % 2)) return false;
        for (std::size_t i = 0; i < second; ++i) row[x++] = Nibble(bytes[compression_ == kRuns8 ? i : i / 2], i);
      }
    }
    return true;
  }

  // Colour i of the byte: one colour, or two for every other pixel.
  std::uint8_t Nibble(std::uint8_t byte, std::size_t i) const {
    if (compression_ == kRuns8) return byte;
    return i % 2 == 0 ? byte >> 4 : byte & 15;
  }

  const ImageFile& file_;
  const PixelRule& rule_;
  std::array<std::uint8_t, kFileHeader + kMaxHeader> header_{};
  std::size_t header_size_ = 0;
  std::int64_t data_at_ = 0;
  std::int64_t width_ = 0;
  std::int64_t height_ = 0;
  bool from_top_ = false;
  std::uint32_t bits_ = 0;  // of a pixel
  std::uint32_t compression_ = kNone;
  std::uint32_t colors_ = 0;                                                // in the palette; 0: all
  std::array<std::uint32_t, 3> masks_{0x00ff0000, 0x0000ff00, 0x000000ff};  // red, green, blue
  std::array<Rgb, 256> palette_{};
  std::vector<std::uint8_t> samples_;  // of a row: red, green, blue of each pixel
};

}  // namespace

Result<Bitmap> ReadBmp(const ImageFile& file, const PixelRule& rule) {
  return BmpReader(file, rule).Read();
}

}  // namespace troupe
