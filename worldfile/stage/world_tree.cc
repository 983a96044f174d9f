#include "worldfile/stage/world_tree.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

namespace troupe {

// Copy on write: instances of a define share their children until one of them is changed.
WorldNode& ChildNodes::Change(std::size_t i) {
  if (nodes_[i].use_count() > 1) nodes_[i] = std::make_shared<WorldNode>(*nodes_[i]);
  return *nodes_[i];
}

void ChildNodes::Add(WorldNode node) {
  nodes_.push_back(std::make_shared<WorldNode>(std::move(node)));
}

ChildNodes ChildNodes::Selected(const std::vector<std::size_t>& indices) const {
  ChildNodes selected;
  for (const std::size_t i : indices) selected.nodes_.push_back(nodes_[i]);
  return selected;
}

const Property* WorldNode::Find(std::string_view property_name) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const Property& property) { return property.name == property_name; });
  return found == properties.end() ? nullptr : &*found;
}

void WorldNode::Set(Property property) {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const Property& other) { return other.name == property.name; });
  if (found == properties.end()) {
    properties.push_back(std::move(property));
  } else {
    *found = std::move(property);
  }
}

// The last value counts, at the place of the first: the order of properties stays that of the file.
std::vector<Property> LastOfEachName(std::vector<Property> properties) {
  if (properties.size() < 2) return properties;
  std::vector<std::size_t> order(properties.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // Sorted indices instead of a search for each: a bitmap-like block has thousands of points.
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return properties[a].name < properties[b].name; });
  std::vector<bool> dropped(properties.size());
  bool any = false;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && properties[order[end]].name == properties[order[begin]].name) {
      dropped[order[end++]] = any = true;
    }
    if (end - begin > 1) properties[order[begin]] = std::move(properties[order[end - 1]]);
    begin = end;
  }
  if (!any) return properties;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (dropped[i]) continue;
    if (kept != i) properties[kept] = std::move(properties[i]);
    ++kept;
  }
  properties.resize(kept);
  return properties;
}

// Factors to metres and radians. Stage's own units are metres and degrees.
FileUnits UnitsOf(const WorldNode& world) {
  const auto is = [&](const char* name, const char* unit) {
    const std::string* const text = world.FindContent<std::string>(name);
    return text != nullptr && *text == unit;
  };
  const double metres = is("unit_length", "cm") ? 0.01 : is("unit_length", "mm") ? 0.001 : 1.0;
  return {metres, is("unit_angle", "radians") ? 1.0 : std::numbers::pi / 180.0};
}

// Blocks, sensors of a ranger and the window are parts of others and have no name.
bool IsModelType(const std::string& type) {
  return type != "block" && type != "sensor" && type != "window";
}

// A number is a name, too, in its spelling.
std::optional<std::string> GivenName(const WorldNode& node) {
  std::string name;
  if (const auto* const text = node.FindContent<std::string>("name")) {
    name = *text;
  } else if (const auto* const number = node.FindContent<Value::Number>("name")) {
    name = number->text;
  }
  const bool is_usable = !name.empty() && name != "/" && name.back() != '.';
  return is_usable ? std::optional(name) : std::nullopt;
}

// Each name has its next number, so that thousands of equal names do not cost a search each.
std::string FreeNames::Add(const std::string& name) {
  const auto [entry, is_new] = next_.emplace(name, 2);
  if (is_new) return name;
  std::string free;
  do {
    free = name + ":" + std::to_string(entry->second++);
  } while (!next_.emplace(free, 2).second);
  return free;
}

// As Stage counts: "TYPE:N" with N among the siblings of the type.
std::vector<std::string> ChildNames(const WorldNode& parent) {
  std::map<std::string, int> counts;
  FreeNames free;
  std::vector<std::string> names;
  for (const WorldNode& child : parent.children) {
    if (!IsModelType(child.type)) {
      names.emplace_back();
      continue;
    }
    const int number = counts[child.type]++;
    names.push_back(free.Add(GivenName(child).value_or(child.type + ":" + std::to_string(number))));
  }
  return names;
}

// A leading slash makes a name that does not depend on the parent.
std::string FullName(const std::string& parent_name, const std::string& name) {
  if (name.starts_with('/')) return name.substr(1);
  return parent_name.empty() ? name : parent_name + "." + name;
}

}  // namespace troupe
