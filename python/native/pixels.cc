// The pixels of PNG pictures as arrays, for figures and videos.
#include <png.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "python/native/world.h"

namespace troupe::python {
namespace {

// uint8 (height, width, 3), or 4 of a picture that is transparent somewhere.
py::array_t<std::uint8_t> Pixels(const py::bytes& file) {
  const std::string_view bytes = file;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) {
    throw py::value_error(std::string("found no PNG file: ") + image.message);
  }
  const bool has_alpha = (image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  image.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  py::array_t<std::uint8_t> pixels({static_cast<py::ssize_t>(image.height), static_cast<py::ssize_t>(image.width),
                                    static_cast<py::ssize_t>(has_alpha ? 4 : 3)});
  if (png_image_finish_read(&image, nullptr, pixels.mutable_data(), 0, nullptr) == 0) {
    throw py::value_error(std::string("found a damaged PNG file: ") + image.message);
  }
  return pixels;
}

}  // namespace

void DefinePixels(py::module_& module) {
  module.def("pixels", Pixels, py::arg("file"),
             "The pixels of the bytes of a PNG file, uint8 (height, width, 3 or 4).");
}

}  // namespace troupe::python
