#include "worldfile/stage/node_names.h"

#include <map>

namespace troupe {

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
    const Property* given = child.Find("name");
    const std::string* text = given != nullptr ? std::get_if<std::string>(&given->value.content) : nullptr;
    names.push_back(text != nullptr ? *text : child.type + ":" + std::to_string(number));
  }
  return names;
}

std::string FullName(const std::string& parent_name, const std::string& name) {
  if (name.starts_with('/')) return name.substr(1);
  return parent_name.empty() ? name : parent_name + "." + name;
}

}  // namespace troupe
