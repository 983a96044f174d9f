// What needs a library that the module does not have: JPEG, pictures and the files of a web server. Each answers
// that it is not there.
#include "common/image/image_reader.h"
#include "library/save_picture.h"
#include "viewer/gateway/web_server.h"

namespace troupe {
namespace {

Error NotHere(const std::string& path, const std::string& what) {
  return {{path}, what + " in the WebAssembly module of Troupe", ErrorCode::kBadInput};
}

}  // namespace

// The page has them already.
std::span<const PageFile> PageFiles() {
  return {};
}

Result<Bitmap> ReadJpeg(const ImageFile& file, const PixelRule& /*rule*/) {
  return NotHere(file.path, "JPEG images are not read");
}

Result<std::string> EncodeGreyPng(const GreyImage& /*image*/) {
  return NotHere({}, "PNG images are not written");
}

Result<std::string> DrawPicture(const Scene& /*scene*/, const BodyIndex& /*bodies*/, const WorldState& /*state*/,
                                const PictureOptions& /*options*/, PictureRays /*rays*/) {
  return NotHere({}, "no pictures are drawn");
}

Status SavePicture(const Scene& /*scene*/, const BodyIndex& /*bodies*/, const WorldState& /*state*/,
                   const std::string& file, const PictureOptions& /*options*/, PictureRays /*rays*/) {
  return NotHere(file, "no pictures are drawn");
}

Status SaveView(const CameraReading& /*reading*/, const std::string& file, CameraImage /*image*/) {
  return NotHere(file, "no pictures are drawn");
}

}  // namespace troupe
