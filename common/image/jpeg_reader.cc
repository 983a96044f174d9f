// JPEG by libjpeg. It reports errors by a call that must not return: a longjmp, which must not pass a frame with
// destructors, so every call into it goes through Guarded, as in png_reader.cc.
#include <csetjmp>
#include <cstddef>
#include <cstdio>
// jpeglib.h needs the two before it.
#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/image/image_reader.h"

namespace troupe {
namespace {

constexpr int kMaxScans = 200;                  // of a progressive image: each costs the time of the whole
constexpr long kMaxWorkspace = 800'000'000;     // bytes, for the coefficients of a progressive image
constexpr std::int64_t kMaxPixelsOfByte = 512;  // a block of 64 pixels has at least a bit

class JpegReader {
 public:
  JpegReader(const ImageFile& file, const PixelRule& rule) : file_(file), rule_(rule) {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_.client_data = this;
    errors_.error_exit = OnError;
    errors_.emit_message = OnMessage;
    is_open_ = Guarded([this] { jpeg_create_decompress(&jpeg_); });
  }
  ~JpegReader() {
    if (is_open_) jpeg_destroy_decompress(&jpeg_);
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  Result<Bitmap> Read() {
    if (!is_open_ || !Guarded([this] { ReadHeader(); })) return Damaged();
    const std::int64_t width = jpeg_.image_width;
    const std::int64_t height = jpeg_.image_height;
    if (Status fault = CheckPixels(file_, width, height); !fault.ok()) return fault.error();
    // A few bytes can claim 65,535 x 65,535 pixels, which libjpeg would fill with grey.
    if (width * height / kMaxPixelsOfByte > file_.size) return TooShort(file_, width, height);
    if (!Guarded([this] { jpeg_start_decompress(&jpeg_); })) return Damaged();
    const std::size_t channels = static_cast<std::size_t>(jpeg_.output_components);
    std::vector<JSAMPLE> row(static_cast<std::size_t>(width) * channels);
    JSAMPROW rows[1] = {row.data()};
    Bitmap bitmap(static_cast<int>(width), static_cast<int>(height));
    for (int y = bitmap.height() - 1; y >= 0; --y) {
      if (!Guarded([this, &rows] { jpeg_read_scanlines(&jpeg_, rows, 1); })) return Damaged();
      const bool has_inks = jpeg_.out_color_space == JCS_CMYK;
      if (has_inks) InksToColors(row);
      SetRow(rule_, row.data(), has_inks ? 3 : channels, y, bitmap);
    }
    if (!Guarded([this] { jpeg_finish_decompress(&jpeg_); })) return Damaged();
    // A warning for libjpeg, an error for a map: the missing part would be free space.
    if (is_cut_) return Damaged("Premature end of JPEG file");
    return bitmap;
  }

 private:
  // The calls must be of trivial frames: no object with a destructor between the jump and here.
  template <typename Calls>
  bool Guarded(Calls calls) {
    if (setjmp(jump_) != 0) return false;
    calls();
    return true;
  }

  static JpegReader* Of(j_common_ptr jpeg) { return static_cast<JpegReader*>(jpeg->client_data); }
  static void OnError(j_common_ptr jpeg) {
    JpegReader* const self = Of(jpeg);
    self->errors_.format_message(jpeg, self->message_.data());
    std::longjmp(self->jump_, 1);
  }
  // A level below 0 is that of a warning.
  static void OnMessage(j_common_ptr jpeg, int level) {
    JpegReader* const self = Of(jpeg);
    const int code = self->errors_.msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) self->is_cut_ = true;
  }
  static void OnProgress(j_common_ptr jpeg) {
    if (!jpeg->is_decompressor || reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMaxScans) return;
    JpegReader* const self = Of(jpeg);
    std::snprintf(self->message_.data(), self->message_.size(), "more than %d scans", kMaxScans);
    std::longjmp(self->jump_, 1);
  }

  void ReadHeader() {
    progress_.progress_monitor = OnProgress;
    jpeg_.progress = &progress_;
    jpeg_.mem->max_memory_to_use = kMaxWorkspace;
    jpeg_stdio_src(&jpeg_, file_.stream.get());
    jpeg_read_header(&jpeg_, TRUE);
    const J_COLOR_SPACE space = jpeg_.jpeg_color_space;
    const bool has_inks = space == JCS_CMYK || space == JCS_YCCK;
    jpeg_.out_color_space = space == JCS_GRAYSCALE ? JCS_GRAYSCALE : has_inks ? JCS_CMYK : JCS_RGB;
    jpeg_.dct_method = JDCT_ISLOW;  // the same bits on every processor
  }

  // Adobe, whose files these are, stores inks inverted.
  void InksToColors(std::vector<JSAMPLE>& row) const {
    for (std::size_t x = 0; x < row.size() / 4; ++x) {
      const JSAMPLE* const inks = &row[4 * x];
      const unsigned black = jpeg_.saw_Adobe_marker ? inks[3] : 255u - inks[3];
      for (std::size_t i = 0; i < 3; ++i) {
        const unsigned ink = jpeg_.saw_Adobe_marker ? inks[i] : 255u - inks[i];
        row[3 * x + i] = static_cast<JSAMPLE>(ink * black / 255);
      }
    }
  }

  Error Damaged(const std::string& what) const {
    return Error{{file_.path}, "found a damaged JPEG image (" + what + "), expected a whole one"};
  }
  Error Damaged() const { return Damaged(message_.data()); }

  const ImageFile& file_;
  const PixelRule& rule_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf jump_{};
  std::array<char, JMSG_LENGTH_MAX> message_{};
  bool is_open_ = false;
  bool is_cut_ = false;  // libjpeg fills the rest with grey
};

}  // namespace

Result<Bitmap> ReadJpeg(const ImageFile& file, const PixelRule& rule) {
  return JpegReader(file, rule).Read();
}

}  // namespace troupe
