#include "viewer/gateway/edit_operation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "common/base/json.h"
#include "troupe/polygon.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr double kLargest = 1e6;  // of world files
constexpr std::size_t kMaxBlocks = 200;
constexpr std::size_t kMaxCorners = 1000;
constexpr std::size_t kMaxProperties = 100;
constexpr std::size_t kMaxPath = 20;            // of a part
constexpr std::size_t kMaxPoints = 5000;        // of a stroke
constexpr int kFarthest = 100'000;              // pixels
constexpr int kWidest = 500;                    // pixels
constexpr std::int64_t kMaxWork = 100'000'000;  // pixels that a stroke fills, some of them again
constexpr double kMinPixel = 0.001;             // m
constexpr std::uint8_t kOccupied = 0;
constexpr std::uint8_t kFreed = 255;
constexpr std::size_t kMaxRuns = 500'000;
constexpr std::size_t kDeepest = 4;  // objects around a member
constexpr int kMaxLevels = 50;       // of lists and objects in a value

// True if lists and objects are inside each other more than `levels` times. They are written by recursion.
bool IsDeeper(const Json& value, int levels) {
  if (!value.is_structured()) return false;
  return levels == 0 ||
         std::any_of(value.begin(), value.end(), [&](const Json& item) { return IsDeeper(item, levels - 1); });
}

// JSON on one line, with the blanks that people write.
std::string SpacedJson(const Json& value) {
  if (!value.is_array() && !value.is_object()) return JsonText(value);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += ", ";
    text += (value.is_object() ? JsonText(Json(key)) + ": " : "") + SpacedJson(item);
  }
  return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

// A name, perhaps with an index: "point[0]".
bool IsPropertyName(std::string_view name) {
  if (name.empty() || name.size() > 100 || std::isalpha(static_cast<unsigned char>(name[0])) == 0) return false;
  if (name == "include" || name == "define") return false;
  const std::size_t open = name.find('[');
  const std::string_view word = name.substr(0, open);
  const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
  if (open == std::string_view::npos || !plain) return plain;
  const std::string_view index = name.substr(open + 1, name.size() - open - 2);
  return name.back() == ']' && !index.empty() && index.size() < 5 &&
         std::all_of(index.begin(), index.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// The name of a type or a define: without an index.
bool IsTypeName(std::string_view name) {
  return IsPropertyName(name) && name.find('[') == std::string_view::npos;
}

// Reads the members of one request. The first error is kept; after it values are of no use.
class Decoder {
 public:
  explicit Decoder(const Json& request) : request_(request) {}

  Result<EditOperation> Decode() {
    const std::string op = Text("op");
    for (const auto& [name, decode] : kOperations) {
      if (op == name) return Outcome((this->*decode)());
    }
    return BadInput("found the operation " + Quoted(op) + ", expected one of the editor");
  }

 private:
  using Method = EditOperation (Decoder::*)();

  Result<EditOperation> Outcome(EditOperation operation) {
    if (error_) return *error_;
    return operation;
  }
  void Fail(std::string message) { Fail(BadInput(std::move(message))); }
  void Fail(const Error& error) {
    if (!error_) error_ = error;
  }
  // The error, or an empty value.
  template <typename T>
  T ValueOf(Result<T> result) {
    if (result.ok()) return std::move(result).value();
    Fail(result.error());
    return {};
  }

  // Empty without one.
  std::string Text(const char* key) const {
    const auto member = request_.find(key);
    return member != request_.end() && member->is_string() ? member->get<std::string>() : std::string();
  }
  bool Flag(const char* key) const {
    const auto member = request_.find(key);
    return member != request_.end() && *member == true;
  }

  // A number of a list.
  static std::optional<std::size_t> Index(const Json& value) {
    if (!value.is_number_integer() || value < 0) return std::nullopt;
    return value.get<std::size_t>();
  }

  // Finite and within the bounds of world files.
  static std::optional<double> Number(const Json& value) {
    if (!value.is_number()) return std::nullopt;
    const double number = value.get<double>();
    return std::isfinite(number) && std::abs(number) <= kLargest ? std::optional(number) : std::nullopt;
  }

  double NumberOr(const char* key, double otherwise) const {
    const auto member = request_.find(key);
    return member != request_.end() ? Number(*member).value_or(otherwise) : otherwise;
  }

  static std::optional<std::vector<double>> Numbers(const Json& object, const char* key, std::size_t count) {
    const auto member = object.find(key);
    if (member == object.end() || !member->is_array() || member->size() != count) return std::nullopt;
    std::vector<double> numbers;
    for (const Json& value : *member) {
      const std::optional<double> number = Number(value);
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
    return numbers;
  }

  static std::optional<Pose> PoseIn(const Json& object) {
    const auto numbers = Numbers(object, "pose", 4);
    if (!numbers) return std::nullopt;
    return Pose{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
  }

  static Result<std::vector<DrawnBlock>> Blocks(const Json& object) {
    const auto list = object.find("blocks");
    const Error malformed =
        BadInput("found blocks of another form, expected outlines of 3 to 1000 corners with heights");
    if (list == object.end() || !list->is_array() || list->size() > kMaxBlocks) return malformed;
    std::vector<DrawnBlock> blocks;
    for (const Json& each : *list) {
      if (!each.is_object() || !each.contains("outline") || !each["outline"].is_array()) return malformed;
      const Json& outline = each["outline"];
      const auto z = Numbers(each, "z", 2);
      if (outline.size() < 3 || outline.size() > kMaxCorners || !z) return malformed;
      DrawnBlock block{{}, (*z)[0], (*z)[1]};
      if (block.z_max <= block.z_min)
        return BadInput("found a block without height, expected its top above its underside");
      for (const Json& corner : outline) {
        if (!corner.is_array() || corner.size() != 2) return malformed;
        const auto x = Number(corner[0]);
        const auto y = Number(corner[1]);
        if (!x || !y) return malformed;
        block.outline.emplace_back(*x, *y);
      }
      if (const Result<Polygon> simple = Normalized(block.outline); !simple.ok()) {
        return BadInput("found a block that is no simple polygon: " + simple.error().message);
      }
      blocks.push_back(std::move(block));
    }
    return blocks;
  }

  PropertyChange Change() {
    PropertyChange change{Text("property"), {}};
    if (!IsPropertyName(change.property)) Fail("found the property " + Quoted(change.property) + ", expected a name");
    const auto given = request_.find("value");
    if (given != request_.end() && given->is_string()) change.value = ValueOf(ReadValueText(given->get<std::string>()));
    return change;
  }

  // `key`: of the object of properties; without one there are none.
  WrittenProperties Properties(const char* key) {
    WrittenProperties properties;
    const auto given = request_.find(key);
    if (given == request_.end()) return properties;
    if (!given->is_object() || given->size() > kMaxProperties) {
      Fail("found no object of properties");
      return properties;
    }
    for (const auto& [name, text] : given->items()) {
      if (!IsPropertyName(name) || !text.is_string()) {
        Fail("found the property " + Quoted(name) + ", expected a text");
        break;
      }
      Result<Value> value = ReadValueText(text.get<std::string>());
      if (!value.ok()) {
        Fail(Quoted(name) + ": " + value.error().message);
        break;
      }
      properties.emplace_back(name, std::move(value).value());
    }
    return properties;
  }

  std::string Prefix() {
    std::string prefix = Text("name");
    if (const Status wrong = CheckName(prefix); !wrong.ok()) Fail(wrong.error());
    return prefix;
  }

  // Nothing: the path is not one.
  static std::optional<PartPath> Path(const Json& list) {
    if (!list.is_array() || list.size() > kMaxPath) return std::nullopt;
    PartPath path;
    for (const Json& step : list) {
      const std::optional<std::size_t> index = Index(step);
      if (!index) return std::nullopt;
      path.push_back(*index);
    }
    return path;
  }

  PartShape Shape(bool may_be_empty) {
    Result<PartShape> shape = ReadShape(may_be_empty);
    return ValueOf(std::move(shape));
  }

  Result<PartShape> ReadShape(bool may_be_empty) const {
    PartShape shape;
    const auto given = request_.find("shape");
    if (given == request_.end() && may_be_empty) return shape;
    if (given == request_.end() || !given->is_object()) return BadInput("found no shape, expected an object");
    std::size_t read = 0;
    if (given->contains("pose")) {
      shape.pose = PoseIn(*given);
      if (!shape.pose) return BadInput("found no pose, expected four finite numbers");
      ++read;
    }
    for (const auto& [key, count, target] : {std::tuple("size", 3U, &shape.size),
                                             {"paddle", 3U, &shape.paddle},
                                             {"axis", 3U, &shape.axis},
                                             {"limits", 2U, &shape.limits}}) {
      if (!given->contains(key)) continue;
      *target = Numbers(*given, key, count);
      ++read;
      if (!*target) {
        return BadInput("found no " + Quoted(key) + ", expected " + std::to_string(count) + " finite numbers");
      }
    }
    const auto is_positive = [](double length) { return length > 0.0; };
    for (const auto* const lengths : {&shape.size, &shape.paddle}) {
      if (*lengths && !std::all_of((*lengths)->begin(), (*lengths)->end(), is_positive))
        return BadInput("found a size that is not above 0, expected lengths");
    }
    if (shape.axis && std::hypot((*shape.axis)[0], (*shape.axis)[1], (*shape.axis)[2]) < 1e-6)
      return BadInput("found the axis [0 0 0], expected a direction");
    if (given->contains("blocks")) {
      Result<std::vector<DrawnBlock>> blocks = Blocks(*given);
      if (!blocks.ok()) return blocks.error();
      if (blocks.value().empty()) return BadInput("found no blocks, expected one or more");
      shape.blocks = std::move(blocks).value();
      ++read;
    }
    if (read != given->size() || (read == 0 && !may_be_empty))
      return BadInput("found another shape, expected pose, size, paddle, axis, limits or blocks");
    return shape;
  }

  Result<GripperRoles> ReadRoles() const {
    constexpr std::array kRoles{"left_finger", "right_finger", "left_pad", "right_pad", "lift"};
    const auto given = request_.find("roles");
    if (given == request_.end() || !given->is_object() || given->empty())
      return BadInput("found no roles, expected an object");
    GripperRoles roles;
    for (const auto& [role, list] : given->items()) {
      if (std::find(kRoles.begin(), kRoles.end(), role) == kRoles.end())
        return BadInput("found the role " + Quoted(role) + ", expected one of a gripper");
      std::optional<PartPath> path;
      if (!list.is_null()) {
        path = Path(list);
        if (!path || path->empty()) return BadInput("found no part of that number");
      }
      roles.emplace_back(role, std::move(path));
    }
    return roles;
  }

  static std::optional<int> PixelNumber(const Json& value) {
    if (!value.is_number_integer() || std::abs(value.get<double>()) > kFarthest) return std::nullopt;
    return value.get<int>();
  }

  static std::int64_t WorkOf(const PixelStroke& stroke) {
    if (stroke.tool != PixelStroke::Tool::kLine) return 0;  // at most the picture, twice
    std::int64_t steps = 1;
    for (std::size_t i = 1; i < stroke.points.size(); ++i) {
      steps += std::max(std::abs(stroke.points[i].x - stroke.points[i - 1].x),
                        std::abs(stroke.points[i].y - stroke.points[i - 1].y));
    }
    return steps * stroke.width * stroke.width;
  }

  Result<PixelStroke> ReadStroke() const {
    PixelStroke stroke;
    const std::string tool = Text("tool");
    if (tool == "frame") {
      stroke.tool = PixelStroke::Tool::kFrame;
    } else if (tool == "filled") {
      stroke.tool = PixelStroke::Tool::kFilled;
    } else if (tool != "line") {
      return BadInput("found the tool " + Quoted(tool) + ", expected line, frame or filled");
    }
    const auto width = request_.find("width");
    const std::optional<int> brush = width != request_.end() ? PixelNumber(*width) : std::nullopt;
    if (!brush || *brush < 1 || *brush > kWidest)
      return BadInput("found no width of a brush, expected 1 to 500 pixels");
    stroke.width = *brush;
    stroke.value = Flag("erase") ? kFreed : kOccupied;
    const auto points = request_.find("points");
    const Error malformed = BadInput("found no points, expected 1 to 5000 of two whole numbers within 100000 pixels");
    if (points == request_.end() || !points->is_array() || points->empty() || points->size() > kMaxPoints)
      return malformed;
    for (const Json& point : *points) {
      if (!point.is_array() || point.size() != 2) return malformed;
      const std::optional<int> x = PixelNumber(point[0]);
      const std::optional<int> y = PixelNumber(point[1]);
      if (!x || !y) return malformed;
      stroke.points.push_back({*x, *y});
    }
    if (stroke.tool != PixelStroke::Tool::kLine && stroke.points.size() != 2)
      return BadInput("found another number of points, expected the two corners of a rectangle");
    if (WorkOf(stroke) > kMaxWork) return BadInput("found a stroke that is too long for so wide a brush");
    return stroke;
  }

  // The operations.
  template <typename Operation>
  EditOperation Plain() {
    return Operation();
  }
  template <typename Operation>
  EditOperation Named() {
    Operation operation;
    operation.name = Text("name");
    return operation;
  }

  EditOperation SetText() {
    if (!request_.contains("text") || !request_["text"].is_string()) Fail("found no text");
    return edit::SetText{Text("text")};
  }
  EditOperation Save() { return edit::Save{Flag("overwrite")}; }
  EditOperation SetPose() {
    const std::optional<Pose> pose = PoseIn(request_);
    if (!pose) Fail("found no pose, expected four finite numbers");
    return edit::SetPose{Text("name"), pose.value_or(Pose())};
  }
  EditOperation SetProperty() { return edit::SetProperty{Text("name"), Change()}; }
  EditOperation SetMember() {
    edit::SetMember operation{Text("name"), {}, Text("key"), {}};
    if (!IsPropertyName(operation.key)) Fail("found the key " + Quoted(operation.key) + ", expected a name");
    if (const auto inside = request_.find("inside"); inside != request_.end()) {
      if (!inside->is_array() || inside->size() > kDeepest) Fail("found no keys, expected at most 4");
      for (const Json& key : *inside) {
        if (!key.is_string() || !IsPropertyName(key.get<std::string>())) {
          Fail("found a key that is no name");
          break;
        }
        operation.inside.push_back(key.get<std::string>());
      }
    }
    const auto value = request_.find("value");
    if (value != request_.end() && IsDeeper(*value, kMaxLevels)) {
      Fail("found lists or objects more than 50 deep");
    } else if (value != request_.end() && !value->is_null()) {
      operation.value = SpacedJson(*value);
    }
    return operation;
  }
  EditOperation Rename() {
    edit::Rename operation{Text("name"), Text("to")};
    if (const Status wrong = CheckName(operation.to); !wrong.ok()) Fail(wrong.error());
    return operation;
  }

  EditOperation AddModel() {
    edit::AddModel operation;
    operation.blocks = ValueOf(Blocks(request_));
    const std::optional<Pose> pose = PoseIn(request_);
    if (!pose || operation.blocks.empty()) Fail("found no pose or no blocks");
    operation.pose = pose.value_or(Pose());
    operation.properties = Properties("properties");
    operation.prefix = Prefix();
    return operation;
  }

  EditOperation SetModel() {
    edit::SetModel operation{Text("name"), Text("base"), {}, {}, {}};
    if (!IsTypeName(operation.name)) {
      Fail("found the name " + Quoted(operation.name) + ", expected a letter, then letters, digits, . - _");
    }
    if (!operation.base.empty() && !IsTypeName(operation.base)) {
      Fail("found the base " + Quoted(operation.base) + ", expected a model");
    }
    if (request_.contains("blocks")) operation.blocks = ValueOf(Blocks(request_));
    operation.properties = Properties("properties");
    const auto removed = request_.find("remove");
    if (removed == request_.end() || !removed->is_array()) return operation;
    for (const Json& name : *removed) {
      if (name.is_string()) operation.removed.push_back(name.get<std::string>());
    }
    return operation;
  }

  EditOperation ChangePart() {
    const std::string action = Text("action");
    if (action == "set") return OfPart(edit::SetPartProperty{{}, Change()});
    if (action == "remove") return OfPart(edit::RemovePart());
    if (action == "shape") return OfPart(edit::ShapePart{{}, Shape(false)});
    if (action == "roles") return OfPart(edit::SetGripperRoles{{}, ValueOf(ReadRoles())});
    if (action != "add") Fail("found the action " + Quoted(action) + ", expected set, add, remove, shape or roles");
    edit::AddPart operation;
    operation.type = Text("kind");
    if (!IsTypeName(operation.type)) Fail("found the part " + Quoted(operation.type) + ", expected a type of model");
    operation.properties = Properties("properties");
    operation.shape = Shape(true);
    if (!Text("name").empty()) operation.prefix = Prefix();
    const auto sensor = request_.find("sensor");
    if (sensor != request_.end() && sensor->is_object()) operation.sensor = Properties("sensor");
    return OfPart(std::move(operation));
  }

  template <typename Operation>
  EditOperation OfPart(Operation operation) {
    operation.model = Text("model");
    if (const auto list = request_.find("part"); list != request_.end()) {
      std::optional<PartPath> path = Path(*list);
      if (!path) Fail("found no part of that number");
      operation.part = std::move(path).value_or(PartPath());
    }
    return operation;
  }

  EditOperation CreateBitmap() {
    edit::CreateBitmap operation;
    operation.file = Text("file");
    operation.size = Numbers(request_, "size", 3).value_or(std::vector<double>(3));
    operation.pixel = NumberOr("pixel", 0.0);
    const std::optional<Pose> pose = PoseIn(request_);
    if (!pose || !(operation.pixel >= kMinPixel) || !(operation.size[2] > 0.0)) {
      Fail("found no size, pixel or pose, expected lengths in m, and pixels of at least 0.001 m");
    }
    operation.pose = pose.value_or(Pose());
    if (const auto runs = request_.find("runs"); runs != request_.end()) {
      const bool are_counts =
          runs->is_array() && runs->size() <= kMaxRuns &&
          std::all_of(runs->begin(), runs->end(), [](const Json& run) { return Index(run).has_value(); });
      if (!are_counts) {
        Fail("found no runs of pixels, expected at most 500000 counts");
      } else {
        operation.runs = runs->get<std::vector<std::int64_t>>();
      }
    }
    return operation;
  }
  EditOperation DrawBitmap() { return edit::DrawBitmap{Text("name"), ValueOf(ReadStroke())}; }

  EditOperation SetRegion() {
    edit::SetRegion operation;
    if (const auto index = request_.find("index"); index != request_.end()) operation.index = Index(*index);
    const auto rule = request_.find("rule");
    if (rule == request_.end() || rule->is_null()) {
      if (!operation.index) Fail("found no rule");
      return operation;
    }
    if (!rule->is_object() || IsDeeper(*rule, kMaxLevels)) {
      Fail("found no rule, expected an object");
      return operation;
    }
    // In the order in which rules are written by hand.
    constexpr std::array kFirst{"model", "count", "region"};
    std::vector<edit::SetRegion::Member>& members = operation.rule.emplace();
    const auto add = [&](const std::string& key, const Json& value) { members.push_back({key, SpacedJson(value)}); };
    for (const char* key : kFirst) {
      if (rule->contains(key)) add(key, rule->at(key));
    }
    for (const auto& [key, value] : rule->items()) {
      if (std::find(kFirst.begin(), kFirst.end(), key) == kFirst.end()) add(key, value);
    }
    return operation;
  }

  EditOperation Test() {
    edit::Test operation;
    operation.model = Text("model");
    operation.probe_height = NumberOr("probe_height", operation.probe_height);
    return operation;
  }

  static const std::pair<std::string_view, Method> kOperations[25];

  const Json& request_;
  std::optional<Error> error_;
};

constexpr std::pair<std::string_view, Decoder::Method> Decoder::kOperations[25] = {
    {"document", &Decoder::Plain<edit::Document>},
    {"text", &Decoder::Plain<edit::Text>},
    {"palette", &Decoder::Plain<edit::Palette>},
    {"help", &Decoder::Plain<edit::Help>},
    {"bitmaps", &Decoder::Plain<edit::Bitmaps>},
    {"entity", &Decoder::Named<edit::Entity>},
    {"model", &Decoder::Named<edit::Model>},
    {"set_text", &Decoder::SetText},
    {"save", &Decoder::Save},
    {"reload", &Decoder::Plain<edit::Reload>},
    {"undo", &Decoder::Plain<edit::Undo>},
    {"redo", &Decoder::Plain<edit::Redo>},
    {"set_pose", &Decoder::SetPose},
    {"set_property", &Decoder::SetProperty},
    {"set_member", &Decoder::SetMember},
    {"rename", &Decoder::Rename},
    {"delete", &Decoder::Named<edit::Delete>},
    {"add_model", &Decoder::AddModel},
    {"set_model", &Decoder::SetModel},
    {"change_part", &Decoder::ChangePart},
    {"create_bitmap", &Decoder::CreateBitmap},
    {"draw_bitmap", &Decoder::DrawBitmap},
    {"set_region", &Decoder::SetRegion},
    {"test", &Decoder::Test},
    {"end_test", &Decoder::Plain<edit::EndTest>},
};

}  // namespace

Result<EditOperation> DecodeEditOperation(const Json& request) {
  return Decoder(request).Decode();
}

Status CheckName(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 100 && FindInvalidUtf8(name) == std::string::npos &&
                     std::none_of(name.begin(), name.end(),
                                  [](char c) { return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20; });
  if (plain) return {};
  return BadInput("found the name " + Quoted(name) + ", expected 1 to 100 characters without quotes");
}

}  // namespace troupe
