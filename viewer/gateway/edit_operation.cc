#include "viewer/gateway/edit_operation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/base/json.h"
#include "common/base/text.h"
#include "troupe/polygon.h"

namespace troupe {
namespace {

constexpr double kMaxNumber = 1e6;  // of world files
constexpr std::size_t kMaxBlocks = 200;
constexpr std::size_t kMaxCorners = 1000;
constexpr std::size_t kMaxProperties = 100;
constexpr std::size_t kMaxPath = 20;            // of a part
constexpr std::size_t kMaxPoints = 5000;        // of a stroke
constexpr int kMaxCoordinate = 100'000;         // pixels
constexpr int kMaxWidth = 500;                  // pixels
constexpr std::int64_t kMaxWork = 100'000'000;  // pixels that a stroke fills, some of them again
constexpr double kMinPixel = 0.001;             // m
constexpr std::uint8_t kOccupied = 0;
constexpr std::uint8_t kFreed = 255;
constexpr std::size_t kMaxDepth = 12;      // of a value of a scenario
constexpr std::size_t kMaxTogether = 500;  // edits

// The text of a value on one line, with the blanks that people write.
std::string SpacedJson(const JsonNode& value) {
  if (!value.is_array() && !value.is_object()) return JsonText(ToJson(value));
  std::string text;
  for (const JsonNode& item : value.items) {
    if (!text.empty()) text += ", ";
    text += (value.is_object() ? JsonText(nlohmann::json(item.key)) + ": " : "") + SpacedJson(item);
  }
  return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

// A name, perhaps with an index: "point[0]".
// `include` and `define` are statements: as names of properties they would change what the file reads or means.
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
  explicit Decoder(const JsonReader& request) : request_(request) {}

  Result<EditOperation> Decode() {
    if (Status status = request_.status(); !status.ok()) return status.error();
    const std::string op = Text("op");
    for (const auto& [name, decode] : kOperations) {
      if (op == name) return Outcome((this->*decode)());
    }
    return BadInput("found the operation " + Quoted(op) + ", expected one of the editor");
  }

 private:
  using Method = EditOperation (Decoder::*)();

  Result<EditOperation> Outcome(EditOperation operation) {
    if (Status status = request_.status(); !status.ok()) return status.error();
    return operation;
  }
  void Fail(const std::string& message) { request_.FailWith(message); }

  // Empty without one.
  std::string Text(const char* key) const { return request_.Optional<std::string>(key).value_or(""); }
  bool Flag(const char* key) const { return request_.Optional<bool>(key).value_or(false); }

  static std::optional<std::vector<double>> Numbers(const JsonReader& object, const char* key, std::size_t count) {
    const std::optional<JsonReader> list = object.Find(key);
    return list ? list->Numbers(count, kMaxNumber) : std::nullopt;
  }

  static std::optional<Pose> FindPose(const JsonReader& object) {
    const auto numbers = Numbers(object, "pose", 4);
    if (!numbers) return std::nullopt;
    return Pose{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
  }
  Pose PoseOf() {
    const std::optional<Pose> pose = FindPose(request_);
    if (!pose) request_.FailWithout("pose", "a list of 4 numbers");
    return pose.value_or(Pose());
  }

  // A polygon that crosses itself is refused here, where the user can be told which stroke it was.
  static DrawnBlock BlockOf(const JsonReader& object) {
    DrawnBlock block;
    if (const auto z = Numbers(object, "z", 2)) {
      block.z_min = (*z)[0];
      block.z_max = (*z)[1];
    }
    if (block.z_max <= block.z_min) object.Fail("a block whose top, in 'z', is above its underside");
    if (const std::optional<JsonReader> outline = object.Find("outline")) {
      for (const JsonReader& corner : outline->Items(kMaxCorners)) {
        if (const auto xy = corner.Numbers(2, kMaxNumber)) block.outline.emplace_back((*xy)[0], (*xy)[1]);
      }
    }
    if (const Result<Polygon> simple = Normalized(block.outline); !simple.ok()) {
      object.FailWith("found a block that is no simple polygon: " + simple.error().message);
    }
    return block;
  }

  // None without them.
  static std::vector<DrawnBlock> Blocks(const JsonReader& object) {
    std::vector<DrawnBlock> blocks;
    if (const std::optional<JsonReader> list = object.Find("blocks")) {
      for (const JsonReader& each : list->Items(kMaxBlocks)) blocks.push_back(BlockOf(each));
      if (blocks.empty()) list->Fail("at least one block");
    }
    return blocks;
  }

  // A value of a world file in a text. Nothing after an error.
  // Values travel as texts of a world file, so that the page shows and sends what the user types.
  static std::optional<Value> ValueIn(const JsonReader& text) {
    std::string written;
    if (!text.To(written)) return std::nullopt;
    Result<Value> value = ReadValueText(written);
    if (value.ok()) return std::move(value).value();
    text.FailWith(Quoted(text.key()) + ": " + value.error().message);
    return std::nullopt;
  }

  // Null and a missing value both remove the property.
  PropertyChange Change() {
    PropertyChange change{Text("property"), {}};
    if (!IsPropertyName(change.property)) Fail("found the property " + Quoted(change.property) + ", expected a name");
    const std::optional<JsonReader> given = request_.Find("value");
    if (given && given->node().is_string()) change.value = ValueIn(*given);
    return change;
  }

  // `key`: of the object of properties; without one there are none.
  WrittenProperties Properties(const char* key) {
    WrittenProperties properties;
    const std::optional<JsonReader> given = request_.Find(key);
    if (!given) return properties;
    for (const JsonReader& member : given->Members()) {
      if (!IsPropertyName(member.key()))
        member.FailWith("found the property " + Quoted(member.key()) + ", expected a name");
      if (std::optional<Value> value = ValueIn(member)) properties.emplace_back(member.key(), std::move(*value));
    }
    if (properties.size() > kMaxProperties) given->Fail("fewer properties");
    return properties;
  }

  // Of a name that the editor completes by a number.
  std::string Prefix() {
    std::string prefix = Text("name");
    if (const Status wrong = CheckName(prefix); !wrong.ok()) Fail(wrong.error().message);
    return prefix;
  }

  static PartPath PathOf(const JsonReader& list) {
    PartPath path;
    list.Items(kMaxPath);
    if (list.ok()) list.To(path);
    return path;
  }

  // Members that are not given stay as they are in the file.
  PartShape Shape(bool may_be_empty) {
    PartShape shape;
    const std::optional<JsonReader> given = request_.Find("shape");
    if (!given) {
      if (!may_be_empty) request_.FailWithout("shape", "an object");
      return shape;
    }
    shape.pose = FindPose(*given);
    shape.size = Numbers(*given, "size", 3);
    shape.paddle = Numbers(*given, "paddle", 3);
    shape.axis = Numbers(*given, "axis", 3);
    shape.limits = Numbers(*given, "limits", 2);
    shape.blocks = Blocks(*given);
    given->RefuseOthers();
    const auto is_positive = [](double length) { return length > 0.0; };
    for (const auto* const lengths : {&shape.size, &shape.paddle}) {
      if (*lengths && !std::all_of((*lengths)->begin(), (*lengths)->end(), is_positive))
        given->FailWith("found a size that is not above 0, expected lengths");
    }
    if (shape.axis && std::hypot((*shape.axis)[0], (*shape.axis)[1], (*shape.axis)[2]) < 1e-6)
      given->FailWith("found the axis [0 0 0], expected a direction");
    if (!may_be_empty && given->node().items.empty()) given->Fail("pose, size, paddle, axis, limits or blocks");
    return shape;
  }

  GripperRoles Roles() {
    constexpr std::array kRoles{"left_finger", "right_finger", "left_pad", "right_pad", "lift"};
    GripperRoles roles;
    const std::optional<JsonReader> given = request_.Find("roles");
    if (!given || given->node().items.empty()) {
      request_.FailWithout("roles", "an object of them");
      return roles;
    }
    for (const char* role : kRoles) {
      const std::optional<JsonReader> list = given->Find(role);
      if (!list) continue;
      std::optional<PartPath> path;
      if (!list->is_null()) {
        path = PathOf(*list);
        if (path->empty()) list->Fail("the indices of a part");
      }
      roles.emplace_back(role, std::move(path));
    }
    given->RefuseOthers();
    return roles;
  }

  // In pixels that the brush covers: points and width together decide the time of a stroke.
  static std::int64_t WorkOf(const PixelStroke& stroke) {
    if (stroke.tool != PixelStroke::Tool::kLine) return 0;  // at most the picture, twice
    std::int64_t steps = 1;
    for (std::size_t i = 1; i < stroke.points.size(); ++i) {
      steps += std::max(std::abs(stroke.points[i].x - stroke.points[i - 1].x),
                        std::abs(stroke.points[i].y - stroke.points[i - 1].y));
    }
    return steps * stroke.width * stroke.width;
  }

  PixelStroke Stroke() {
    PixelStroke stroke;
    const std::string tool = Text("tool");
    if (tool == "frame") {
      stroke.tool = PixelStroke::Tool::kFrame;
    } else if (tool == "filled") {
      stroke.tool = PixelStroke::Tool::kFilled;
    } else if (tool != "line") {
      Fail("found the tool " + Quoted(tool) + ", expected line, frame or filled");
    }
    stroke.width = request_.Get<int>("width");
    if (stroke.width < 1 || stroke.width > kMaxWidth) Fail("found no width of a brush, expected 1 to 500 pixels");
    stroke.value = Flag("erase") ? kFreed : kOccupied;
    const std::optional<JsonReader> points = request_.Find("points");
    for (const JsonReader& point : points ? points->Items(kMaxPoints) : std::vector<JsonReader>()) {
      std::vector<int> xy;
      if (!point.To(xy)) return stroke;
      if (xy.size() != 2 || std::max(std::abs(xy[0]), std::abs(xy[1])) > kMaxCoordinate) {
        point.Fail("two whole numbers within 100000 pixels");
        return stroke;
      }
      stroke.points.push_back({xy[0], xy[1]});
    }
    if (stroke.points.empty()) request_.FailWithout("points", "1 to 5000 points of two whole numbers");
    if (stroke.tool != PixelStroke::Tool::kLine && stroke.points.size() != 2)
      Fail("found another number of points, expected the two corners of a rectangle");
    if (WorkOf(stroke) > kMaxWork) Fail("found a stroke that is too long for so wide a brush");
    return stroke;
  }

  // The operations.
  // An operation without members.
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

  EditOperation SetText() { return edit::SetText{request_.Get<std::string>("text")}; }
  EditOperation Save() { return edit::Save{Flag("overwrite")}; }
  EditOperation SetPose() { return edit::SetPose{Text("name"), PoseOf()}; }
  EditOperation SetProperty() { return edit::SetProperty{Text("name"), Change()}; }
  EditOperation SetValue() {
    edit::SetValue operation{Text("name"), {}, {}};
    const std::optional<JsonReader> path = request_.Find("path");
    for (const JsonReader& step : path ? path->Items(kMaxDepth) : std::vector<JsonReader>()) {
      if (step.node().is_number()) {
        step.To(operation.path.emplace_back(std::size_t{0}).emplace<std::size_t>());
      } else {
        step.To(operation.path.emplace_back().emplace<std::string>());
      }
    }
    if (operation.path.empty()) request_.FailWithout("path", "a list of keys and indices");
    const std::optional<JsonReader> value = request_.Find("value");
    if (value && !value->is_null()) operation.value = SpacedJson(value->node());
    return operation;
  }
  EditOperation Rename() {
    edit::Rename operation{Text("name"), Text("to")};
    if (const Status wrong = CheckName(operation.to); !wrong.ok()) Fail(wrong.error().message);
    return operation;
  }

  EditOperation Copy() { return edit::Copy{Text("name"), PoseOf()}; }

  EditOperation Together() {
    edit::Together operation;
    const std::optional<JsonReader> edits = request_.Find("edits");
    for (const JsonReader& each : edits ? edits->Items(kMaxTogether) : std::vector<JsonReader>()) {
      Decoder decoder(each);
      const std::string op = decoder.Text("op");
      if (op == "set_pose") {
        operation.edits.emplace_back(edit::SetPose{decoder.Text("name"), decoder.PoseOf()});
      } else if (op == "delete") {
        operation.edits.emplace_back(edit::Delete{decoder.Text("name")});
      } else if (op == "copy") {
        operation.edits.emplace_back(edit::Copy{decoder.Text("name"), decoder.PoseOf()});
      } else {
        each.FailWith("found the operation " + Quoted(op) + " among several, expected set_pose, delete or copy");
      }
    }
    if (operation.edits.empty()) request_.FailWithout("edits", "a list of edits");
    return operation;
  }

  EditOperation AddModel() {
    edit::AddModel operation;
    operation.blocks = Blocks(request_);
    if (operation.blocks.empty()) request_.FailWithout("blocks", "at least one block");
    operation.pose = PoseOf();
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
    operation.blocks = Blocks(request_);
    operation.properties = Properties("properties");
    request_.Read("remove", operation.removed);
    return operation;
  }

  EditOperation ChangePart() {
    const std::string action = Text("action");
    if (action == "set") return OfPart(edit::SetPartProperty{{}, Change()});
    if (action == "remove") return OfPart(edit::RemovePart());
    if (action == "shape") return OfPart(edit::ShapePart{{}, Shape(false)});
    if (action == "roles") return OfPart(edit::SetGripperRoles{{}, Roles()});
    if (action != "add") Fail("found the action " + Quoted(action) + ", expected set, add, remove, shape or roles");
    edit::AddPart operation;
    operation.type = Text("kind");
    if (!IsTypeName(operation.type)) Fail("found the part " + Quoted(operation.type) + ", expected a type of model");
    operation.properties = Properties("properties");
    operation.shape = Shape(true);
    if (!Text("name").empty()) operation.prefix = Prefix();
    if (request_.Has("sensor")) operation.sensor = Properties("sensor");
    return OfPart(std::move(operation));
  }

  template <typename Operation>
  EditOperation OfPart(Operation operation) {
    operation.model = Text("model");
    if (const std::optional<JsonReader> path = request_.Find("part")) operation.part = PathOf(*path);
    return operation;
  }

  EditOperation CreateBitmap() {
    edit::CreateBitmap operation;
    operation.file = Text("file");
    operation.size = Numbers(request_, "size", 3).value_or(std::vector<double>(3));
    operation.pixel = request_.Number("pixel", kMinPixel, kMaxNumber).value_or(0.0);
    operation.pose = PoseOf();
    if (!(operation.pixel > 0.0) || !(operation.size[2] > 0.0)) {
      Fail("found no size or pixel, expected lengths in m, and pixels of at least 0.001 m");
    }
    request_.Read("runs", operation.runs);
    const bool are_counts =
        std::all_of(operation.runs.begin(), operation.runs.end(), [](auto run) { return run >= 0; });
    if (!are_counts) Fail("found other runs of pixels, expected counts");
    return operation;
  }
  EditOperation DrawBitmap() { return edit::DrawBitmap{Text("name"), Stroke()}; }

  EditOperation Test() {
    edit::Test operation;
    operation.model = Text("model");
    request_.Read("probe_height", operation.probe_height);
    return operation;
  }

  static const std::pair<std::string_view, Method> kOperations[26];

  const JsonReader& request_;
};

constexpr std::pair<std::string_view, Decoder::Method> Decoder::kOperations[26] = {
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
    {"set_value", &Decoder::SetValue},
    {"rename", &Decoder::Rename},
    {"delete", &Decoder::Named<edit::Delete>},
    {"copy", &Decoder::Copy},
    {"together", &Decoder::Together},
    {"add_model", &Decoder::AddModel},
    {"set_model", &Decoder::SetModel},
    {"change_part", &Decoder::ChangePart},
    {"create_bitmap", &Decoder::CreateBitmap},
    {"draw_bitmap", &Decoder::DrawBitmap},
    {"test", &Decoder::Test},
    {"end_test", &Decoder::Plain<edit::EndTest>},
};

}  // namespace

Result<EditOperation> DecodeEditOperation(const JsonReader& request) {
  return Decoder(request).Decode();
}

// Line ends, quotes and backslashes would end or change the string in a file.
Status CheckName(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 100 && FindInvalidUtf8(name) == std::string::npos &&
                     std::none_of(name.begin(), name.end(),
                                  [](char c) { return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20; });
  if (plain) return {};
  return BadInput("found the name " + Quoted(name) + ", expected 1 to 100 characters without quotes");
}

}  // namespace troupe
