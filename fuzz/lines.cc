// Feed any bytes to the readers of the lines between a launcher and its processes.
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/base/text.h"
#include "fuzz/targets.h"
#include "launcher/hosts/host.h"
#include "launcher/supervise/reports.h"

namespace troupe::fuzz {

void HostMessage(Bytes bytes) {
  const troupe::HostMessage message = ParseHostMessage(TextOf(bytes));
  if (!message.is_object()) return;
  Check(ParseHostMessage(ToLine(message)) == message);
  const auto data = message.find("data");
  if (data == message.end() || !data->is_string()) return;
  const std::optional<std::string> content = FromHexadecimal(data->get_ref<const std::string&>());
  if (content) Check(ToHexadecimal(std::as_bytes(std::span(*content))) == *data);
}

void ServiceReport(Bytes bytes) {
  static_cast<void>(ParseServiceReport(TextOf(bytes)));
}

}  // namespace troupe::fuzz
