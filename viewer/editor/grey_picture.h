// GreyPicture: the pixels of an image that is edited. It consists of tiles, and a copy shares them with the original
// until they are changed, so that each step of a history needs memory only for the pixels that it changes.
//
// A value type: copying costs a pointer per tile, changing a copy of the tiles that a stroke touches. Rows count from
// the top, as in image files; the world's y axis points up, which the importer of bitmaps considers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/image/image_file.h"
#include "troupe/bitmap.h"
#include "viewer/gateway/edit_operation.h"

namespace troupe {

// Columns x0 <= x < x1 and rows y0 <= y < y1; y from the top.
struct PixelBox {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  bool operator==(const PixelBox&) const = default;
};

class GreyPicture {
 public:
  // All white. REQUIRES: 1 to kMaxGreyPixels pixels
  GreyPicture(int width, int height);
  explicit GreyPicture(const GreyImage& image);

  int width() const { return width_; }
  int height() const { return height_; }
  // REQUIRES: within the picture; y from the top
  std::uint8_t value(int x, int y) const;
  // The pixels of a box that are within the picture.
  void Fill(const PixelBox& box, std::uint8_t value);

  GreyImage Image() const;
  Bitmap Occupied(const PixelRule& rule) const;
  // Around the pixels that Stage's rule makes occupied; nothing: there are none.
  std::optional<PixelBox> OccupiedBox() const;
  // The bytes of the tiles that `other` does not share; null: of all.
  std::size_t BytesBeyond(const GreyPicture* other) const;

  bool operator==(const GreyPicture& other) const;

 private:
  static constexpr int kTile = 128;  // pixels, width and height
  using Tile = std::array<std::uint8_t, static_cast<std::size_t>(kTile) * kTile>;

  std::size_t TileOf(int x, int y) const {
    return static_cast<std::size_t>(y / kTile) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x / kTile);
  }
  static std::size_t WithinTile(int x, int y) {
    return static_cast<std::size_t>(y % kTile) * kTile + static_cast<std::size_t>(x % kTile);
  }

  int width_ = 0;
  int height_ = 0;
  int columns_ = 0;                           // of tiles
  std::vector<std::shared_ptr<Tile>> tiles_;  // changed only while no other picture has it
};

void Draw(const PixelStroke& stroke, GreyPicture& picture);

}  // namespace troupe
