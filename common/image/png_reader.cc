// PNG by libpng. libpng reports errors by longjmp, which must not pass a frame with destructors: every call into it
// goes through Guarded, whose frame has none, and which turns the jump into `false`.
#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <span>
#include <vector>

#include "common/image/image_reader.h"

namespace troupe {
namespace {

// Bytes with their bits in the other order.
constexpr std::array<std::uint64_t, 256> kMirrored = [] {
  std::array<std::uint64_t, 256> mirrored{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) mirrored[byte] |= std::uint64_t{(byte >> bit) & 1u} << (7 - bit);
  }
  return mirrored;
}();

class PngReader {
 public:
  // `may_pack`: rows of one bit a pixel stay so.
  PngReader(const ImageFile& file, const PixelRule& rule, bool may_pack)
      : file_(file), rule_(rule), may_pack_(may_pack) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, OnError, OnWarning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  Result<Bitmap> Read() {
    if (Status error = ReadStart(); !error.ok()) return error.error();
    Bitmap bitmap(width(), height());
    const bool ok =
        ReadPixels([&](const png_byte* samples, int y) { SetPixels(samples, bitmap.height() - 1 - y, bitmap); });
    if (!ok) return Fail(message_.data());
    return bitmap;
  }

  Result<GreyImage> ReadGrey() {
    if (Status error = ReadStart(); !error.ok()) return error.error();
    GreyImage image{width(), height(), {}};
    const std::int64_t pixels = std::int64_t{image.width} * std::int64_t{image.height};
    if (pixels > kMaxGreyPixels) {
      return Error{{file_.path},
                   "found an image of " + std::to_string(pixels) + " pixels, expected at most " +
                       std::to_string(kMaxGreyPixels)};
    }
    const std::size_t row = static_cast<std::size_t>(image.width);
    image.values.resize(static_cast<std::size_t>(pixels));
    const bool ok = ReadPixels([&](const png_byte* samples, int y) {
      for (std::size_t x = 0; x < row; ++x)
        image.values[static_cast<std::size_t>(y) * row + x] = samples[x * channels_];
    });
    if (!ok) return Fail(message_.data());
    return image;
  }

 private:
  int width() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height() const { return static_cast<int>(png_get_image_height(png_, info_)); }

  Status ReadStart() {
    if (png_ == nullptr || info_ == nullptr) return Fail("libpng cannot be started");
    if (!Guarded([this] { ReadHeader(); })) return Fail(message_.data());
    if (Status error = CheckSize(); !error.ok()) return error;
    if (!Guarded([this] { SetTransformations(); })) return Fail(message_.data());
    return {};
  }

  // `set_row`: of the samples of a row, y counts from the top.
  template <typename SetRow>
  bool ReadPixels(SetRow set_row) {
    return passes_ > 1 ? ReadInterlaced(set_row) : ReadRows(set_row);
  }

  // The calls must be of trivial frames: no object with a destructor between the jump and here.
  template <typename Calls>
  bool Guarded(Calls calls) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    calls();
    return true;
  }

  static void OnError(png_structp png, png_const_charp text) {
    PngReader* self = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(self->message_.data(), self->message_.size(), "%s", text);
    png_longjmp(png, 1);
  }
  static void OnWarning(png_structp, png_const_charp) {}

  Error Fail(const std::string& what) const {
    return Error{{file_.path}, "found a damaged PNG image (" + what + "), expected a whole one"};
  }

  void ReadHeader() {
    // CheckSize refuses large images, with a better message; chunks other than pixels stay small.
    png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
    png_set_chunk_cache_max(png_, 100);
    png_set_chunk_malloc_max(png_, 1 << 20);
    png_init_io(png_, file_.stream.get());
    png_read_info(png_, info_);
  }

  Status CheckSize() const {
    const std::int64_t width = png_get_image_width(png_, info_);
    const std::int64_t height = png_get_image_height(png_, info_);
    const std::string text = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    const std::int64_t bits_per_pixel =
        std::int64_t{png_get_channels(png_, info_)} * std::int64_t{png_get_bit_depth(png_, info_)};
    if (Status fault = CheckPixels(file_, width, height); !fault.ok()) return fault;
    const std::int64_t row_bytes = (width * bits_per_pixel + 7) / 8;
    if (row_bytes > kMaxImageBytes / height) {
      return Error{{file_.path},
                   "found an image of " + text + " that unpacks to more than 8 GB, expected a smaller one"};
    }
    if (png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE && width * height > kMaxInterlacedBytes / 4) {
      return Error{{file_.path}, "found an interlaced image of " + text + ", expected one that is not interlaced"};
    }
    // Deflate shrinks by at most 1032 to 1: a file that is too short for its pixels is cut off, or made to mislead.
    if (row_bytes * height / 1040 > file_.size) return TooShort(file_, width, height);
    return Status();
  }

  void SetTransformations() {
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
    if (png_get_bit_depth(png_, info_) == 16) png_set_strip_16(png_);
    const png_byte type = png_get_color_type(png_, info_);
    if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    // Black and white needs no unpacking: large maps are mostly that.
    is_packed_ = may_pack_ && type == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) == 1 &&
                 png_get_valid(png_, info_, PNG_INFO_tRNS) == 0 &&
                 png_get_interlace_type(png_, info_) == PNG_INTERLACE_NONE;
    if (type == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) < 8 && !is_packed_) {
      png_set_expand_gray_1_2_4_to_8(png_);
    }
    if (png_get_valid(png_, info_, PNG_INFO_tRNS) != 0) png_set_tRNS_to_alpha(png_);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    channels_ = png_get_channels(png_, info_);
    row_bytes_ = png_get_rowbytes(png_, info_);
  }

  template <typename SetRow>
  bool ReadRows(SetRow set_row) {
    std::vector<png_byte> row(row_bytes_);
    png_byte* const data = row.data();
    const int rows = height();
    for (int y = 0; y < rows; ++y) {
      if (!Guarded([this, data] { png_read_row(png_, data, nullptr); })) return false;
      set_row(data, y);
    }
    return ReadEnd();
  }

  template <typename SetRow>
  bool ReadInterlaced(SetRow set_row) {
    const std::size_t rows = static_cast<std::size_t>(height());
    std::vector<png_byte> pixels(row_bytes_ * rows);
    for (int pass = 0; pass < passes_; ++pass) {
      for (std::size_t row = 0; row < rows; ++row) {
        png_byte* const data = pixels.data() + row * row_bytes_;
        if (!Guarded([this, data] { png_read_row(png_, data, nullptr); })) return false;
      }
    }
    for (std::size_t row = 0; row < rows; ++row) set_row(pixels.data() + row * row_bytes_, static_cast<int>(row));
    return ReadEnd();
  }

  bool ReadEnd() {
    return Guarded([this] { png_read_end(png_, nullptr); });
  }

  void SetPixels(const png_byte* samples, int y, Bitmap& bitmap) const {
    if (!is_packed_) return SetRow(rule_, samples, channels_, y, bitmap);
    SetPackedRow(samples, static_cast<std::size_t>(bitmap.width()), bitmap.row(y));
  }

  // From eight pixels in a byte, the leftmost in its highest bit.
  void SetPackedRow(const png_byte* bytes, std::size_t width, std::span<std::uint64_t> words) const {
    const std::uint64_t white = rule_.occupied[255] ? ~std::uint64_t{0} : 0;
    const std::uint64_t black = rule_.occupied[0] ? ~std::uint64_t{0} : 0;
    const png_byte* const end = bytes + (width + 7) / 8;
    for (std::uint64_t& word : words) {
      std::uint64_t pixels = 0;
      for (unsigned shift = 0; shift < 64 && bytes != end; shift += 8) pixels |= kMirrored[*bytes++] << shift;
      word = (pixels & white) | (~pixels & black);
    }
    // Bits beyond the width stay 0, as Bitmap requires.
    if (width % 64 != 0) words.back() &= (std::uint64_t{1} << (width % 64)) - 1;
  }

  const ImageFile& file_;
  const PixelRule& rule_;
  const bool may_pack_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::array<char, 200> message_{};
  int passes_ = 1;
  bool is_packed_ = false;  // rows have eight pixels in a byte
  std::size_t channels_ = 1;
  std::size_t row_bytes_ = 0;
};

}  // namespace

Result<Bitmap> ReadPng(const ImageFile& file, const PixelRule& rule) {
  return PngReader(file, rule, true).Read();
}

Result<GreyImage> ReadGreyPng(const ImageFile& file) {
  return PngReader(file, PixelRule(), false).ReadGrey();
}

Result<std::string> EncodeGreyPng(const GreyImage& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.values.data(), image.width, nullptr) == 0) {
    return Error{{}, std::string("cannot make a PNG image: ") + header.message, ErrorCode::kOutputFailed};
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace troupe
