// EditOperation: a request of the editor's page (viewer/editor) as a value: checked in its form, but not against the
// edited file. docs/editor.md lists the operations.
//
// A type for each operation, because each has members of its own: a value of the variant cannot lack one, and a handler
// that forgets an operation does not compile. Numbers are finite and within the limits of a world after decoding; names
// fit between quotes of both languages, so no edit can insert syntax into a file.
//
// Units are metres and radians, whatever the file has; the editor converts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/json_reader.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/edit/written_model.h"

namespace troupe {

// A block that is drawn, in m: {"outline": [[x, y], ...], "z": [min, max]}.
struct DrawnBlock {
  std::vector<Vec2> outline;
  double z_min = 0.0;
  double z_max = 0.0;
};

// A property to be set: {"property": its name, "value": text of a world file}.
struct PropertyChange {
  std::string property;
  std::optional<Value> value;  // nothing: it is removed
};

// {"color": "\"red\"", ...}: values as text of a world file.
using WrittenProperties = std::vector<std::pair<std::string, Value>>;

// The entries of a model's body but for blocks, by their indices, from the model's body inwards.
using PartPath = std::vector<std::size_t>;

// The members of a "shape" that are given, in m and rad, and in the frame D of the model.
struct PartShape {
  std::optional<Pose> pose;                   // "pose": [x, y, z, heading]
  std::optional<std::vector<double>> size;    // "size": [x, y, z] of the body
  std::optional<std::vector<double>> paddle;  // "paddle": length, thickness and height of a gripper's own paddles
  std::optional<std::vector<double>> axis;    // "axis": [x, y, z] of a linear joint, of any length but 0
  std::optional<std::vector<double>> limits;  // "limits": [min, max] of a joint
  std::vector<DrawnBlock> blocks;             // "blocks"; empty: none given

  bool is_only_pose() const { return pose && !size && !paddle && !axis && !limits && blocks.empty(); }
};

// {"left_finger": path of a part, or null: none, ...}, by the names of a gripper's properties.
using GripperRoles = std::vector<std::pair<std::string, std::optional<PartPath>>>;

struct Pixel {
  int x = 0;  // from the left
  int y = 0;  // from the top
};

// One stroke of a brush in a picture: {"tool": "line", "frame" or "filled", "points": [[x, y], ...], "width", "erase":
// true or false}.
struct PixelStroke {
  enum class Tool : std::uint8_t {
    kLine,    // a square brush along the points
    kFrame,   // the edge of the rectangle between two points, inwards
    kFilled,  // the rectangle between two points
  };
  Tool tool = Tool::kLine;
  std::vector<Pixel> points;
  int width = 1;           // of the brush, pixels
  std::uint8_t value = 0;  // of the pixels: 0 for walls, 255 for free ones
};

// The operations. The comment of each has the members of its request.
namespace edit {

// An operation that changes nothing.
struct Question {};

struct Document : Question {};
struct Text : Question {};
struct Palette : Question {};
struct Help : Question {};
struct Bitmaps : Question {};
// "name"
struct Entity : Question {
  std::string name;
};
// "name": of a define
struct Model : Question {
  std::string name;
};

// "text"
struct SetText {
  std::string text;
};
// "overwrite": true or false
struct Save {
  bool overwrite = false;
};
struct Reload {};
struct Undo {};
struct Redo {};

// "name", "pose": [x, y, z, heading] in the world, m and rad
struct SetPose {
  std::string name;
  Pose pose;
};
// "name", and a property; without "name" one of the world
struct SetProperty {
  std::string name;
  PropertyChange change;
};
// "path": keys and indices, "value": JSON, or null: it is removed; a value of a scenario, or with "name" of the entry
// of a robot or model
struct SetValue {
  std::string name;
  JsonPath path;
  std::optional<std::string> value;
};
// "name", "to"
struct Rename {
  std::string name;
  std::string to;
};
// "name"
struct Delete {
  std::string name;
};
// "name", "pose": of the copy
struct Copy {
  std::string name;
  Pose pose;
};
// "edits": [{"op": "set_pose", "delete" or "copy", ...}, ...], one after another, as one edit of the history; none of
// them counts if one is refused
struct Together {
  std::vector<std::variant<SetPose, Delete, Copy>> edits;
};
// "name": prefix, "pose", "blocks": [...], "properties": {...}: a static model of its own, for instance a wall or a
// room
struct AddModel {
  std::string prefix;
  Pose pose;
  std::vector<DrawnBlock> blocks;
  WrittenProperties properties;
};

// "name": of a define, "base": of a new one, "blocks": [...], "properties": {...}, "remove": [names]
struct SetModel {
  std::string name;
  std::string base;
  std::vector<DrawnBlock> blocks;  // empty: as they are
  WrittenProperties properties;
  std::vector<std::string> removed;
};

// "change_part", of a model in this file: "model": its name, "part": [indices]; without "part" the model itself
struct PartOperation {
  std::string model;
  PartPath part;
};
// "action": "set", and a property
struct SetPartProperty : PartOperation {
  PropertyChange change;
};
// "action": "add", below "part": "kind": type, "name": prefix of its name, "properties": {...}, "sensor": {...}:
// properties of its sensor, "shape": {...}
struct AddPart : PartOperation {
  std::string type;
  std::string prefix;
  WrittenProperties properties;
  std::optional<WrittenProperties> sensor;
  PartShape shape;
};
// "action": "remove"
struct RemovePart : PartOperation {};
// "action": "shape", "shape": {...}
struct ShapePart : PartOperation {
  PartShape shape;
};
// "action": "roles", of a gripper: "roles": {...}
struct SetGripperRoles : PartOperation {
  GripperRoles roles;
};

// "file": name.png, "size": [x, y, z] and "pixel" in m, "pose": of its middle. "runs": of the pixels by rows from the
// top, free and occupied ones alternating; without them all are free
struct CreateBitmap {
  std::string file;
  std::vector<double> size;
  double pixel = 0.0;
  Pose pose;
  std::vector<std::int64_t> runs;
};
// "name": of a model, and a stroke
struct DrawBitmap {
  std::string name;
  PixelStroke stroke;
};

// "model": none: the world; "probe_height" in m
struct Test {
  std::string model;
  double probe_height = 0.3;
};
struct EndTest {};

}  // namespace edit

using EditOperation =
    std::variant<edit::Document, edit::Text, edit::Palette, edit::Help, edit::Bitmaps, edit::Entity, edit::Model,
                 edit::SetText, edit::Save, edit::Reload, edit::Undo, edit::Redo, edit::SetPose, edit::SetProperty,
                 edit::SetValue, edit::Rename, edit::Delete, edit::Copy, edit::Together, edit::AddModel, edit::SetModel,
                 edit::SetPartProperty, edit::AddPart, edit::RemovePart, edit::ShapePart, edit::SetGripperRoles,
                 edit::CreateBitmap, edit::DrawBitmap, edit::Test, edit::EndTest>;

// `request`: an object with the member "op". The error tells what is wrong with it.
Result<EditOperation> DecodeEditOperation(const JsonReader& request);

inline bool IsQuestion(const EditOperation& operation) {
  return std::visit([](const auto& each) { return std::is_base_of_v<edit::Question, std::decay_t<decltype(each)>>; },
                    operation);
}

// A name that fits between quotes on a line of both languages.
Status CheckName(const std::string& name);

}  // namespace troupe
