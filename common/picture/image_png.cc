#include "common/picture/image_png.h"

#include <cairo.h>

#include <cstring>

namespace troupe {
namespace {

cairo_status_t AppendBytes(void* bytes, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Result<std::string> EncodePng(int width, int height, std::span<const std::uint8_t> rgb) {
  std::string bytes;
  cairo_surface_t* const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  if (unsigned char* const pixels = cairo_image_surface_get_data(surface)) {  // none without memory
    const int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t from =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        const std::uint32_t pixel =
            (std::uint32_t{rgb[from]} << 16) | (std::uint32_t{rgb[from + 1]} << 8) | rgb[from + 2];
        std::memcpy(pixels + static_cast<std::ptrdiff_t>(y) * stride + 4 * static_cast<std::ptrdiff_t>(x), &pixel, 4);
      }
    }
    cairo_surface_mark_dirty(surface);
  }
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface, AppendBytes, &bytes);
  cairo_surface_destroy(surface);
  if (status != CAIRO_STATUS_SUCCESS) return Error{{}, cairo_status_to_string(status)};
  return bytes;
}

}  // namespace troupe
