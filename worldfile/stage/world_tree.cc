#include "worldfile/stage/world_tree.h"

#include <algorithm>
#include <map>
#include <numbers>

namespace troupe {

const Property* WorldNode::Find(const std::string& property_name) const {
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

std::vector<Property> LastOfEachName(std::vector<Property> properties) {
  if (properties.size() < 2) return properties;
  std::vector<std::size_t> order(properties.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
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

FileUnits UnitsOf(const WorldNode& world) {
  const auto is = [&](const char* name, const char* unit) {
    const std::string* const text = world.FindContent<std::string>(name);
    return text != nullptr && *text == unit;
  };
  const double metres = is("unit_length", "cm") ? 0.01 : is("unit_length", "mm") ? 0.001 : 1.0;
  return {metres, is("unit_angle", "radians") ? 1.0 : std::numbers::pi / 180.0};
}

bool IsModelType(const std::string& type) {
  return type != "block" && type != "sensor" && type != "window";
}

std::vector<std::string> ChildNames(const WorldNode& parent) {
  std::map<std::string, int> counts;
  std::vector<std::string> names;
  for (const WorldNode& child : parent.children) {
    if (!IsModelType(child.type)) {
      names.emplace_back();
      continue;
    }
    const int number = counts[child.type]++;
    const std::string* const text = child.FindContent<std::string>("name");
    names.push_back(text != nullptr ? *text : child.type + ":" + std::to_string(number));
  }
  return names;
}

std::string FullName(const std::string& parent_name, const std::string& name) {
  if (name.starts_with('/')) return name.substr(1);
  return parent_name.empty() ? name : parent_name + "." + name;
}

}  // namespace troupe
