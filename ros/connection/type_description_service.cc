#include "ros/connection/type_description_service.h"

#include <algorithm>
#include <cstring>

#include "ros/connection/type_descriptions.h"
#include "ros/connection/type_hash.h"

namespace troupe::ros {
namespace {

using Description = type_description_interfaces_msg_dds__IndividualTypeDescription_;

template <std::size_t kSize>
void CopyText(char (&field)[kSize], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), kSize - 1));  // the field is all zeros
}

void Fill(Description& out, const DescribedType& type, dds::WireArena& arena) {
  CopyText(out.type_name, type.name);
  auto* to = arena.Fill(out.fields, type.fields.size());
  for (const DescribedField& field : type.fields) {
    to->name = arena.Copy(field.name);
    to->type.type_id = field.type;
    to->type.capacity = field.capacity;
    to->type.string_capacity = field.string_capacity;
    CopyText(to->type.nested_type_name, field.nested_type);
    to->default_value = arena.Copy("");
    ++to;
  }
}

// Empty if the request can be answered.
std::string ReasonOfRefusal(const std::string& type, const std::string& hash, bool is_known) {
  if (!is_known) return "found the type '" + type + "', expected one of this node's topics or services";
  const std::string expected = HashOfRosType(type);
  if (hash != expected) return "found the hash '" + hash + "', expected " + expected;
  return "";
}

}  // namespace

TypeDescriptionService::TypeDescriptionService(const RosNode& node, const std::string& name) {
  const Distribution distribution = node.connection->distribution();
  if (distribution == Distribution::kHumble || distribution == Distribution::kIron) return;
  service_ = std::make_unique<RosService<Request, Response>>(
      node, name + "/get_type_description",
      [this](const RosCaller& caller, const Request& request) { Describe(caller, request); }, Service(),
      Serving::kWhenStarted);
  service_->Start();  // after the assignment, because a request may wait
}

void TypeDescriptionService::Describe(const RosCaller& caller, const Request& request) {
  dds::WireArena arena;
  Response response{};
  const std::string name = dds::Text(request.type_name);
  const std::vector<DescribedType> types = DescribeType(name);
  const std::string refusal = ReasonOfRefusal(name, dds::Text(request.type_hash), !types.empty());
  response.successful = refusal.empty();
  response.failure_reason = arena.Copy(refusal);
  if (response.successful) {
    auto& description = response.type_description;
    Fill(description.type_description, types.front(), arena);
    Description* nested = arena.Fill(description.referenced_type_descriptions, types.size() - 1);
    for (std::size_t i = 1; i < types.size(); ++i) Fill(*nested++, types[i], arena);
  }
  service_->Respond(caller, response);
}

}  // namespace troupe::ros
