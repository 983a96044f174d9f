#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "troupe/deterministic_math.h"
#include "worldfile/plans/floor_plan.h"
#include "worldfile/plans/plan_curves.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr int kMaxBlockDepth = 16;
constexpr std::size_t kMaxPairs = 4'000'000;
constexpr std::size_t kMaxDrawn = 2'000'000;
constexpr double kMaxCopies = 10'000.0;  // rows times columns of an insert

// m, by the number of $INSUNITS; 0: it is none of a length that is known.
double UnitOf(int number) {
  switch (number) {
    case 1:
      return 0.0254;
    case 2:
      return 0.3048;
    case 4:
      return 0.001;
    case 5:
      return 0.01;
    case 6:
      return 1.0;
    case 7:
      return 1000.0;
    case 10:
      return 0.9144;
    case 14:
      return 0.1;
    default:
      return 0.0;
  }
}

// Two lines of the file: a number that says what the value is, and the value.
struct DxfPair {
  int code = 0;
  std::string_view value;
  int line = 0;  // of the code
};

// The pairs from a 0 on, up to the next.
struct DxfEntity {
  std::string_view type;
  int line = 0;
  std::vector<DxfPair> pairs;
  std::vector<DxfEntity> vertices;  // of a POLYLINE
};

struct DxfBlock {
  Vec2 base{0.0, 0.0};
  std::vector<DxfEntity> entities;
};

class DxfReader {
 public:
  DxfReader(std::string_view text, const std::string& path, PlanUnit unit) : text_(text), path_(path), unit_(unit) {}

  Result<FloorPlan> Read() {
    if (text_.starts_with("AutoCAD Binary DXF")) {
      Fail(1, "found a binary DXF file, expected one as text (DXF of R12 to 2018)");
    } else {
      ReadPairs();
      ReadSections();
    }
    if (error_) return *error_;
    if (!unit_) {
      return Error{{path_, 1, 1},
                   "found no unit ($INSUNITS), expected one: --unit m, cm, mm, in, ft or metres of a unit"};
    }
    const PlanTransform to_plan = PlanTransform::Scale(*unit_, *unit_);
    for (const DxfEntity& entity : entities_) {
      if (!Draw(entity, to_plan, "", 0)) break;
    }
    if (error_) return *error_;
    FloorPlan plan = builder_.Take();
    for (const auto& [type, first] : left_out_) {
      plan.warnings.push_back(
          {{path_, first.first, 1},
           "found " + std::to_string(first.second) + " of the type " + Quoted(type) + ", which are left out"});
    }
    return plan;
  }

 private:
  bool Fail(int line, const std::string& message) {
    if (!error_) error_ = Error{{path_, line, 1}, message};
    return false;
  }

  std::optional<std::string_view> NextLine() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    return line;
  }

  void ReadPairs() {
    while (const std::optional<std::string_view> code = NextLine()) {
      DxfPair pair;
      pair.line = line_;
      if (code->empty() && at_ >= text_.size()) return;
      const auto [end, failure] = std::from_chars(code->data(), code->data() + code->size(), pair.code);
      if (failure != std::errc() || end != code->data() + code->size()) {
        Fail(line_, "found " + Quoted(std::string(code->substr(0, 40))) + ", expected the number of a group");
        return;
      }
      const std::optional<std::string_view> value = NextLine();
      if (!value) {
        Fail(line_, "found the end of the file, expected the value of a group");
        return;
      }
      pair.value = *value;
      if (pairs_.size() == kMaxPairs) {
        Fail(line_, "found more than 4000000 groups, expected fewer");
        return;
      }
      pairs_.push_back(pair);
    }
  }

  static bool Is(const DxfPair& pair, int code, std::string_view value) {
    return pair.code == code && pair.value == value;
  }

  // Sections, blocks and polylines are lists of entities between two marks.
  void ReadSections() {
    if (error_) return;
    if (pairs_.empty() || (pairs_.front().code != 0 && pairs_.front().code != 999)) {  // 999: a comment
      Fail(1, "found no group 0, expected the begin of a section: a DXF file as text");
      return;
    }
    std::string_view section;
    std::string_view variable;
    DxfBlock* block = nullptr;
    DxfEntity* polyline = nullptr;
    bool is_in_block_head = false;
    std::vector<DxfEntity>* list = nullptr;
    DxfEntity* entity = nullptr;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const DxfPair& pair = pairs_[i];
      if (pair.code == 0) {
        entity = nullptr;
        is_in_block_head = false;
        if (pair.value == "SECTION") {
          section = i + 1 < pairs_.size() && pairs_[i + 1].code == 2 ? pairs_[i + 1].value : std::string_view();
          list = section == "ENTITIES" ? &entities_ : nullptr;
          polyline = nullptr;
        } else if (pair.value == "ENDSEC" || pair.value == "EOF") {
          list = nullptr;
          section = {};
        } else if (section == "BLOCKS" && pair.value == "BLOCK") {
          block = &unnamed_;
          *block = {};
          is_in_block_head = true;
          list = nullptr;
          polyline = nullptr;
        } else if (section == "BLOCKS" && pair.value == "ENDBLK") {
          list = nullptr;
        } else if (section == "BLOCKS" || section == "ENTITIES") {
          if (block == nullptr && section == "BLOCKS") continue;
          if (section == "BLOCKS" && list == nullptr) list = &block->entities;
          if (list == nullptr) continue;
          if (pair.value == "SEQEND") {
            polyline = nullptr;
            continue;
          }
          if (pair.value == "VERTEX" && polyline != nullptr) {
            entity = &polyline->vertices.emplace_back();
          } else {
            polyline = nullptr;
            entity = &list->emplace_back();
            if (pair.value == "POLYLINE") polyline = entity;
          }
          entity->type = pair.value;
          entity->line = pair.line;
        }
        continue;
      }
      if (is_in_block_head) {
        if (pair.code == 2) {
          // A block that is defined twice has the entities of the last definition.
          DxfBlock& named = blocks_[std::string(pair.value)];
          named = {block->base, {}};
          block = &named;
        } else if (pair.code == 10 || pair.code == 20) {
          (pair.code == 10 ? block->base.x() : block->base.y()) = NumberOf(pair);
        }
        continue;
      }
      if (section == "HEADER") {
        if (pair.code == 9) variable = pair.value;
        if (pair.code == 70 && variable == "$INSUNITS" && !unit_) {
          const double unit = UnitOf(static_cast<int>(std::clamp(NumberOf(pair), 0.0, 100.0)));
          if (unit > 0.0) unit_ = unit;
        }
        continue;
      }
      if (entity != nullptr) entity->pairs.push_back(pair);
    }
  }

  double NumberOf(const DxfPair& pair) {
    double value = 0.0;
    const auto [end, failure] = std::from_chars(pair.value.data(), pair.value.data() + pair.value.size(), value);
    if (failure != std::errc() || end != pair.value.data() + pair.value.size() || !std::isfinite(value)) {
      Fail(pair.line + 1, "found " + Quoted(std::string(pair.value.substr(0, 40))) + ", expected a number");
      return 0.0;
    }
    return value;
  }
  double Number(const DxfEntity& entity, int code, double otherwise) {
    for (const DxfPair& pair : entity.pairs) {
      if (pair.code == code) return NumberOf(pair);
    }
    return otherwise;
  }
  Vec2 Point(const DxfEntity& entity, int code) { return {Number(entity, code, 0.0), Number(entity, code + 10, 0.0)}; }
  static std::string Text(const DxfEntity& entity, int code) {
    for (const DxfPair& pair : entity.pairs) {
      if (pair.code == code) return std::string(pair.value);
    }
    return "";
  }

  bool Check(const DxfEntity& entity, bool has_room) {
    if (has_room) return !error_;
    if (builder_.has_bad_number())
      return Fail(entity.line, "found a point beyond 1000 km, expected one in the drawing");
    return Fail(entity.line, "found more than " + std::to_string(kMaxPlanLines) + " lines, expected a smaller drawing");
  }

  // `layer`: of the insert, which entities on layer 0 of a block take over. False: an error.
  bool Draw(const DxfEntity& entity, const PlanTransform& outer, const std::string& of_insert, int depth) {
    // What has no lines counts, too, so that blocks in blocks stand for a bounded work.
    if (++drawn_ > kMaxDrawn) return Fail(entity.line, "found more than 2000000 entities in blocks, expected fewer");
    if (Number(entity, 67, 0.0) == 1.0 || Number(entity, 60, 0.0) == 1.0) return true;  // a page, or invisible
    std::string layer = Text(entity, 8);
    if (depth > 0 && (layer.empty() || layer == "0")) layer = of_insert;
    // Flat entities seen from below have a frame with x to the other side.
    const PlanTransform to_plan =
        entity.type != "LINE" && Number(entity, 230, 1.0) < 0.0 ? outer * PlanTransform::Scale(-1.0, 1.0) : outer;
    if (entity.type == "LINE") {
      return Check(entity, builder_.AddLine(layer, to_plan, Point(entity, 10), Point(entity, 11)));
    }
    if (entity.type == "CIRCLE" || entity.type == "ARC") {
      const double radius = Number(entity, 40, 0.0);
      const bool is_arc = entity.type == "ARC";
      const double from = is_arc ? DegreesToRadians(Number(entity, 50, 0.0)) : 0.0;
      double sweep = is_arc ? DegreesToRadians(Number(entity, 51, 0.0)) - from : 2.0 * kPi;
      sweep = is_arc ? std::fmod(sweep, 2.0 * kPi) : sweep;
      if (sweep <= 0.0) sweep += 2.0 * kPi;
      return Check(entity, builder_.AddArc(layer, to_plan, Point(entity, 10), {radius, radius}, 0.0, from, sweep));
    }
    if (entity.type == "LWPOLYLINE" || entity.type == "POLYLINE") return DrawPolyline(entity, to_plan, layer);
    if (entity.type == "INSERT") return DrawInsert(entity, to_plan, layer, depth);
    if (entity.type == "ELLIPSE" || entity.type == "SPLINE") {
      ++left_out_.emplace(std::string(entity.type), std::pair(entity.line, 0)).first->second.second;
    }
    return true;
  }

  bool DrawPolyline(const DxfEntity& entity, const PlanTransform& to_plan, const std::string& layer) {
    struct Corner {
      Vec2 place{0.0, 0.0};
      double bulge = 0.0;  // the tangent of a quarter of the arc to the next
    };
    std::vector<Corner> corners;
    const auto flags = static_cast<int>(std::clamp(Number(entity, 70, 0.0), 0.0, 65535.0));
    if ((flags & (16 | 64)) != 0) {  // meshes
      ++left_out_.emplace("POLYLINE of a mesh", std::pair(entity.line, 0)).first->second.second;
      return true;
    }
    for (const DxfPair& pair : entity.pairs) {
      if (entity.type == "POLYLINE") break;
      if (pair.code == 10) corners.emplace_back().place.x() = NumberOf(pair);
      if (corners.empty()) continue;
      if (pair.code == 20) corners.back().place.y() = NumberOf(pair);
      if (pair.code == 42) corners.back().bulge = NumberOf(pair);
    }
    for (const DxfEntity& vertex : entity.vertices) {
      const auto kind = static_cast<int>(std::clamp(Number(vertex, 70, 0.0), 0.0, 65535.0));
      if ((kind & 16) != 0) continue;  // a control point of a spline
      corners.push_back({Point(vertex, 10), Number(vertex, 42, 0.0)});
    }
    const std::size_t count = corners.size() < 2 ? 0 : (flags & 1) != 0 ? corners.size() : corners.size() - 1;
    for (std::size_t i = 0; i < count; ++i) {
      if (!Check(entity, AddPart(corners[i].place, corners[(i + 1) % corners.size()].place, corners[i].bulge, layer,
                                 to_plan))) {
        return false;
      }
    }
    return !error_;
  }

  bool AddPart(const Vec2& start, const Vec2& end, double bulge, const std::string& layer,
               const PlanTransform& to_plan) {
    const Vec2 way = end - start;
    if (std::fabs(bulge) < 1e-9 || way.norm() == 0.0) return builder_.AddLine(layer, to_plan, start, end);
    // The arc turns by 4 atan(bulge), to the left if that is positive; its middle is beside that of the chord.
    const double sweep = 4.0 * Atan2(bulge, 1.0);
    const Vec2 left(-way.y(), way.x());
    const Vec2 center = 0.5 * (start + end) + (1.0 - bulge * bulge) / (4.0 * bulge) * left;
    const Vec2 from = start - center;
    const double radius = from.norm();
    return builder_.AddArc(layer, to_plan, center, {radius, radius}, 0.0, Atan2(from.y(), from.x()), sweep);
  }

  bool DrawInsert(const DxfEntity& entity, const PlanTransform& outer, const std::string& layer, int depth) {
    const auto block = blocks_.find(Text(entity, 2));
    if (block == blocks_.end()) {
      return Fail(entity.line, "found no block " + Quoted(Text(entity, 2)) + ", expected one of the section BLOCKS");
    }
    if (depth == kMaxBlockDepth) {
      return Fail(entity.line, "found blocks more than 16 deep, or a block in itself, expected fewer");
    }
    const Vec2 place = Point(entity, 10);
    const PlanTransform turn = PlanTransform::Turn(DegreesToRadians(Number(entity, 50, 0.0)));
    const PlanTransform own = PlanTransform::Scale(Number(entity, 41, 1.0), Number(entity, 42, 1.0)) *
                              PlanTransform::Shift(-block->second.base.x(), -block->second.base.y());
    const double columns = std::max(1.0, Number(entity, 70, 1.0));
    const double rows = std::max(1.0, Number(entity, 71, 1.0));
    if (columns * rows > kMaxCopies)
      return Fail(entity.line, "found more than 10000 copies of a block, expected fewer");
    drawn_ += static_cast<std::size_t>(columns * rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const PlanTransform shift =
            PlanTransform::Shift(column * Number(entity, 44, 0.0), row * Number(entity, 45, 0.0));
        const PlanTransform to_plan = outer * PlanTransform::Shift(place.x(), place.y()) * turn * shift * own;
        for (const DxfEntity& part : block->second.entities) {
          if (!Draw(part, to_plan, layer, depth + 1)) return false;
        }
      }
    }
    return !error_;
  }

  std::string_view text_;
  const std::string& path_;
  PlanUnit unit_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::vector<DxfPair> pairs_;
  std::vector<DxfEntity> entities_;
  std::map<std::string, DxfBlock> blocks_;
  DxfBlock unnamed_;  // a block before its name is read
  std::size_t drawn_ = 0;
  PlanBuilder builder_;
  std::map<std::string, std::pair<int, int>> left_out_;  // by type: the line of the first, and how many
  std::optional<Error> error_;
};

}  // namespace

Result<FloorPlan> ReadDxfPlan(std::string_view text, const std::string& path, PlanUnit unit) {
  return DxfReader(text, path, unit).Read();
}

}  // namespace troupe
