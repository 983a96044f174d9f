#include "worldfile/scenario/scenario_schema.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "common/base/closest_name.h"
#include "worldfile/scenario/scenario_schema_text.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using nlohmann::json;
using Context = std::vector<std::string>;  // "<root>", "[robots]", "[0]", "[pose]"

std::string Step(const std::string& part) {
  return part.substr(1, part.size() - 2);
}

const json& ValueAt(const json& root, const Context& context) {
  const json* value = &root;
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string step = Step(context[i]);
    value = value->is_array() ? &value->at(std::stoul(step)) : &value->at(step);
  }
  return *value;
}

const json& FollowReference(const json& root, const json& schema) {
  const auto reference = schema.find("$ref");
  if (reference == schema.end()) return schema;
  return root.at(json::json_pointer(reference->get<std::string>().substr(1)));
}

// The part of the schema for the value at `context`.
const json& SchemaAt(const json& root, const Context& context, const json& document) {
  const json* schema = &root;
  const json* value = &document;
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string step = Step(context[i]);
    if (value->is_array()) {
      value = &value->at(std::stoul(step));
      schema = &schema->at("items");
    } else {
      value = &value->at(step);
      const auto properties = schema->find("properties");
      const bool named = properties != schema->end() && properties->contains(step);
      schema = named ? &properties->at(step) : &schema->at("additionalProperties");
    }
    schema = &FollowReference(root, *schema);
  }
  return *schema;
}

std::vector<std::string> KeysOf(const json& properties) {
  std::vector<std::string> keys;
  for (const auto& [key, unused] : properties.items()) keys.push_back(key);
  return keys;
}

Error UnknownKey(const SourceLocation& where, const std::string& key, const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  return {where, "found the key " + Quoted(key) + ", expected one of " + list + DidYouMean(key, known)};
}

struct Member {
  std::string key;
  const json* value;
};

// The first member of `object`, in the order of the text, that the schema does not know.
std::optional<Member> FindUnknownMember(const JsonDocument& document, const json& schema, const json& object) {
  const auto additional = schema.find("additionalProperties");
  if (additional == schema.end() || !additional->is_boolean()) return std::nullopt;
  std::optional<Member> first;
  for (const auto& [key, value] : object.items()) {
    if (schema.at("properties").contains(key)) continue;
    if (!first || document.Offset(value) < document.Offset(*first->value)) first = Member{key, &value};
  }
  return first;
}

std::optional<std::string> FindMissingKey(const json& schema, const json& object) {
  const auto required = schema.find("required");
  if (required == schema.end()) return std::nullopt;
  for (const json& key : *required) {
    if (!object.contains(key.get<std::string>())) return key.get<std::string>();
  }
  return std::nullopt;
}

// The error of `value`, which breaks `schema`.
Error Explain(const JsonDocument& document, const json& root_schema, const json& schema, const json& value) {
  if (value.is_object()) {
    if (const std::optional<Member> unknown = FindUnknownMember(document, schema, value)) {
      return UnknownKey(document.WhereKey(*unknown->value), unknown->key, KeysOf(schema.at("properties")));
    }
    if (const std::optional<std::string> missing = FindMissingKey(schema, value)) {
      const json& expected = FollowReference(root_schema, schema.at("properties").at(*missing));
      return {document.Where(value),
              "found no '" + *missing + "' in this object, expected " + expected.at("description").get<std::string>()};
    }
  }
  return document.ErrorAt(value,
                          "found " + Describe(value) + ", expected " + schema.at("description").get<std::string>());
}

}  // namespace

struct ScenarioSchema::Compiled {
  json text;
  valijson::Schema schema;
};

ScenarioSchema::ScenarioSchema() {
  auto compiled = std::make_unique<Compiled>();
  compiled->text = json::parse(kScenarioSchemaText);
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(compiled->text), compiled->schema);
  compiled_ = std::move(compiled);
}

ScenarioSchema::~ScenarioSchema() = default;
ScenarioSchema::ScenarioSchema(ScenarioSchema&&) noexcept = default;
ScenarioSchema& ScenarioSchema::operator=(ScenarioSchema&&) noexcept = default;

Status ScenarioSchema::Check(const JsonDocument& document) const {
  valijson::Validator validator;
  const valijson::adapters::NlohmannJsonAdapter root(document.root());
  if (validator.validate(compiled_->schema, root, nullptr)) return Status();
  valijson::ValidationResults results;
  validator.validate(compiled_->schema, root, &results);
  // A fault is reported for the value and again for everything around it: the innermost one that starts first counts.
  const Context* first = nullptr;
  std::size_t first_offset = 0;
  for (const auto& fault : results) {
    const std::size_t offset = document.Offset(ValueAt(document.root(), fault.context));
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
  return Explain(document, compiled_->text, SchemaAt(compiled_->text, *first, document.root()),
                 ValueAt(document.root(), *first));
}

}  // namespace troupe
