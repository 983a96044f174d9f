#include <png.h>

#include "common/image/grey_image.h"

namespace troupe {

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
