#include "worldfile/models/properties/property_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/hash.h"
#include "troupe/check.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

const std::string& TextOf(const PropertyScalar& scalar) {
  TROUPE_CHECK(scalar.number != nullptr || scalar.text != nullptr);
  return scalar.number != nullptr ? scalar.number->text : *scalar.text;
}

// A property is one or several scalars, as in Stage: a tuple of one is the same as the one.

std::size_t CountScalars(const Value& value) {
  const auto* const tuple = std::get_if<Value::Tuple>(&value.content);
  return tuple != nullptr ? tuple->size() : 1;
}

PropertyScalar ScalarAt(const Value& value, std::size_t index) {
  const auto view = [](const auto& scalar) {
    return PropertyScalar{std::get_if<Value::Number>(&scalar), std::get_if<std::string>(&scalar)};
  };
  const auto* const tuple = std::get_if<Value::Tuple>(&value.content);
  return tuple != nullptr ? view((*tuple)[index]) : view(value.content);
}

char LowerCase(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// Of a word for yes or no.
std::optional<bool> FlagOf(std::string text) {
  for (char& c : text) c = LowerCase(c);
  if (text == "true" || text == "yes" || text == "on") return true;
  if (text == "false" || text == "no" || text == "off") return false;
  return std::nullopt;
}

constexpr std::size_t kMaxNameLength = 1000;

void AddRange(const ZRange& z, Hasher& hasher) {
  hasher.Add(z.min);
  hasher.Add(z.max);
}

// For the store only, never written to a file. Of an area the count and the bounds are enough: equal hashes are
// compared in full.
std::uint64_t HashOf(const Shape& shape) {
  Hasher hasher;
  for (const Block& block : shape.blocks) {
    hasher.Add(std::uint64_t{block.outline.size()});
    for (const Vec2& vertex : block.outline) {
      hasher.Add(vertex.x());
      hasher.Add(vertex.y());
    }
    AddRange(block.z, hasher);
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    hasher.Add(rectangle.min_x);
    hasher.Add(rectangle.min_y);
    hasher.Add(rectangle.max_x);
    hasher.Add(rectangle.max_y);
  }
  AddRange(shape.rectangles_z, hasher);
  if (shape.area) {
    hasher.Add(std::uint64_t{shape.area->cover().count()});
    const Rectangle bounds = shape.area->bounds();
    for (const double edge : {bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y}) hasher.Add(edge);
  }
  return hasher.value();
}

struct NoEffect {
  std::string_view name;
  std::string_view reason;
};

constexpr std::string_view kWindow = "it only concerns Stage's window";
constexpr std::string_view kNotInStage = "it has none in Stage either";
constexpr std::string_view kFormer = "only older versions of Stage knew it";

constexpr NoEffect kWorldProperties[] = {
    {"confirm_on_quit", kWindow}, {"interval_real", kFormer},
    {"paused", kWindow},          {"resolution", "geometry is exact, without cells"},
    {"show_clock", kWindow},      {"show_clock_interval", kWindow},
    {"test", kNotInStage},        {"threads", "each robot has its own process"},
};

// Today's names of what older versions of Stage had.
constexpr std::string_view kRange = "it is 'range [min max]' today";
constexpr std::string_view kSensors = "the rays of a 'ranger' are in 'sensor ( ... )' today";

constexpr NoEffect kModelProperties[] = {
    {"alwayson", "a sensor is on while it has a reader"},
    {"blob_return", kNotInStage},
    {"debug", kNotInStage},
    {"event_queue", kNotInStage},
    {"friction", kNotInStage},
    {"gui_grid", kWindow},
    {"gui_move", kWindow},
    {"gui_outline", kWindow},
    {"laser_return", "it is 'ranger_return' today"},
    {"map_resolution", kNotInStage},
    {"say", kWindow},
    {"shape", "only older versions of Stage knew it; a body is made of 'block ( ... )' or a 'bitmap' today"},
    {"sonar_return", "it is 'ranger_return' today"},
    {"trail_interval", kWindow},
    {"trail_length", kWindow},
    {"velocity", kNotInStage},
    {"bitmap_resolution", kFormer},
    {"blobfinder_return", "it is 'blob_return' in Stage 4, where it has no effect either"},
    {"corrupt", "'localization' and 'odom_error' say how well a robot knows its pose today"},
    {"fiducial_id", "it is 'fiducial_return' today"},
    {"gui_boundary", "it is 'boundary' today"},
    {"image_filename", "it is 'bitmap' today"},
    {"interval", "it is 'update_interval' today"},
    {"map_filename", "it is 'bitmap' today"},
    {"obstacle", "it is 'obstacle_return' today"},
    {"odometry", "it is 'localization \"odom\"' today"},
    {"polygons", "a body is made of 'block ( ... )' today"},
    {"polygon", "a body is made of 'block ( ... )' today"},
    {"puck_return", "it is 'gripper_return' today"},
    {"rects", "a body is made of 'block ( ... )' today"},
    {"rect", "a body is made of 'block ( ... )' today"},
    {"scale", "'size' says how large the body is today"},
    {"steer", "it is 'drive' today"},
    {"vision_return", "it is 'blob_return' in Stage 4, where it has no effect either"},
    {"view", kFormer},
};

constexpr NoEffect kSensorProperties[] = {
    {"angle", "it is 'fov' today"},         {"color", kWindow},      {"color_rgba", kWindow},
    {"laser_sample_skip", kFormer},         {"range_max", kRange},   {"range_min", kRange},
    {"ray_count", "it is 'samples' today"}, {"resolution", kFormer}, {"view", kFormer},
};

constexpr NoEffect kBlobfinderProperties[] = {
    {"channel_count", "it is 'colors_count' today"},
    {"channels", "they are 'colors' today"},
    {"channels_count", "it is 'colors_count' today"},
    {"range_max", "it is 'range' today"},
};

constexpr NoEffect kFiducialProperties[] = {
    {"max_range_anon", "it is 'range_max' today"},
    {"max_range_id", "it is 'range_max_id' today"},
    {"range", "it is 'range_max' today"},
};

// Of a ranger itself.
constexpr NoEffect kRangerProperties[] = {
    {"fov", kSensors},
    {"range", kSensors},
    {"range_max", "it is 'range [min max]' of a 'sensor ( ... )' today"},
    {"range_min", "it is 'range [min max]' of a 'sensor ( ... )' today"},
    {"samples", kSensors},
    {"laser_sample_skip", kFormer},
    {"scount", kSensors},
    {"spose", "it is 'pose' of a 'sensor ( ... )' today"},
    {"srange", "it is 'range' of a 'sensor ( ... )' today"},
    {"ssize", "it is 'size' of a 'sensor ( ... )' today"},
    {"sview", "it is 'range', 'fov' and 'samples' of a 'sensor ( ... )' today"},
    {"view", "it is 'range' and 'fov' of a 'sensor ( ... )' today"},
};

// Without the index of a property such as spose[3].
std::string WithoutIndex(const std::string& name) {
  return name.substr(0, name.find('['));
}

std::string_view FindReason(std::span<const NoEffect> reasons, const std::string& name) {
  const auto found = std::find_if(reasons.begin(), reasons.end(),
                                  [&](const NoEffect& entry) { return entry.name == WithoutIndex(name); });
  return found == reasons.end() ? std::string_view{} : found->reason;
}

// `otherwise` follows the name of a property without a reason in the list.
void WarnOfUnused(PropertyReader& reader, std::span<const NoEffect> reasons, const std::string& otherwise,
                  bool in_sensor = false, std::span<const NoEffect> first_reasons = {}) {
  for (const Property* property : reader.Unused()) {
    std::string_view reason = FindReason(first_reasons, property->name);
    if (reason.empty()) reason = FindReason(reasons, property->name);
    const std::string statement = "property " + Quoted(property->name);
    if (reason == kWindow) {
      reader.diagnostics().WarnOfWindow(property->where, statement + (in_sensor ? " of a sensor" : ""));
      continue;
    }
    std::string text = statement + " has no effect";
    text += reason.empty() ? otherwise : ": " + std::string(reason);
    reader.diagnostics().Warn(property->where, text);
  }
}

}  // namespace

bool IsWithinReach(const Pose& pose) {
  return std::max({std::fabs(pose.x), std::fabs(pose.y), std::fabs(pose.z)}) <= kMaxMagnitude;
}

bool EqualInAnyCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return LowerCase(x) == LowerCase(y); });
}

double Units::Angle(double value) const {
  return degrees ? DegreesToRadians(value) : value;
}

PropertyReader::PropertyReader(const WorldNode& node, const Units& units, Diagnostics& diagnostics)
    : node_(node), units_(units), diagnostics_(diagnostics), used_(node.properties.size()) {}

const Property* PropertyReader::Use(std::string_view name) {
  const Property* property = node_.Find(name);
  // The index of the property in its node: Find returns a pointer into the vector.
  if (property != nullptr) used_[static_cast<std::size_t>(property - node_.properties.data())] = true;
  return property;
}

const SourceLocation& PropertyReader::Where(std::string_view name) const {
  const Property* property = node_.Find(name);
  return property != nullptr ? property->value.where : node_.where;
}

// Nothing after a text without a number.
std::optional<double> PropertyReader::ToNumber(const Property& property, const PropertyScalar& scalar, double limit) {
  double value = 0.0;
  if (scalar.number != nullptr) {
    value = scalar.number->value;
  } else {
    const std::string& text = *scalar.text;
    const std::optional<LeadingNumber> leading = ReadLeadingNumber(text);
    const std::optional<bool> flag = leading ? std::nullopt : FlagOf(text);
    if (!leading && !flag) return std::nullopt;
    value = leading ? leading->value : *flag ? 1.0 : 0.0;
    if (!leading || !leading->is_all) WarnOfValue(property, "string " + Quoted(text), "a number", NumberText(value));
  }
  if (std::fabs(value) <= limit) return value;
  // Clamped and not refused: the limit keeps sums and squares of the geometry finite.
  const double nearest = std::copysign(limit, value);
  WarnOfValue(property, Quoted(TextOf(scalar)), "a number of at most " + NumberText(limit), NumberText(nearest));
  return nearest;
}

void PropertyReader::WarnOfValue(const Property& property, const std::string& found, const std::string& expected,
                                 const std::string& used) {
  diagnostics_.Warn(property.value.where, "found " + found + " for " + Quoted(property.name) + ", expected " +
                                              expected + "; " + used + " is used");
}

bool PropertyReader::ReadNumbers(std::string_view name, std::span<double> numbers, double limit) {
  const Property* property = Use(name);
  if (property == nullptr) return false;
  const std::size_t count = numbers.size();
  const std::size_t found = CountScalars(property->value);
  if (found < count) {
    diagnostics_.Fail(property->value.where, "found " + CountText(found, "value") + " for " + Quoted(name) +
                                                 ", expected " + std::to_string(count));
    return false;
  }
  if (found > count) {
    diagnostics_.Warn(property->value.where, "found " + CountText(found, "value") + " for " + Quoted(name) +
                                                 ", expected " + std::to_string(count) + "; the rest is ignored");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const PropertyScalar scalar = ScalarAt(property->value, i);
    const std::optional<double> number = ToNumber(*property, scalar, limit);
    // Of several the text counts as 0, as in Stage, so that the others keep their meaning.
    if (!number) {
      WarnOfValue(*property, "string " + Quoted(TextOf(scalar)), "a number", count == 1 ? "the default" : "0");
    }
    if (!number && count == 1) return false;
    numbers[i] = number.value_or(0.0);
  }
  return true;
}

std::optional<std::vector<double>> PropertyReader::Numbers(std::string_view name, std::size_t count, double limit) {
  std::vector<double> numbers(count);
  return ReadNumbers(name, numbers, limit) ? std::optional(std::move(numbers)) : std::nullopt;
}

std::optional<double> PropertyReader::OneNumber(std::string_view name, double limit) {
  double number = 0.0;
  return ReadNumbers(name, {&number, 1}, limit) ? std::optional(number) : std::nullopt;
}

double PropertyReader::Number(std::string_view name, double otherwise, double min, double max) {
  const std::optional<double> number = OneNumber(name, std::max(kMaxMagnitude, max));
  if (!number) return otherwise;
  const double value = *number;
  if (value >= min && value <= max) return value;
  // A lower limit above 0 is there because 0 makes no sense; it makes hardly more.
  const double nearest = value > max ? max : min > 0.0 ? otherwise : min;
  WarnOfValue(*node_.Find(name), NumberText(value), NumberText(min) + " to " + NumberText(max), NumberText(nearest));
  return nearest;
}

double PropertyReader::Length(std::string_view name, double otherwise) {
  const std::optional<double> number = OneNumber(name);
  return number ? *number * units_.length : otherwise;
}

std::int64_t PropertyReader::Integer(std::string_view name, std::int64_t otherwise, std::int64_t min,
                                     std::int64_t max) {
  const std::optional<double> number = OneNumber(name, std::max(kMaxMagnitude, static_cast<double>(max)));
  if (!number) return otherwise;
  const double whole = std::trunc(*number);
  if (whole != *number) {
    diagnostics_.Warn(Where(name), "found " + NumberText(*number) + " for " + Quoted(name) +
                                       ", expected a whole number; " + NumberText(whole) + " is used");
  }
  if (whole >= static_cast<double>(min) && whole <= static_cast<double>(max)) return static_cast<std::int64_t>(whole);
  const std::int64_t nearest = whole < static_cast<double>(min) ? min : max;
  WarnOfValue(*node_.Find(name), NumberText(whole), std::to_string(min) + " to " + std::to_string(max),
              std::to_string(nearest));
  return nearest;
}

bool PropertyReader::Flag(std::string_view name, bool otherwise) {
  const std::optional<double> number = OneNumber(name);
  return number ? std::trunc(*number) != 0.0 : otherwise;
}

std::vector<std::string> PropertyReader::Texts(std::string_view name) {
  const Property* property = Use(name);
  std::vector<std::string> texts;
  if (property == nullptr) return texts;
  for (std::size_t i = 0; i < CountScalars(property->value); ++i) texts.push_back(TextOf(ScalarAt(property->value, i)));
  return texts;
}

std::string PropertyReader::Text(std::string_view name, const std::string& otherwise) {
  const Property* property = Use(name);
  if (property == nullptr) return otherwise;
  const std::vector<std::string> texts = Texts(name);
  if (texts.size() == 1) return texts.front();
  diagnostics_.Warn(property->value.where, "found " + CountText(texts.size(), "value") + " for " + Quoted(name) +
                                               ", expected one string; " +
                                               (texts.empty() ? "the default" : "the first") + " is used");
  return texts.empty() ? otherwise : texts.front();
}

std::size_t PropertyReader::WordNumber(std::string_view name, std::span<const char* const> words) {
  const std::string text = Text(name, std::string(words.front()));
  const auto same = [&text](std::string_view word) { return EqualInAnyCase(word, text); };
  const auto found = std::find_if(words.begin(), words.end(), same);
  const auto nearest = found != words.end() ? found : words.begin();
  const auto number = static_cast<std::size_t>(nearest - words.begin());
  if (text == *nearest) return number;
  std::string expected;
  for (std::size_t i = 0; i < words.size(); ++i) {
    expected += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + ('"' + std::string(words[i]) + '"');
  }
  WarnOfValue(*node_.Find(name), Quoted(text), expected, Quoted(*nearest));
  return number;
}

std::optional<Pose> PropertyReader::ReadPose(std::string_view name) {
  std::array<double, 4> n;
  if (!ReadNumbers(name, n, kMaxMagnitude)) return std::nullopt;
  return Pose{n[0] * units_.length, n[1] * units_.length, n[2] * units_.length, WrapAngle(units_.Angle(n[3]))};
}

std::vector<const Property*> PropertyReader::Unused() const {
  std::vector<const Property*> unused;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (!used_[i]) unused.push_back(&node_.properties[i]);
  }
  return unused;
}

std::string ModelNames::Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics) {
  const Property* const property = node.Find("name");
  const SourceLocation& where = property != nullptr ? property->value.where : node.where;
  if (name.size() > kMaxNameLength) {
    diagnostics.Fail(where, "found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                                std::to_string(kMaxNameLength));
  }
  std::string free = free_.Add(name);
  const auto first = places_.emplace(free, where).first;
  if (property == nullptr) return free;
  const std::optional<std::string> given = GivenName(node);
  if (!given) {
    diagnostics.Warn(where, "found a 'name' that cannot be one; the model is called " + Quoted(free));
    return free;
  }
  if (!std::holds_alternative<std::string>(property->value.content)) {
    diagnostics.Warn(where,
                     "found a name that is not a string, expected it in quotes; it is read as " + Quoted(*given));
  }
  // A child before this one may have the name, or a model elsewhere.
  const std::string ending = given->starts_with('/') ? given->substr(1) : *given;
  if (free == ending || free.ends_with("." + ending)) return free;
  const auto other = places_.find(free.substr(0, free.rfind(ending) + ending.size()));
  const SourceLocation& place = (other != places_.end() ? other : first)->second;
  diagnostics.Warn(where, "found name " + Quoted(ending) + " twice, expected each name once (first at " + place.file +
                              ":" + std::to_string(place.line) + "); the others get a number, as in " +
                              Quoted(ending + ":2"));
  return free;
}

void ModelNames::AddPart(const SourceLocation& where, const std::string& name, Diagnostics& diagnostics) {
  if (free_.Add(name) != name) {
    diagnostics.Fail(where, "found name " + Quoted(name) + " twice, expected each name once");
  }
  places_.emplace(name, where);
}

ShapeId ShapeStore::Add(Shape shape) {
  const std::uint64_t hash = HashOf(shape);
  const auto [begin, end] = by_hash_.equal_range(hash);
  for (auto entry = begin; entry != end; ++entry) {
    if (shapes_[entry->second.index()] == shape) return entry->second;
  }
  const ShapeId id(shapes_.size());
  shapes_.push_back(std::move(shape));
  by_hash_.emplace(hash, id);
  return id;
}

const RangerParameters* KnownRangers::Find(const WorldNode& node) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.node == &node; });
  return found != entries_.end() ? &found->ranger : nullptr;
}

const RangerParameters& KnownRangers::Add(const WorldNode& node, RangerParameters ranger) {
  constexpr std::size_t kMax = 16;  // a world has few types of robots
  if (entries_.size() == kMax) entries_.pop_front();
  return entries_.emplace_back(Entry{&node, std::move(ranger)}).ranger;
}

void WarnOfUnusedInWorld(PropertyReader& reader) {
  WarnOfUnused(reader, kWorldProperties, " in a 'world'");
}

void WarnOfUnusedInSensor(PropertyReader& reader) {
  WarnOfUnused(reader, kSensorProperties, " in a 'sensor'", true);
}

void WarnOfUnusedInBlock(PropertyReader& reader) {
  WarnOfUnused(reader, {}, " in a 'block'");
}

void WarnOfUnusedInModel(PropertyReader& reader, std::string_view type) {
  std::span<const NoEffect> of_type;
  if (type == "blobfinder") of_type = kBlobfinderProperties;
  if (type == "fiducial") of_type = kFiducialProperties;
  if (type == "ranger") of_type = kRangerProperties;
  WarnOfUnused(reader, kModelProperties, " in a '" + std::string(type) + "'", false, of_type);
}

}  // namespace troupe
