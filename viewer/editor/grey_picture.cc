#include "viewer/editor/grey_picture.h"

#include <algorithm>
#include <cstdlib>

namespace troupe {
namespace {

constexpr std::uint8_t kWhite = 255;

// Calls with each pixel of the straight line, both ends included.
// Bresenham's algorithm, in all octants (J. E. Bresenham, Algorithm for computer control of a digital plotter, 1965).
template <typename Visit>
void VisitLine(Pixel at, const Pixel& to, Visit visit) {
  const int dx = std::abs(to.x - at.x);
  const int dy = -std::abs(to.y - at.y);
  const int step_x = at.x < to.x ? 1 : -1;
  const int step_y = at.y < to.y ? 1 : -1;
  for (int error = dx + dy;;) {
    visit(at);
    if (at.x == to.x && at.y == to.y) return;
    const int twice = 2 * error;
    if (twice >= dy) {
      error += dy;
      at.x += step_x;
    }
    if (twice <= dx) {
      error += dx;
      at.y += step_y;
    }
  }
}

}  // namespace

// All tiles are one shared white tile.
GreyPicture::GreyPicture(int width, int height)
    : width_(width), height_(height), columns_((width + kTile - 1) / kTile) {
  const auto white = std::make_shared<Tile>();
  white->fill(kWhite);
  const int rows = (height + kTile - 1) / kTile;
  tiles_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), white);
}

// By runs of one value: floor plans are mostly white, which costs nothing.
GreyPicture::GreyPicture(const GreyImage& image) : GreyPicture(image.width, image.height) {
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* const row =
        image.values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = 0; x < width_;) {
      int end = x + 1;
      while (end < width_ && row[end] == row[x]) ++end;
      if (row[x] != kWhite) Fill({x, y, end, y + 1}, row[x]);
      x = end;
    }
  }
}

std::uint8_t GreyPicture::value(int x, int y) const {
  return (*tiles_[TileOf(x, y)])[WithinTile(x, y)];
}

// A tile is copied only if a pixel of it really changes.
void GreyPicture::Fill(const PixelBox& box, std::uint8_t value) {
  const PixelBox within{std::max(box.x0, 0), std::max(box.y0, 0), std::min(box.x1, width_), std::min(box.y1, height_)};
  for (int y = within.y0; y < within.y1; ++y) {
    for (int x = within.x0; x < within.x1;) {
      const int end = std::min(within.x1, (x / kTile + 1) * kTile);
      std::shared_ptr<Tile>& tile = tiles_[TileOf(x, y)];
      const std::size_t first = WithinTile(x, y);
      const std::size_t count = static_cast<std::size_t>(end - x);
      const auto is_other = [&](std::uint8_t old) { return old != value; };
      const auto* const begin = tile->data() + first;
      if (std::any_of(begin, begin + count, is_other)) {
        if (tile.use_count() > 1) tile = std::make_shared<Tile>(*tile);
        std::fill_n(tile->data() + first, count, value);
      }
      x = end;
    }
  }
}

GreyImage GreyPicture::Image() const {
  GreyImage image{width_, height_, {}};
  image.values.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) image.values.push_back(value(x, y));
  }
  return image;
}

Bitmap GreyPicture::Occupied(const PixelRule& rule) const {
  Bitmap bitmap(width_, height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (rule.occupied[value(x, y)]) bitmap.set_occupied(x, height_ - 1 - y, true);
    }
  }
  return bitmap;
}

// By the rule of Stage files, as only their bitmaps are edited.
std::optional<PixelBox> GreyPicture::OccupiedBox() const {
  const PixelRule rule = StagePixelRule();
  PixelBox box{width_, height_, 0, 0};
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (!rule.occupied[value(x, y)]) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
  }
  return box.x1 > 0 ? std::optional(box) : std::nullopt;
}

std::size_t GreyPicture::BytesBeyond(const GreyPicture* other) const {
  const bool is_alike = other != nullptr && other->tiles_.size() == tiles_.size();
  std::size_t bytes = tiles_.size() * sizeof(tiles_[0]);
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (!is_alike || other->tiles_[i] != tiles_[i]) bytes += sizeof(Tile);
  }
  return bytes;
}

bool GreyPicture::operator==(const GreyPicture& other) const {
  if (width_ != other.width_ || height_ != other.height_) return false;
  // Values beyond the picture's edge are white in all tiles.
  return std::equal(tiles_.begin(), tiles_.end(), other.tiles_.begin(),
                    [](const auto& a, const auto& b) { return a == b || *a == *b; });
}

// A brush of even width is one pixel wider to the right and below.
void Draw(const PixelStroke& stroke, GreyPicture& picture) {
  const int before = (stroke.width - 1) / 2;
  const int after = stroke.width - before;
  if (stroke.tool == PixelStroke::Tool::kLine) {
    Pixel from = stroke.points.front();
    for (const Pixel& to : stroke.points) {
      VisitLine(from, to, [&](const Pixel& at) {
        picture.Fill({at.x - before, at.y - before, at.x + after, at.y + after}, stroke.value);
      });
      from = to;
    }
    return;
  }
  const auto [x0, x1] = std::minmax(stroke.points[0].x, stroke.points[1].x);
  const auto [y0, y1] = std::minmax(stroke.points[0].y, stroke.points[1].y);
  const PixelBox box{x0, y0, x1 + 1, y1 + 1};
  if (stroke.tool == PixelStroke::Tool::kFilled) {
    picture.Fill(box, stroke.value);
    return;
  }
  const int w = stroke.width;
  picture.Fill({box.x0, box.y0, box.x1, std::min(box.y0 + w, box.y1)}, stroke.value);
  picture.Fill({box.x0, std::max(box.y1 - w, box.y0), box.x1, box.y1}, stroke.value);
  picture.Fill({box.x0, box.y0, std::min(box.x0 + w, box.x1), box.y1}, stroke.value);
  picture.Fill({std::max(box.x1 - w, box.x0), box.y0, box.x1, box.y1}, stroke.value);
}

}  // namespace troupe
