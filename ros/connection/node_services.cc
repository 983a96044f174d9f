#include "ros/connection/node_services.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "idl/ros/parameters.h"
#include "ros/connection/type_descriptions.h"
#include "transport/dds/binding/wire.h"
#include "troupe/result.h"

namespace troupe::ros {
namespace {

using Value = rcl_interfaces_msg_dds__ParameterValue_;
using SetResult = rcl_interfaces_msg_dds__SetParametersResult_;
using Descriptor = rcl_interfaces_msg_dds__ParameterDescriptor_;

constexpr std::int32_t kDepth = 1000;
constexpr std::uint8_t kNotSet = 0;

// As rcl_interfaces/msg/ParameterType numbers them: 1 bool, 2 integer, 3 double, 4 string.
std::uint8_t TypeOf(const ParameterValue& value) {
  return static_cast<std::uint8_t>(value.index() + 1);  // in the order of the variant
}

void Fill(Value& out, const ParameterValue& value, dds::WireArena& arena) {
  out.type = TypeOf(value);
  if (const bool* truth = std::get_if<bool>(&value)) out.bool_value = *truth;
  if (const std::int64_t* integer = std::get_if<std::int64_t>(&value)) out.integer_value = *integer;
  if (const double* number = std::get_if<double>(&value)) out.double_value = *number;
  if (const std::string* text = std::get_if<std::string>(&value)) out.string_value = arena.Copy(*text);
}

SetResult ToResult(const Status& status, dds::WireArena& arena) {
  return {status.ok(), arena.Copy(status.ok() ? "" : status.error().message)};
}

bool Equal(const Value& asked, const ParameterValue& value) {
  if (asked.type != TypeOf(value)) return false;
  if (const bool* truth = std::get_if<bool>(&value)) return asked.bool_value == *truth;
  if (const std::int64_t* integer = std::get_if<std::int64_t>(&value)) return asked.integer_value == *integer;
  if (const double* number = std::get_if<double>(&value)) return asked.double_value == *number;
  return dds::Text(asked.string_value) == std::get<std::string>(value);
}

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

struct ParameterServices::Services {
  Services(const RosNode& node, const std::string& name, Parameters given)
      : parameters(std::move(given)),
        node_name((node.node_namespace == "/" ? "" : node.node_namespace) + "/" + name),
        events(node, "/parameter_events", Stream(kDepth)),
        list(
            node, name + "/list_parameters", [this](const RosCaller& caller, const auto&) { List(caller); },
            Service(kDepth)),
        get(
            node, name + "/get_parameters",
            [this](const RosCaller& caller, const auto& request) { Get(caller, dds::Strings(request.names)); },
            Service(kDepth)),
        types(
            node, name + "/get_parameter_types",
            [this](const RosCaller& caller, const auto& request) { GetTypes(caller, dds::Strings(request.names)); },
            Service(kDepth)),
        describe(
            node, name + "/describe_parameters",
            [this](const RosCaller& caller, const auto& request) { Describe(caller, dds::Strings(request.names)); },
            Service(kDepth)),
        set(
            node, name + "/set_parameters",
            [this](const RosCaller& caller, const auto& request) { Set(caller, request); }, Service(kDepth)),
        set_atomically(
            node, name + "/set_parameters_atomically",
            [this](const RosCaller& caller, const auto& request) { SetAtomically(caller, request); }, Service(kDepth)) {
    std::vector<std::string> names;
    for (const auto& [key, value] : parameters) names.push_back(key);
    WriteEvent(names, true);
  }

  // Announces that the parameters have a value: all of them, or those that a request has set again.
  void WriteEvent(const std::vector<std::string>& names, bool are_new) {
    if (names.empty()) return;
    dds::WireArena arena;
    rcl_interfaces_msg_dds__ParameterEvent_ event{};
    event.node = arena.Copy(node_name);
    auto* out = arena.Fill(are_new ? event.new_parameters : event.changed_parameters, names.size());
    for (const std::string& name : names) {
      out->name = arena.Copy(name);
      Fill(out->value, parameters.at(name), arena);
      ++out;
    }
    events.Write(event);
  }

  const ParameterValue* Find(const std::string& name) const {
    const auto found = parameters.find(name);
    return found == parameters.end() ? nullptr : &found->second;
  }

  void List(const RosCaller& caller) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__ListParameters_Response_ response{};
    char** name = arena.Fill(response.result.names, parameters.size());
    for (const auto& [key, value] : parameters) *name++ = arena.Copy(key);
    list.Respond(caller, response);
  }

  // A parameter that the node does not have reads as not set: the response has no other way to say so.
  void Get(const RosCaller& caller, const std::vector<std::string>& names) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__GetParameters_Response_ response{};
    Value* value = arena.Fill(response.values, names.size());
    for (const std::string& name : names) {
      if (const ParameterValue* known = Find(name)) Fill(*value, *known, arena);
      ++value;
    }
    get.Respond(caller, response);
  }

  void GetTypes(const RosCaller& caller, const std::vector<std::string>& names) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__GetParameterTypes_Response_ response{};
    std::uint8_t* type = arena.Fill(response.types, names.size());
    for (const std::string& name : names) {
      const ParameterValue* known = Find(name);
      *type++ = known != nullptr ? TypeOf(*known) : kNotSet;
    }
    types.Respond(caller, response);
  }

  void Describe(const RosCaller& caller, const std::vector<std::string>& names) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__DescribeParameters_Response_ response{};
    Descriptor* descriptor = arena.Fill(response.descriptors, names.size());
    for (const std::string& name : names) {
      const ParameterValue* known = Find(name);
      descriptor->name = arena.Copy(name);
      descriptor->type = known != nullptr ? TypeOf(*known) : kNotSet;
      descriptor->read_only = true;
      ++descriptor;
    }
    describe.Respond(caller, response);
  }

  // Fails if setting would change anything. To set a parameter to its own value succeeds, because launch files set
  // use_sim_time everywhere.
  template <typename Parameter>
  Status CheckSet(const Parameter& parameter) const {
    const ParameterValue* known = Find(dds::Text(parameter.name));
    if (known == nullptr) return Error{{}, "no such parameter"};
    return Equal(parameter.value, *known) ? Status() : Error{{}, "the parameter is read-only"};
  }

  void Set(const RosCaller& caller, const rcl_interfaces_srv_dds__SetParameters_Request_& request) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__SetParameters_Response_ response{};
    const auto asked = dds::Elements(request.parameters);
    SetResult* result = arena.Fill(response.results, asked.size());
    std::vector<std::string> changed;
    for (const auto& parameter : asked) {
      const Status status = CheckSet(parameter);
      if (status.ok()) changed.push_back(dds::Text(parameter.name));
      *result++ = ToResult(status, arena);
    }
    WriteEvent(changed, false);
    set.Respond(caller, response);
  }

  // One parameter that may not be set refuses all, and then nothing is announced.
  void SetAtomically(const RosCaller& caller, const rcl_interfaces_srv_dds__SetParametersAtomically_Request_& request) {
    dds::WireArena arena;
    rcl_interfaces_srv_dds__SetParametersAtomically_Response_ response{};
    Status status;
    std::vector<std::string> changed;
    for (const auto& parameter : dds::Elements(request.parameters)) {
      if (status.ok()) status = CheckSet(parameter);
      changed.push_back(dds::Text(parameter.name));
    }
    if (status.ok()) WriteEvent(changed, false);
    response.result = ToResult(status, arena);
    set_atomically.Respond(caller, response);
  }

  const Parameters parameters;
  const std::string node_name;
  RosWriter<rcl_interfaces_msg_dds__ParameterEvent_> events;
  RosService<rcl_interfaces_srv_dds__ListParameters_Request_, rcl_interfaces_srv_dds__ListParameters_Response_> list;
  RosService<rcl_interfaces_srv_dds__GetParameters_Request_, rcl_interfaces_srv_dds__GetParameters_Response_> get;
  RosService<rcl_interfaces_srv_dds__GetParameterTypes_Request_, rcl_interfaces_srv_dds__GetParameterTypes_Response_>
      types;
  RosService<rcl_interfaces_srv_dds__DescribeParameters_Request_, rcl_interfaces_srv_dds__DescribeParameters_Response_>
      describe;
  RosService<rcl_interfaces_srv_dds__SetParameters_Request_, rcl_interfaces_srv_dds__SetParameters_Response_> set;
  RosService<rcl_interfaces_srv_dds__SetParametersAtomically_Request_,
             rcl_interfaces_srv_dds__SetParametersAtomically_Response_>
      set_atomically;
};

ParameterServices::ParameterServices(const RosNode& node, const std::string& name, Parameters parameters)
    : services_(std::make_unique<Services>(node, name, std::move(parameters))) {}

ParameterServices::~ParameterServices() = default;

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
