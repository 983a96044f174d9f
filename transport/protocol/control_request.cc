#include "transport/protocol/control_request.h"

#include "common/model/field_check.h"

namespace troupe::control {
namespace {

Error Malformed(const std::string& found, const std::string& expected) {
  return {{}, "found " + found + ", expected " + expected};
}

Status CheckName(const std::string& name) {
  return name.empty() ? Status(Malformed("no name", "that of a robot, an object or a model")) : Status();
}

// The numbers of a request; not those of its poses, twists and goals.
template <typename Request>
Status CheckNumbers(const Request& request) {
  Status status;
  ForEachField<Request>([&]<typename Part>(const Field<Request, Part>& field) {
    if (!status.ok()) return;
    if constexpr (std::is_arithmetic_v<Part> || std::is_same_v<Part, std::optional<double>> ||
                  std::is_same_v<Part, std::optional<std::uint32_t>>) {
      FieldCheck check(nullptr, std::numeric_limits<double>::max());
      if (!check.CheckField(field.Of(request), field)) status = Error{{}, std::string(field.name) + check.problem()};
    }
  });
  return status;
}

Status CheckRules(const Reset& reset) {
  constexpr std::uint8_t kKnown = kResetTime | kResetState | kResetSpawned;
  if (reset.scopes == kResetAll || (reset.scopes != 0 && (reset.scopes & ~kKnown) == 0)) return {};
  return Malformed("the scopes " + std::to_string(reset.scopes), "1 to 7, or 255");
}
Status CheckRules(const Restore& restore) {
  return CheckName(restore.source);
}
// A name may be empty where it stands for all entities, or is derived.
template <typename Request>
Status CheckRules(const Request& request) {
  constexpr bool kMayBeEmpty = std::is_same_v<Request, Entities> || std::is_same_v<Request, Spawn>;
  if constexpr (!kMayBeEmpty && requires { request.name; }) return CheckName(request.name);
  return {};
}

}  // namespace

Status CheckRequest(const Request& request) {
  return std::visit(
      [](const auto& each) {
        const Status status = CheckNumbers(each);
        return status.ok() ? CheckRules(each) : status;
      },
      request);
}

}  // namespace troupe::control
