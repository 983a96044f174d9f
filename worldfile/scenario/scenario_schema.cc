#include "worldfile/scenario/scenario_schema.h"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "common/base/json_reader.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using nlohmann::json;
using Context = std::vector<std::string>;  // "<root>", "[robots]", "[0]", "[pose]"

std::string Step(const std::string& part) {
  return part.substr(1, part.size() - 2);
}

const JsonNode& Inner(const JsonNode& node, const std::string& step) {
  return node.is_array() ? node.items.at(std::stoul(step)) : node.Member(step);
}

const JsonNode& NodeAt(const JsonNode& root, const Context& context) {
  const JsonNode* node = &root;
  for (std::size_t i = 1; i < context.size(); ++i) node = &Inner(*node, Step(context[i]));
  return *node;
}

const json& FollowReference(const json& root, const json& schema) {
  const auto reference = schema.find("$ref");
  if (reference == schema.end()) return schema;
  return root.at(json::json_pointer(reference->get<std::string>().substr(1)));
}

// The part of the schema for the value at `context`.
const json& SchemaAt(const json& root, const Context& context, const JsonNode& document) {
  const json* schema = &root;
  const JsonNode* node = &document;
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string step = Step(context[i]);
    if (node->is_array()) {
      schema = &schema->at("items");
    } else {
      const auto properties = schema->find("properties");
      const bool named = properties != schema->end() && properties->contains(step);
      schema = named ? &properties->at(step) : &schema->at("additionalProperties");
    }
    node = &Inner(*node, step);
    schema = &FollowReference(root, *schema);
  }
  return *schema;
}

std::vector<std::string> KeysOf(const json& properties) {
  std::vector<std::string> keys;
  for (const auto& [key, unused] : properties.items()) keys.push_back(key);
  return keys;
}

// The first member of `object` that the schema does not know; null: it knows all.
const JsonNode* FindUnknownMember(const json& schema, const JsonNode& object) {
  const auto additional = schema.find("additionalProperties");
  if (additional == schema.end() || !additional->is_boolean()) return nullptr;
  const json& known = schema.at("properties");
  const auto first = std::find_if(object.items.begin(), object.items.end(),
                                  [&](const JsonNode& member) { return !known.contains(member.key); });
  return first != object.items.end() ? &*first : nullptr;
}

std::optional<std::string> FindMissingKey(const json& schema, const JsonNode& object) {
  const auto required = schema.find("required");
  if (required == schema.end()) return std::nullopt;
  for (const json& key : *required) {
    const auto& name = key.get_ref<const std::string&>();
    if (object.Find(name) == nullptr) return name;
  }
  return std::nullopt;
}

// The error of `node`, which breaks `schema`.
Error Explain(const JsonTree& tree, const json& root_schema, const json& schema, const JsonNode& node) {
  if (node.is_object()) {
    if (const JsonNode* const unknown = FindUnknownMember(schema, node)) {
      return Error{tree.WhereKey(*unknown), UnknownKeyText(unknown->key, KeysOf(schema.at("properties")))};
    }
    if (const std::optional<std::string> missing = FindMissingKey(schema, node)) {
      const json& expected = FollowReference(root_schema, schema.at("properties").at(*missing));
      return tree.ErrorAt(node, "found no '" + *missing + "' in this object, expected " +
                                    expected.at("description").get<std::string>());
    }
  }
  return tree.ErrorAt(node, "found " + Describe(node) + ", expected " + schema.at("description").get<std::string>());
}

struct Compiled {
  json text;
  valijson::Schema schema;
};

// Once in a process: that takes a third of the time in which a small scenario is loaded.
const Compiled& CompiledSchema() {
  static const std::unique_ptr<const Compiled> compiled = [] {
    auto made = std::make_unique<Compiled>();
    made->text = json::parse(kScenarioSchemaText);
    valijson::SchemaParser parser;
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(made->text), made->schema);
    return made;
  }();
  return *compiled;
}

}  // namespace

Status CheckSchema(const JsonTree& tree) {
  const Compiled& compiled = CompiledSchema();
  valijson::Validator validator;
  const json values = ToJson(tree.root());
  const valijson::adapters::NlohmannJsonAdapter root(values);
  // Most scenarios are valid: results are collected for a breach only.
  if (validator.validate(compiled.schema, root, nullptr)) return Status();
  valijson::ValidationResults results;
  validator.validate(compiled.schema, root, &results);
  // A fault is reported for the value and again for everything around it: the innermost one that starts first counts.
  const Context* first = nullptr;
  std::size_t first_offset = 0;
  for (const auto& fault : results) {
    const std::size_t offset = NodeAt(tree.root(), fault.context).span.begin;
    const bool inside = first != nullptr && fault.context.size() > first->size() &&
                        std::equal(first->begin(), first->end(), fault.context.begin());
    const bool around = first != nullptr && fault.context.size() < first->size() &&
                        std::equal(fault.context.begin(), fault.context.end(), first->begin());
    if (first == nullptr || inside || (!around && offset < first_offset)) {
      first = &fault.context;
      first_offset = offset;
    }
  }
  TROUPE_CHECK(first != nullptr);
  // The library's own texts name schema keywords; the schema's descriptions say what a user should write.
  return Explain(tree, compiled.text, SchemaAt(compiled.text, *first, tree.root()), NodeAt(tree.root(), *first));
}

}  // namespace troupe
