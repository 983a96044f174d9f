#include "viewer/editor/part_requests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestPath = 20;
constexpr std::array kRoles{"left_finger", "right_finger", "left_pad", "right_pad", "lift"};

Error UnknownPart() {
  return {{}, "found no part of that number"};
}

}  // namespace

Result<PartPath> PartPathIn(const Json& request, const char* key) {
  const auto list = request.find(key);
  PartPath path;
  if (list == request.end()) return path;
  if (!list->is_array() || list->size() > kLongestPath) return UnknownPart();
  for (const Json& step : *list) {
    const std::optional<std::size_t> index = IndexOf(step);
    if (!index) return UnknownPart();
    path.push_back(*index);
  }
  return path;
}

Result<PartShape> PartShapeIn(const Json& request, bool may_be_empty) {
  PartShape shape;
  const auto given = request.find("shape");
  if (given == request.end() && may_be_empty) return shape;
  if (given == request.end() || !given->is_object()) return Error{{}, "found no shape, expected an object"};
  std::size_t read = 0;
  if (given->contains("pose")) {
    shape.pose = PoseIn(*given, "pose");
    if (!shape.pose) return Error{{}, "found no pose, expected four finite numbers"};
    ++read;
  }
  const auto numbers = [&](const char* key, std::size_t count, std::optional<std::vector<double>>& target) -> Status {
    if (!given->contains(key)) return {};
    target = NumbersIn(*given, key, count);
    ++read;
    if (target) return {};
    return Error{{}, "found no " + Quoted(key) + ", expected " + std::to_string(count) + " finite numbers"};
  };
  for (const auto& [key, count, target] : {std::tuple("size", 3U, &shape.size),
                                           {"paddle", 3U, &shape.paddle},
                                           {"axis", 3U, &shape.axis},
                                           {"limits", 2U, &shape.limits}}) {
    if (Status wrong = numbers(key, count, *target); !wrong.ok()) return wrong.error();
  }
  const auto is_positive = [](double length) { return length > 0.0; };
  for (const auto* const lengths : {&shape.size, &shape.paddle}) {
    if (*lengths && !std::all_of((*lengths)->begin(), (*lengths)->end(), is_positive))
      return Error{{}, "found a size that is not above 0, expected lengths"};
  }
  if (shape.axis && std::hypot((*shape.axis)[0], (*shape.axis)[1], (*shape.axis)[2]) < 1e-6)
    return Error{{}, "found the axis [0 0 0], expected a direction"};
  if (given->contains("blocks")) {
    Result<std::vector<DrawnBlock>> blocks = BlocksIn(*given, 1.0);
    if (!blocks.ok()) return blocks.error();
    if (blocks.value().empty()) return Error{{}, "found no blocks, expected one or more"};
    shape.blocks = std::move(blocks).value();
    ++read;
  }
  if (read != given->size() || (read == 0 && !may_be_empty))
    return Error{{}, "found another shape, expected pose, size, paddle, axis, limits or blocks"};
  return shape;
}

Result<GripperRoles> GripperRolesIn(const Json& request) {
  const auto given = request.find("roles");
  if (given == request.end() || !given->is_object() || given->empty())
    return Error{{}, "found no roles, expected an object"};
  GripperRoles roles;
  for (const auto& [role, path] : given->items()) {
    if (std::find(kRoles.begin(), kRoles.end(), role) == kRoles.end())
      return Error{{}, "found the role " + Quoted(role) + ", expected one of a gripper"};
    if (path.is_null()) {
      roles.emplace_back(role, std::nullopt);
      continue;
    }
    Result<PartPath> read = PartPathIn(*given, role.c_str());
    if (!read.ok()) return read.error();
    if (read.value().empty()) return UnknownPart();
    roles.emplace_back(role, std::move(read).value());
  }
  return roles;
}

}  // namespace troupe
