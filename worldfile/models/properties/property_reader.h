// PropertyReader: reads the properties of one node as values in SI units, and remembers which were read, so that the
// others can be named. A value beyond its limits is read as the nearest allowed value, a value of the wrong form as the
// default, with a warning that quotes it: Stage reads such files. Fewer values than a property has are an error, as in
// Stage. Callers need not check each one.
//
// A reader is a short-lived view of one node; the unit of the file is applied here, once, so that no other code knows
// of centimetres or degrees. The names that Stage or its older versions know are answered with the reason why they have
// no effect, or with today's name.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/limits.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// The units of lengths and angles in a file.
struct Units {
  double length = 1.0;  // m
  bool degrees = true;  // else radians

  double Angle(double value) const;  // to radians
};

// True if x, y and z are within kMaxMagnitude: a pose composed of others need not be.
bool IsWithinReach(const Pose& pose);

bool EqualInAnyCase(std::string_view a, std::string_view b);

// A number or a text of a property, one of both.
struct PropertyScalar {
  const Value::Number* number = nullptr;
  const std::string* text = nullptr;
};

class PropertyReader {
 public:
  // All three must outlive the reader.
  PropertyReader(const WorldNode& node, const Units& units, Diagnostics& diagnostics);

  const WorldNode& node() const { return node_; }
  const Units& units() const { return units_; }
  Diagnostics& diagnostics() { return diagnostics_; }

  // The property, marked as read; null if it is not there.
  const Property* Use(std::string_view name);
  // The place of a property's value, or of the node if it is not there.
  const SourceLocation& Where(std::string_view name) const;

  // A single number between `min` and `max`, without unit. The default limits are the limits of a world; properties of
  // other kinds may allow more.
  double Number(std::string_view name, double otherwise, double min = -kMaxMagnitude, double max = kMaxMagnitude);
  double Length(std::string_view name, double otherwise);  // to m
  std::int64_t Integer(std::string_view name, std::int64_t otherwise, std::int64_t min, std::int64_t max);
  bool Flag(std::string_view name, bool otherwise);  // 0 or not 0
  std::string Text(std::string_view name, const std::string& otherwise);
  // The value whose word (StageWordsOf) the file has, in any case; the first one without the property, or with a
  // warning for another word.
  template <NamedEnum Value>
  Value Choice(std::string_view name) {
    return static_cast<Value>(WordNumber(name, StageWordsOf(Value())));
  }

  // `count` numbers without unit, none larger than `limit`; nothing if the property is not there, or has fewer, or is a
  // text in place of a single one.
  std::optional<std::vector<double>> Numbers(std::string_view name, std::size_t count, double limit = kMaxMagnitude);
  // Every value as text; empty if the property is not there.
  std::vector<std::string> Texts(std::string_view name);
  // [x y z heading], to m and radians.
  std::optional<Pose> ReadPose(std::string_view name);

  // "found 'Omny' for 'drive', expected "diff" or "omni"; 'diff' is used".
  void WarnOfValue(const Property& property, const std::string& found, const std::string& expected,
                   const std::string& used);

  // The properties that were not read.
  std::vector<const Property*> Unused() const;

 private:
  std::size_t WordNumber(std::string_view name, std::span<const char* const> words);
  // A single number; nothing as Numbers.
  std::optional<double> OneNumber(std::string_view name, double limit = kMaxMagnitude);
  // Reads as many numbers as there are in `numbers`; false: as Numbers.
  bool ReadNumbers(std::string_view name, std::span<double> numbers, double limit);
  std::optional<double> ToNumber(const Property& property, const PropertyScalar& scalar, double limit);

  const WorldNode& node_;
  const Units& units_;
  Diagnostics& diagnostics_;
  std::vector<bool> used_;  // by property
};

// The full names of a world's models, and where each was given.
class ModelNames {
 public:
  // The full name of a model that `node` makes: `name`, with a number if it is not new. One that is too long is an
  // error.
  std::string Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics);
  // Adds the name of a part that the model at `where` has by itself; a name in use is an error.
  void AddPart(const SourceLocation& where, const std::string& name, Diagnostics& diagnostics);

 private:
  FreeNames free_;
  std::map<std::string, SourceLocation> places_;
};

// Keeps each geometry once, so that models made from one macro share their shape.
// Found by hash and then compared: the hash may skip parts of a shape. Ids are in the order of first use, which makes
// them, and with them the hash of the world, independent of the hash function.
class ShapeStore {
 public:
  // `shapes` must outlive the store.
  explicit ShapeStore(std::vector<Shape>& shapes) : shapes_(shapes) {}

  // The id of a shape equal to this one, which is added if there is none.
  ShapeId Add(Shape shape);

 private:
  std::vector<Shape>& shapes_;
  std::multimap<std::uint64_t, ShapeId> by_hash_;
};

// A controller of a property `ctrl` (position_type.h).
struct StageController {
  std::optional<ControllerDescription> description;  // nothing: it cannot be used, as a warning says
  std::vector<std::string> warnings;
};

// The rangers of the newest nodes: robots of one macro share the nodes of their rangers, and so have one list of rays.
class KnownRangers {
 public:
  // Null if the ranger of the node is not known.
  const RangerParameters* Find(const WorldNode& node) const;
  const RangerParameters& Add(const WorldNode& node, RangerParameters ranger);

 private:
  struct Entry {
    const WorldNode* node;
    RangerParameters ranger;
  };
  std::deque<Entry> entries_;
};

// BuildContext: the world being built, and the input that all readers need.
struct BuildContext {
  BuildContext(const WorldTree& the_tree, const AllowedPaths& the_allowed, const ImageSource& images,
               const std::shared_ptr<KnownBitmaps>& known_bitmaps)
      : tree(the_tree), allowed(the_allowed), shapes(world.shapes), bitmaps(the_allowed, images, known_bitmaps) {}
  BuildContext(const BuildContext&) = delete;  // `shapes` refers to `world`
  BuildContext& operator=(const BuildContext&) = delete;

  const WorldTree& tree;
  const AllowedPaths& allowed;                    // files that maps and bitmaps may open
  bool without_bitmaps = false;                   // a bitmap is an error
  std::optional<std::string> default_controller;  // of robots for which the file names none
  // Checks the controllers that the file names; nothing: they are not checked.
  std::function<Status(const std::string& name, const std::string& parameters)> check_controller;
  std::map<std::string, std::optional<StageController>> controllers;  // by the text of `ctrl`
  KnownRangers rangers;
  Units units;
  Diagnostics diagnostics;
  WorldDescription world;
  ShapeStore shapes;
  ModelNames names;
  BitmapCache bitmaps;
};

// Warnings about the properties that have no effect, with the reason where one is known.

// Each warns of every property of its entry that was not read.
void WarnOfUnusedInWorld(PropertyReader& reader);
void WarnOfUnusedInSensor(PropertyReader& reader);
void WarnOfUnusedInBlock(PropertyReader& reader);
void WarnOfUnusedInModel(PropertyReader& reader, std::string_view type);

}  // namespace troupe
