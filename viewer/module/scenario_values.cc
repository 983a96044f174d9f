#include "viewer/module/scenario_values.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace troupe {
namespace {

using Json = nlohmann::json;

// Values are named for the thing that a reader knows: a robot, a rule or the run.
class ValueList {
 public:
  Json Release() { return std::move(list_); }

  void AddMember(const std::string& of, const std::string& path, const JsonNode& object, const char* name) {
    if (const JsonNode* const value = object.Find(name)) Add(of, path.empty() ? name : path + "." + name, *value);
  }

  // Of the member "controller" of an object, unless that is a name alone.
  void AddController(const std::string& of, const std::string& path, const JsonNode& object) {
    const JsonNode* const controller = object.Find("controller");
    if (controller == nullptr || !controller->is_object()) return;
    const JsonNode* const parameters = controller->Find("parameters");
    if (parameters == nullptr || !parameters->is_object()) return;
    const std::string before = (path.empty() ? "" : path + ".") + "controller.parameters.";
    for (const JsonNode& parameter : parameters->items) Add(of, before + parameter.key, parameter);
  }

 private:
  void Add(const std::string& of, const std::string& path, const JsonNode& value) {
    if (!value.is_number() && !value.is_boolean()) return;
    const Json shown = value.is_number() ? Json::parse(value.text) : Json(value.is_true());
    list_.push_back({{"of", of}, {"name", value.key}, {"path", path}, {"value", shown}});
  }

  Json list_ = Json::array();
};

std::string TextOf(const JsonNode& object, const char* name) {
  const JsonNode* const text = object.Find(name);
  return text != nullptr && text->is_string() ? text->text : std::string();
}

}  // namespace

Json ChangeableValues(const JsonNode& root) {
  ValueList values;
  values.AddMember("run", "", root, "ticks");
  values.AddController("robots", "", root);
  for (const char* const rules : {"spawn", "robots"}) {
    const JsonNode* const list = root.Find(rules);
    if (list == nullptr || !list->is_array()) continue;
    for (std::size_t i = 0; i < list->items.size(); ++i) {
      const JsonNode& item = list->items[i];
      if (!item.is_object()) continue;
      const std::string path = std::string(rules) + "[" + std::to_string(i) + "]";
      std::string of = TextOf(item, "name");
      if (of.empty()) of = TextOf(item, "name_prefix");
      if (of.empty()) of = TextOf(item, "model");
      values.AddMember(of, path, item, "count");
      values.AddController(of, path, item);
    }
  }
  return values.Release();
}

}  // namespace troupe
