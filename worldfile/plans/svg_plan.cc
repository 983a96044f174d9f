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
#include "worldfile/text/xml_reader.h"

namespace troupe {
namespace {

// The numbers of an attribute, separated by blanks and commas, where the sign of the next may follow at once.
class SvgNumbers {
 public:
  explicit SvgNumbers(std::string_view text) : text_(text) {}

  void Skip() {
    while (at_ < text_.size() && (IsBlank(text_[at_]) || text_[at_] == ',')) ++at_;
  }
  bool is_at_end() {
    Skip();
    return at_ >= text_.size();
  }
  // A letter of a path; 0 at a number.
  char Letter() {
    Skip();
    const char c = at_ < text_.size() ? text_[at_] : '\0';
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (is_letter) ++at_;
    return is_letter ? c : '\0';
  }
  std::optional<double> Number() {
    Skip();
    std::size_t begin = at_;
    if (begin < text_.size() && text_[begin] == '+') ++begin;
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text_.data() + begin, text_.data() + text_.size(), value);
    if (failure != std::errc() || !std::isfinite(value)) return std::nullopt;
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  // "0" or "1", which need no separator behind them.
  std::optional<bool> Flag() {
    Skip();
    if (at_ >= text_.size() || (text_[at_] != '0' && text_[at_] != '1')) return std::nullopt;
    return text_[at_++] == '1';
  }
  std::string_view rest() const { return text_.substr(std::min(at_, text_.size())); }

  static bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// m, of a length with a unit of paper; nothing for pixels and percents.
std::optional<double> PaperLength(const std::string& text) {
  SvgNumbers numbers(text);
  const std::optional<double> value = numbers.Number();
  if (!value) return std::nullopt;
  const std::string_view unit = numbers.rest();
  for (const auto& [name, metres] : {std::pair{"mm", 0.001}, std::pair{"cm", 0.01}, std::pair{"in", 0.0254},
                                     std::pair{"pt", 0.0254 / 72.0}, std::pair{"pc", 0.0254 / 6.0}}) {
    if (unit == name) return *value * metres;
  }
  return std::nullopt;
}

class SvgReader {
 public:
  SvgReader(const XmlElement& root, const std::string& path, PlanUnit unit) : root_(root), path_(path), unit_(unit) {}

  Result<FloorPlan> Read() {
    if (LocalName(root_.name) != "svg") {
      return Error{XmlPlace(root_, path_), "found the element " + Quoted(root_.name) + ", expected 'svg'"};
    }
    const std::optional<double> unit = unit_ ? unit_ : UnitOfPage();
    if (error_) return *error_;
    if (!unit) {
      return Error{XmlPlace(root_, path_),
                   "found no size of the page in mm, cm or in with a viewBox, expected one, or --unit m, cm, mm, in, "
                   "ft or metres of a unit"};
    }
    // y is up in a plan.
    for (const XmlElement& child : root_.children) {
      if (!Draw(child, PlanTransform::Scale(*unit, -*unit), "", 1)) break;
    }
    if (error_) return *error_;
    FloorPlan plan = builder_.Take();
    for (const auto& [name, element] : left_out_) {
      plan.warnings.push_back({XmlPlace(*element, path_), "found an element " + Quoted(name) + ", which is left out"});
    }
    return plan;
  }

 private:
  bool Fail(const SourceLocation& where, const std::string& message) {
    if (!error_) error_ = Error{where, message};
    return false;
  }

  static std::string_view LocalName(std::string_view name) {
    const std::size_t colon = name.rfind(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
  }

  std::optional<double> UnitOfPage() {
    const std::string* const width = root_.FindAttribute("width");
    const std::string* const box = root_.FindAttribute("viewBox");
    if (width == nullptr || box == nullptr) return std::nullopt;
    const std::optional<double> metres = PaperLength(*width);
    const std::vector<double> numbers = Numbers(root_, "viewBox", 4);
    if (!metres || numbers.size() != 4 || !(numbers[2] > 0.0)) return std::nullopt;
    return *metres / numbers[2];
  }

  const XmlAttribute* Attribute(const XmlElement& element, std::string_view name) const {
    for (const XmlAttribute& attribute : element.attributes) {
      if (attribute.name == name) return &attribute;
    }
    return nullptr;
  }

  // All numbers of an attribute, `count` of them if that is above 0; none without the attribute.
  std::vector<double> Numbers(const XmlElement& element, std::string_view name, std::size_t count = 0) {
    const XmlAttribute* const attribute = Attribute(element, name);
    std::vector<double> numbers;
    if (attribute == nullptr) return numbers;
    SvgNumbers reader(attribute->value);
    while (!reader.is_at_end()) {
      const std::optional<double> number = reader.Number();
      if (!number) {
        Fail(XmlPlace(*attribute, path_), "found " + Quoted(std::string(reader.rest().substr(0, 20))) + " in '" +
                                              std::string(name) + "', expected a number");
        return {};
      }
      numbers.push_back(*number);
    }
    if (count > 0 && numbers.size() != count) {
      Fail(XmlPlace(*attribute, path_), "found " + std::to_string(numbers.size()) + " numbers in '" +
                                            std::string(name) + "', expected " + std::to_string(count));
    }
    return numbers;
  }
  // The number of an attribute in units of the file, "px" included.
  double Number(const XmlElement& element, std::string_view name, double otherwise = 0.0) {
    const XmlAttribute* const attribute = Attribute(element, name);
    if (attribute == nullptr) return otherwise;
    SvgNumbers reader(attribute->value);
    const std::optional<double> number = reader.Number();
    if (number && (reader.is_at_end() || reader.rest() == "px")) return *number;
    Fail(XmlPlace(*attribute, path_), "found " + Quoted(attribute->value.substr(0, 40)) + " for '" + std::string(name) +
                                          "', expected a number without a unit");
    return otherwise;
  }

  PlanTransform TransformOf(const XmlElement& element) {
    const XmlAttribute* const attribute = Attribute(element, "transform");
    PlanTransform transform;
    if (attribute == nullptr) return transform;
    std::string_view text = attribute->value;
    const auto fail = [&] {
      Fail(XmlPlace(*attribute, path_),
           "found " + Quoted(std::string(text.substr(0, 40))) +
               " in 'transform', expected matrix, translate, scale, rotate, skewX or skewY with their numbers");
      return PlanTransform();
    };
    while (true) {
      while (!text.empty() && (SvgNumbers::IsBlank(text.front()) || text.front() == ',')) text.remove_prefix(1);
      if (text.empty()) return transform;
      const std::size_t open = text.find('(');
      const std::size_t close = text.find(')');
      if (open == std::string_view::npos || close == std::string_view::npos || close < open) return fail();
      std::string_view name = text.substr(0, open);
      while (!name.empty() && SvgNumbers::IsBlank(name.back())) name.remove_suffix(1);
      SvgNumbers reader(text.substr(open + 1, close - open - 1));
      std::vector<double> n;
      while (!reader.is_at_end()) {
        const std::optional<double> number = reader.Number();
        if (!number) return fail();
        n.push_back(*number);
      }
      if (name == "matrix" && n.size() == 6) {
        transform = transform * PlanTransform{n[0], n[1], n[2], n[3], n[4], n[5]};
      } else if (name == "translate" && (n.size() == 1 || n.size() == 2)) {
        transform = transform * PlanTransform::Shift(n[0], n.size() == 2 ? n[1] : 0.0);
      } else if (name == "scale" && (n.size() == 1 || n.size() == 2)) {
        transform = transform * PlanTransform::Scale(n[0], n.size() == 2 ? n[1] : n[0]);
      } else if (name == "rotate" && (n.size() == 1 || n.size() == 3)) {
        const PlanTransform turn = PlanTransform::Turn(DegreesToRadians(n[0]));
        transform = n.size() == 1
                        ? transform * turn
                        : transform * PlanTransform::Shift(n[1], n[2]) * turn * PlanTransform::Shift(-n[1], -n[2]);
      } else if ((name == "skewX" || name == "skewY") && n.size() == 1) {
        const SinCosResult angle = SinCos(DegreesToRadians(n[0]));
        const double tangent = angle.sin / angle.cos;
        transform = transform * (name == "skewX" ? PlanTransform{1.0, 0.0, tangent, 1.0, 0.0, 0.0}
                                                 : PlanTransform{1.0, tangent, 0.0, 1.0, 0.0, 0.0});
      } else {
        return fail();
      }
      text.remove_prefix(close + 1);
    }
  }

  static bool IsHidden(const XmlElement& element) {
    const std::string* const display = element.FindAttribute("display");
    const std::string* const style = element.FindAttribute("style");
    if (display != nullptr && *display == "none") return true;
    return style != nullptr &&
           (style->find("display:none") != std::string::npos || style->find("display: none") != std::string::npos);
  }

  bool Check(const XmlElement& element, bool has_room) {
    if (error_) return false;
    if (has_room) return true;
    if (builder_.has_bad_number()) {
      return Fail(XmlPlace(element, path_), "found a point beyond 1000 km, expected one in the drawing");
    }
    return Fail(XmlPlace(element, path_),
                "found more than " + std::to_string(kMaxPlanLines) + " lines, expected a smaller drawing");
  }

  // `depth`: 1 for the children of the root. False: an error.
  bool Draw(const XmlElement& element, const PlanTransform& outer, const std::string& outer_layer, int depth) {
    if (IsHidden(element)) return true;
    const std::string_view name = LocalName(element.name);
    const PlanTransform to_plan = outer * TransformOf(element);
    if (error_) return false;
    if (name == "g" || name == "svg" || name == "a" || name == "switch") {
      std::string layer = outer_layer;
      const std::string* const mode = element.FindAttribute("inkscape:groupmode");
      const std::string* const label = element.FindAttribute("inkscape:label");
      const std::string* const id = element.FindAttribute("id");
      if (mode != nullptr && *mode == "layer" && label != nullptr) {
        layer = *label;
      } else if (depth == 1 && id != nullptr) {
        layer = *id;
      }
      for (const XmlElement& child : element.children) {
        if (!Draw(child, to_plan, layer, depth + 1)) return false;
      }
      return true;
    }
    if (name == "path") return DrawPath(element, to_plan, outer_layer);
    const auto number = [&](const char* key) { return Number(element, key); };
    if (name == "line") {
      const Vec2 start(number("x1"), number("y1"));
      const Vec2 end(number("x2"), number("y2"));
      return Check(element, builder_.AddLine(outer_layer, to_plan, start, end));
    }
    if (name == "rect") {
      const Vec2 a(number("x"), number("y"));
      const Vec2 size(number("width"), number("height"));
      const Vec2 corners[4] = {a, {a.x() + size.x(), a.y()}, a + size, {a.x(), a.y() + size.y()}};
      return DrawPoints(element, {corners, corners + 4}, true, to_plan, outer_layer);
    }
    if (name == "polyline" || name == "polygon") {
      const std::vector<double> numbers = Numbers(element, "points");
      std::vector<Vec2> points;
      for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
      return DrawPoints(element, points, name == "polygon", to_plan, outer_layer);
    }
    if (name == "circle" || name == "ellipse") {
      const bool is_circle = name == "circle";
      const Vec2 radii(number(is_circle ? "r" : "rx"), number(is_circle ? "r" : "ry"));
      const Vec2 center(number("cx"), number("cy"));
      return Check(element, builder_.AddArc(outer_layer, to_plan, center, radii, 0.0, 0.0, 2.0 * kPi));
    }
    if (name == "use" || name == "image") left_out_.emplace(std::string(name), &element);
    return !error_;
  }

  bool DrawPoints(const XmlElement& element, const std::vector<Vec2>& points, bool is_closed,
                  const PlanTransform& to_plan, const std::string& layer) {
    const std::size_t count = points.size() < 2 ? 0 : is_closed ? points.size() : points.size() - 1;
    for (std::size_t i = 0; i < count; ++i) {
      const bool has_room = builder_.AddLine(layer, to_plan, points[i], points[(i + 1) % points.size()]);
      if (!Check(element, has_room)) return false;
    }
    return !error_;
  }

  // By the commands of SVG 1.1; a lower-case letter counts from the present point.
  bool DrawPath(const XmlElement& element, const PlanTransform& to_plan, const std::string& layer) {
    const XmlAttribute* const attribute = Attribute(element, "d");
    if (attribute == nullptr) return true;
    SvgNumbers reader(attribute->value);
    const auto fail = [&] {
      return Fail(XmlPlace(*attribute, path_), "found " + Quoted(std::string(reader.rest().substr(0, 20))) +
                                                   " in 'd', expected a command of a path with its numbers");
    };
    Vec2 here(0.0, 0.0);
    Vec2 start = here;    // of the part
    Vec2 control = here;  // the last control point, of S and T
    char command = '\0';
    char before = '\0';  // in lower case
    const auto line_to = [&](const Vec2& to) {
      const bool has_room = builder_.AddLine(layer, to_plan, here, to);
      here = to;
      return Check(element, has_room);
    };
    const auto curve_to = [&](const Vec2& first, const Vec2& second, const Vec2& to) {
      const bool has_room = builder_.AddCurve(layer, to_plan, here, first, second, to);
      here = to;
      return Check(element, has_room);
    };
    while (!reader.is_at_end()) {
      const char letter = reader.Letter();
      if (letter != '\0') {
        command = letter;
      } else if (command == '\0' || command == 'z' || command == 'Z') {
        return fail();
      } else if (command == 'm' || command == 'M') {
        command = command == 'm' ? 'l' : 'L';  // further points of a move are lines
      }
      const char kind = command >= 'a' ? command : static_cast<char>(command - 'A' + 'a');
      const Vec2 from = command == kind ? here : Vec2(0.0, 0.0);
      bool is_complete = true;
      const auto number = [&] {
        const std::optional<double> value = reader.Number();
        is_complete = is_complete && value.has_value();
        return value.value_or(0.0);
      };
      const auto point = [&] {
        const double x = number();
        const double y = number();
        return Vec2(from.x() + x, from.y() + y);
      };
      bool goes_on = true;
      Vec2 next_control = here;
      switch (kind) {
        case 'z':
          goes_on = line_to(start);
          next_control = here;
          break;
        case 'm':
          here = start = next_control = point();
          break;
        case 'l':
        case 't':
        case 'h':
        case 'v': {
          Vec2 to = here;
          if (kind == 'h') to.x() = from.x() + number();
          if (kind == 'v') to.y() = from.y() + number();
          if (kind == 'l' || kind == 't') to = point();
          if (!is_complete) return fail();
          if (kind == 't') {
            const Vec2 middle = before == 'q' || before == 't' ? Vec2(2.0 * here - control) : here;
            next_control = middle;
            goes_on = curve_to((here + 2.0 * middle) / 3.0, (to + 2.0 * middle) / 3.0, to);
          } else {
            goes_on = line_to(to);
            next_control = here;
          }
          break;
        }
        case 'c':
        case 's': {
          const bool goes_straight_on = before == 'c' || before == 's';
          const Vec2 first = kind == 'c' ? point() : goes_straight_on ? Vec2(2.0 * here - control) : here;
          const Vec2 second = point();
          const Vec2 to = point();
          if (!is_complete) return fail();
          next_control = second;
          goes_on = curve_to(first, second, to);
          break;
        }
        case 'q': {
          const Vec2 middle = point();
          const Vec2 to = point();
          if (!is_complete) return fail();
          next_control = middle;
          goes_on = curve_to((here + 2.0 * middle) / 3.0, (to + 2.0 * middle) / 3.0, to);
          break;
        }
        case 'a': {
          const double rx = std::fabs(number());
          const double ry = std::fabs(number());
          const double turn = DegreesToRadians(number());
          const std::optional<bool> is_large = reader.Flag();
          const std::optional<bool> is_left = reader.Flag();
          const Vec2 to = point();
          if (!is_complete || !is_large || !is_left) return fail();
          goes_on = ArcTo(element, to_plan, layer, here, to, {rx, ry}, turn, *is_large, *is_left);
          here = next_control = to;
          break;
        }
        default:
          return fail();
      }
      if (!is_complete) return fail();
      if (!goes_on) return false;
      control = next_control;
      before = kind;
    }
    return !error_;
  }

  // From the ends of an arc to its centre, as the notes on implementation of SVG 1.1 (F.6) derive it.
  bool ArcTo(const XmlElement& element, const PlanTransform& to_plan, const std::string& layer, const Vec2& from,
             const Vec2& to, Vec2 radii, double turn, bool is_large, bool sweeps) {
    if (radii.x() == 0.0 || radii.y() == 0.0) return Check(element, builder_.AddLine(layer, to_plan, from, to));
    if ((to - from).norm() == 0.0) return true;
    const SinCosResult axis = SinCos(turn);
    const Vec2 half = 0.5 * (from - to);
    const Vec2 p(axis.cos * half.x() + axis.sin * half.y(), -axis.sin * half.x() + axis.cos * half.y());
    const double excess = std::sqrt(p.x() * p.x() / (radii.x() * radii.x()) + p.y() * p.y() / (radii.y() * radii.y()));
    if (excess > 1.0) radii = excess * radii;
    const double a = radii.x() * p.y();
    const double b = radii.y() * p.x();
    const double both = a * a + b * b;
    const double whole = radii.x() * radii.x() * radii.y() * radii.y();
    const double factor = (is_large == sweeps ? -1.0 : 1.0) * std::sqrt(std::max(0.0, (whole - both) / both));
    const Vec2 c(factor * radii.x() * p.y() / radii.y(), -factor * radii.y() * p.x() / radii.x());
    const Vec2 middle = 0.5 * (from + to);
    const Vec2 center(axis.cos * c.x() - axis.sin * c.y() + middle.x(),
                      axis.sin * c.x() + axis.cos * c.y() + middle.y());
    const double begin = Atan2((p.y() - c.y()) / radii.y(), (p.x() - c.x()) / radii.x());
    double sweep = Atan2((-p.y() - c.y()) / radii.y(), (-p.x() - c.x()) / radii.x()) - begin;
    if (sweeps && sweep < 0.0) sweep += 2.0 * kPi;
    if (!sweeps && sweep > 0.0) sweep -= 2.0 * kPi;
    return Check(element, builder_.AddArc(layer, to_plan, center, radii, turn, begin, sweep));
  }

  const XmlElement& root_;
  const std::string& path_;
  PlanUnit unit_;
  PlanBuilder builder_;
  std::map<std::string, const XmlElement*> left_out_;  // by name: the first one; ordered by the name
  std::optional<Error> error_;
};

}  // namespace

Result<FloorPlan> ReadSvgPlan(std::string_view text, const std::string& path, PlanUnit unit) {
  const Result<XmlElement> root = ParseXml(text, path);
  if (!root.ok()) return root.error();
  return SvgReader(root.value(), path, unit).Read();
}

}  // namespace troupe
