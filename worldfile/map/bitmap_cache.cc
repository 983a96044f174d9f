// The parts of map_yaml.h that read no YAML: the world of a map, and the bitmaps that a world names.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "worldfile/map/map_yaml.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Null if there is none.
const std::shared_ptr<const BitmapRectangles>* Find(const KnownBitmaps& bitmaps, const std::string& path,
                                                    const PixelRule& rule) {
  const auto [begin, end] = bitmaps.equal_range(path);
  const auto found = std::find_if(begin, end, [&](const auto& entry) { return entry.second.rule == rule; });
  return found != end ? &found->second.content : nullptr;
}

}  // namespace

Result<MapYaml> ReadMapYaml(const std::string& path, const SourceLocation& where, const AllowedPaths& allowed) {
  const Result<std::string> text = ReadTextFile(path, where, allowed);
  if (!text.ok()) return text.error();
  return ReadMapYamlText(text.value(), path);
}

WorldTree MapYamlTree(const std::string& path) {
  const SourceLocation where{path};
  const auto property = [&](const std::string& name, const std::string& text) {
    return Property{name, Value{text, where}, where};
  };
  WorldTree tree;
  tree.world.type = "world";
  tree.world.where = where;
  tree.directory = DirectoryOf(path);
  tree.files.push_back(path);
  WorldNode map;
  map.type = "model";
  map.where = where;
  map.properties = {property("name", "map"), property("map_yaml", std::filesystem::path(path).filename().string()),
                    property("color", "gray30")};
  tree.world.children.Add(std::move(map));
  return tree;
}

BitmapRectangles CoverOf(Bitmap bitmap) {
  BitmapRectangles result;
  result.width = bitmap.width();
  result.height = bitmap.height();
  const std::size_t pixels = static_cast<std::size_t>(bitmap.width()) * static_cast<std::size_t>(bitmap.height());
  auto list = CoverByRectangles(bitmap, std::max(kFewRectangles, pixels / kPixelsPerRectangle));
  if (list) {
    result.rectangles = std::move(*list);
  } else {
    result.dense = std::make_shared<const DenseCover>(std::move(bitmap));
  }
  return result;
}

PixelRectangle BitmapRectangles::bounds() const {
  if (dense != nullptr) return dense->bounds();
  PixelRectangle box = rectangles.front();
  for (const PixelRectangle& r : rectangles) {
    box = {std::min(box.x0, r.x0), std::min(box.y0, r.y0), std::max(box.x1, r.x1), std::max(box.y1, r.y1)};
  }
  return box;
}

Result<const BitmapRectangles*> BitmapCache::Load(const std::string& path, const PixelRule& rule,
                                                  const SourceLocation& where) {
  if (const auto* const found = Find(by_path_, path, rule)) return found->get();
  Result<std::shared_ptr<const BitmapRectangles>> read = Read(path, rule, where);
  if (!read.ok()) return read.error();
  return by_path_.emplace(path, KnownBitmap{rule, std::move(read).value()})->second.content.get();
}

const BitmapRectangles* BitmapCache::Keep(const std::string& path, Bitmap pixels) {
  const PixelRule none;
  if (const auto* const found = Find(by_path_, path, none)) return found->get();
  auto cover = std::make_shared<const BitmapRectangles>(CoverOf(std::move(pixels)));
  return by_path_.emplace(path, KnownBitmap{none, std::move(cover)})->second.content.get();
}

Result<std::shared_ptr<const BitmapRectangles>> BitmapCache::Read(const std::string& path, const PixelRule& rule,
                                                                  const SourceLocation& where) const {
  const std::optional<std::string> resolved = allowed_.Resolve(path);
  if (!resolved) return Error{where, "bitmap: " + NotAllowed(path, allowed_)};
  // Before the known ones: a given image may differ from the file of its path, and from the one given earlier.
  if (std::optional<Bitmap> given = source_ ? source_(*resolved, rule) : std::nullopt) {
    return std::make_shared<const BitmapRectangles>(CoverOf(std::move(*given)));
  }
  if (const auto* const found = known_ != nullptr ? Find(*known_, *resolved, rule) : nullptr) return *found;
  Result<Bitmap> bitmap = ReadBitmap(*resolved, rule);
  if (!bitmap.ok()) return Error{where, "bitmap " + QuotedPath(path) + ": " + bitmap.error().message};
  auto read = std::make_shared<const BitmapRectangles>(CoverOf(std::move(bitmap).value()));
  // Given images do not go in: KnownBitmaps are the contents of files.
  if (known_ != nullptr) known_->emplace(*resolved, KnownBitmap{rule, read});
  return read;
}

std::vector<std::string> BitmapCache::Paths() const {
  std::vector<std::string> paths;
  for (const auto& [path, entry] : by_path_) {
    if (paths.empty() || paths.back() != path) paths.push_back(path);
  }
  return paths;
}

std::pair<int, int> BitmapCache::LargestSize() const {
  const auto pixels = [](const std::pair<int, int>& size) {
    return static_cast<std::int64_t>(size.first) * static_cast<std::int64_t>(size.second);
  };
  std::pair<int, int> largest;
  for (const auto& [path, entry] : by_path_) {
    const std::pair<int, int> size(entry.content->width, entry.content->height);
    if (pixels(size) > pixels(largest)) largest = size;
  }
  return largest;
}

}  // namespace troupe
