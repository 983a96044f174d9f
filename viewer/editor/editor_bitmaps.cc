// The requests of the page that concern bitmaps: walls that are drawn into the images of floor plans.
//
// A bitmap is stretched so that the box around its occupied pixels has the model's size. A stroke that changes this box
// therefore changes the model's size and origin, too: every other wall stays where it is. While no pixel is occupied,
// the size is that of the whole image.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr int kBitmapDecimals = 6;  // of lengths: the error of a pixel is multiplied by their number
constexpr const char* kPlanColor = "gray30";

bool IsPngName(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending == ".png" || ending == ".PNG";
}

// A name in the folder of the edited file, which no other program reads as something else.
// No path and no hidden file: the page may write beside the edited file only.
Status CheckImageName(const std::string& name) {
  const bool plain = name.size() > 4 && name.size() <= 100 && std::isalnum(static_cast<unsigned char>(name[0])) != 0 &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
                     });
  if (plain && IsPngName(name)) return {};
  return Error{{}, "found the image name " + Quoted(name) + ", expected letters, digits, . - _ and the ending .png"};
}

// The pixels that a model's size belongs to.
PixelBox SizedBox(const GreyPicture& picture) {
  return picture.OccupiedBox().value_or(PixelBox{0, 0, picture.width(), picture.height()});
}

// In m, of a model with this picture and size.
struct PixelSize {
  double x = 0.0;
  double y = 0.0;
};

PixelSize PixelSizeOf(const ModelDescription& model, const PixelBox& box) {
  return {model.size_x / (box.x1 - box.x0), model.size_y / (box.y1 - box.y0)};
}

// A model whose size follows the occupied pixels.
struct ResizedModel {
  int line = 0;
  int column = 0;
  Value size;
  Value origin;
};

ResizedModel Resized(const EditedEntity& entity, const ModelDescription& model, const FileUnits& units,
                     const PixelBox& before, const PixelBox& after) {
  const PixelSize pixel = PixelSizeOf(model, before);
  const Pose X_MD = OriginOf(*entity.node, units);
  // The middle moves in frame D, whose y points up.
  const double x = 0.5 * pixel.x * (after.x0 + after.x1 - before.x0 - before.x1);
  const double y = -0.5 * pixel.y * (after.y0 + after.y1 - before.y0 - before.y1);
  const Vec2 middle = Transform2(X_MD) * Vec2(x, y);
  const std::vector<double> size{pixel.x * (after.x1 - after.x0) / units.metres,
                                 pixel.y * (after.y1 - after.y0) / units.metres, model.size_z / units.metres};
  const std::vector<double> origin{middle.x() / units.metres, middle.y() / units.metres, X_MD.z / units.metres,
                                   X_MD.heading / units.radians};
  return {0, 0, ChangedTuple(NumbersOf(*entity.node, "size"), size, kBitmapDecimals),
          ChangedTuple(NumbersOf(*entity.node, "origin"), origin, kBitmapDecimals)};
}

void VisitNodes(const WorldNode& node, const std::function<void(const WorldNode&)>& visit) {
  visit(node);
  for (const WorldNode& child : node.children) VisitNodes(child, visit);
}

// Alternating runs of free and occupied pixels, by rows from the top. The error is another number of pixels.
Status FillRuns(const std::vector<std::int64_t>& runs, GreyPicture& picture) {
  const std::int64_t width = picture.width();
  const std::int64_t all = width * picture.height();
  const Error wrong{{}, fmt::format("found runs of another number of pixels, expected {}", all)};
  std::int64_t at = 0;
  bool is_occupied = false;
  for (const std::int64_t run : runs) {
    if (run < 0 || run > all - at) return wrong;
    for (std::int64_t left = run; is_occupied && left > 0;) {
      const std::int64_t start = at + run - left;
      const std::int64_t part = std::min(left, width - start % width);
      const int y = static_cast<int>(start / width);
      const int x = static_cast<int>(start % width);
      picture.Fill({x, y, x + static_cast<int>(part), y + 1}, 0);
      left -= part;
    }
    at += run;
    is_occupied = !is_occupied;
  }
  return at == all ? Status() : Status(wrong);
}

}  // namespace

std::optional<std::string> Editor::ImageOf(const WorldNode& node) const {
  const auto* const name = node.FindContent<std::string>("bitmap");
  if (name == nullptr) return std::nullopt;
  return allowed_.Resolve(FindFile(*name, world_->tree.directory, node.Find("bitmap")->value.where.file));
}

std::set<std::string> Editor::NamedImages() const {
  std::set<std::string> images;
  if (world_ == nullptr) return images;
  VisitNodes(world_->tree.world, [&](const WorldNode& node) {
    if (std::optional<std::string> image = ImageOf(node)) images.insert(std::move(*image));
  });
  return images;
}

// Each refusal has its reason, for the page's tool tip.
Result<std::string> Editor::DrawableImage(const EditedEntity& entity) const {
  const std::string name = Quoted(entity.name);
  if (kind_ == EditedKind::kScenario) {
    return Error{{}, "a scenario draws into no bitmap: edit the world file that it names"};
  }
  if (const Result<Place> place = PlaceOf(entity); !place.ok()) return place.error();
  if (entity.node->Find("bitmap") == nullptr) {
    const bool is_map = entity.node->Find("map_yaml") != nullptr;
    return Error{{},
                 is_map ? name + " is a ROS map; only the image of a 'bitmap' is drawn into"
                        : name + " has no bitmap, expected a model that has one"};
  }
  const bool has_blocks = std::any_of(entity.node->children.begin(), entity.node->children.end(),
                                      [](const WorldNode& child) { return child.type == "block"; });
  if (has_blocks || entity.type == "gripper") {
    return Error{{},
                 name +
                     " has blocks that are fitted to its size together with the bitmap; draw into a model of "
                     "its own"};
  }
  const ModelDescription& model = world_->loaded.world.model(entity.model);
  if (!(model.size_x > 0.0 && model.size_y > 0.0)) return Error{{}, name + " has a size of 0, expected a larger one"};
  const std::optional<std::string> image = ImageOf(*entity.node);
  if (!image) return Error{{}, "the bitmap of " + name + " may not be read"};
  if (!IsPngName(*image)) {
    return Error{{*image}, "found a bitmap of another format, expected a .png: it is the only one that is written"};
  }
  const std::string folder = DirectoryOf(std::filesystem::weakly_canonical(path()).string());
  AllowedPaths beside;
  beside.Add(folder);
  if (!first_images_.contains(*image) && !beside.Resolve(*image)) {
    return Error{{*image}, "the image is neither in the folder of the edited file nor named by it when it was opened"};
  }
  return *image;
}

// {"bitmaps": [{"name", "file", "refusal": why it cannot be drawn into, or empty, "width", "height": pixels, "pixel":
// [x, y] in m, "corner": [x, y, z, heading] of the image's upper left corner in the world, m and rad}]}
Result<Json> Editor::Execute(const edit::Bitmaps&) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  Json bitmaps = Json::array();
  const FileUnits units = UnitsOf(world_->tree.world);
  for (const EditedEntity& entity : world_->entities) {
    if (entity.node->Find("bitmap") == nullptr) continue;
    Json row = {{"name", entity.name}, {"file", ""}, {"refusal", ""}};
    const Result<std::string> image = DrawableImage(entity);
    const Status opened = image.ok() ? file_.pictures().Open(image.value()) : Status(image.error());
    if (!opened.ok()) {
      row["refusal"] = opened.error().message;
      bitmaps.push_back(std::move(row));
      continue;
    }
    const PicturePointer picture = file_.Picture(image.value());
    if (picture == nullptr) continue;
    const PixelBox box = SizedBox(*picture);
    const ModelDescription& model = world_->loaded.world.model(entity.model);
    const PixelSize pixel = PixelSizeOf(model, box);
    const Pose X_WD = PoseInWorld(world_->loaded.world, entity.model) * OriginOf(*entity.node, units);
    const Pose corner = X_WD * Pose{-0.5 * (box.x0 + box.x1) * pixel.x, 0.5 * (box.y0 + box.y1) * pixel.y, 0.0, 0.0};
    row["file"] = std::filesystem::path(image.value()).filename().string();
    row["width"] = picture->width();
    row["height"] = picture->height();
    row["pixel"] = {pixel.x, pixel.y};
    row["corner"] = {corner.x, corner.y, corner.z, corner.heading};
    bitmaps.push_back(std::move(row));
  }
  return Json{{"bitmaps", std::move(bitmaps)}};
}

// A model whose image is all free, or has the pixels of a picture; it is written when the file is saved.
Result<Json> Editor::Execute(const edit::CreateBitmap& operation) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (kind_ != EditedKind::kWorld) return Error{{}, "a new bitmap belongs to a world file (.world)"};
  // The tolerance keeps 10 m of 0.1 m from becoming 101 pixels by rounding.
  const auto& [file, size, pixel, pose, runs] = operation;
  if (Status wrong = CheckImageName(file); !wrong.ok()) return wrong.error();
  const double columns = std::ceil(size[0] / pixel - 1e-6);
  const double rows = std::ceil(size[1] / pixel - 1e-6);
  if (!(columns >= 1.0 && rows >= 1.0 && columns * rows <= static_cast<double>(kMaxGreyPixels))) {
    return Error{
        {}, fmt::format("found an image of {:.0f} x {:.0f} pixels, expected 1 to {}", columns, rows, kMaxGreyPixels)};
  }
  const std::string wanted = (std::filesystem::path(DirectoryOf(path())) / file).lexically_normal().string();
  const std::optional<std::string> image = allowed_.Resolve(FindFile(file, world_->tree.directory, path()));
  if (!image || image != allowed_.Resolve(wanted) || NamedImages().contains(*image))
    return Error{{}, "found the image name " + Quoted(file) + " in use, expected a new one"};
  if (Status failure = file_.pictures().Create(*image); !failure.ok()) return failure.error();
  PictureVersions versions = file_.versions();
  auto picture = std::make_shared<GreyPicture>(static_cast<int>(columns), static_cast<int>(rows));
  if (!runs.empty()) {
    if (Status wrong = FillRuns(runs, *picture); !wrong.ok()) return wrong.error();
  }
  const PixelBox box = SizedBox(*picture);
  versions[*image] = picture;

  const FileUnits units = UnitsOf(world_->tree.world);
  const std::string name = FreeName(std::filesystem::path(file).stem().string());
  WrittenModel model{"model", {}, {}};
  model.Set("name", Text(name));
  model.Set("pose", ChangedPose({}, pose, units));
  const double metre = 1.0 / units.metres;
  const double metres = pixel * metre;
  model.Set("size", Tuple({metres * (box.x1 - box.x0), metres * (box.y1 - box.y0), size[2] * metre}, kBitmapDecimals));
  // Its middle is that of the image.
  const double x = 0.5 * metres * (box.x0 + box.x1 - picture->width());
  const double y = 0.5 * metres * (picture->height() - box.y0 - box.y1);
  if (x != 0.0 || y != 0.0) model.Set("origin", Tuple({x, y, 0.0, 0.0}, kBitmapDecimals));
  model.Set("color", Text(kPlanColor));
  model.Set("bitmap", Text(file));
  Result<std::string> added = WithAdded(text(), model, false);
  if (!added.ok()) return added.error();
  const Status failure = Commit(std::move(added).value(), versions, "the new bitmap " + file);
  if (!failure.ok()) return failure.error();
  return Json{{"name", name}};
}

// All models with this image change, not only the one that is drawn into: their sizes are stretched over the same
// pixels.
Result<std::string> Editor::WithPixelsInPlace(const std::string& image, const GreyPicture& before,
                                              const GreyPicture& after) const {
  const PixelBox old_box = SizedBox(before);
  const PixelBox new_box = SizedBox(after);
  if (old_box == new_box) return text();
  const FileUnits units = UnitsOf(world_->tree.world);
  std::vector<ResizedModel> resized;
  std::optional<Error> refusal;
  VisitNodes(world_->tree.world, [&](const WorldNode& node) {
    if (refusal || ImageOf(node) != image) return;
    const auto entity = std::find_if(world_->entities.begin(), world_->entities.end(),
                                     [&](const EditedEntity& each) { return each.node == &node; });
    if (entity == world_->entities.end()) {
      refusal = Error{node.where, "the image is also the body of a part here, whose size would change"};
      return;
    }
    if (const Result<std::string> drawable = DrawableImage(*entity); !drawable.ok()) {
      refusal = Error{{}, "the image is also that of " + Quoted(entity->name) + ": " + drawable.error().ToString()};
      return;
    }
    const Result<Place> place = PlaceOf(*entity);
    ResizedModel model = Resized(*entity, world_->loaded.world.model(entity->model), units, old_box, new_box);
    model.line = place.value().statement->line;
    model.column = place.value().statement->column;
    resized.push_back(std::move(model));
  });
  if (refusal) return *refusal;
  // From the last to the first, so that none moves before its turn.
  std::sort(resized.begin(), resized.end(), [](const ResizedModel& a, const ResizedModel& b) {
    return std::pair(a.line, a.column) > std::pair(b.line, b.column);
  });
  std::string changed = text();
  for (const ResizedModel& model : resized) {
    StageBodyEdit edit(changed, path(), model.line, model.column);
    if (Status failure = edit.Set("size", model.size); !failure.ok()) return failure.error();
    if (Status failure = edit.Set("origin", model.origin); !failure.ok()) return failure.error();
    changed = edit.text();
  }
  return changed;
}

// A stroke that changes no pixel is no state of the history.
Result<Json> Editor::Execute(const edit::DrawBitmap& operation) {
  const Result<const EditedEntity*> entity = FindEntity(operation.name);
  if (!entity.ok()) return entity.error();
  const Result<std::string> image = DrawableImage(*entity.value());
  if (!image.ok()) return image.error();
  if (Status failure = file_.pictures().Open(image.value()); !failure.ok()) return failure.error();
  const PicturePointer before = file_.Picture(image.value());
  if (before == nullptr) return Error{{image.value()}, "found no image, expected one"};
  auto after = std::make_shared<GreyPicture>(*before);
  Draw(operation.stroke, *after);
  if (*after == *before) return Json{{"changed", false}};
  Result<std::string> changed = WithPixelsInPlace(image.value(), *before, *after);
  if (!changed.ok()) return changed.error();
  PictureVersions versions = file_.versions();
  versions[image.value()] = std::move(after);
  const std::string file = std::filesystem::path(image.value()).filename().string();
  const char* const what = operation.stroke.value == 0 ? "the walls in " : "the erasure in ";
  if (Status failure = Commit(std::move(changed).value(), versions, what + file); !failure.ok()) return failure.error();
  return Json{{"changed", true}};
}

}  // namespace troupe
