// Feed any bytes to the readers of the lines between a launcher and its processes.
#include <nlohmann/json.hpp>

#include "fuzz/check.h"
#include "fuzz/targets.h"
#include "launcher/hosts/host_messages.h"
#include "launcher/supervise/service_report.h"

namespace troupe::fuzz {

void HostMessage(Bytes bytes) {
  const troupe::HostMessage message = ParseHostMessage(TextOf(bytes));
  if (!message.is_object()) return;
  Check(ParseHostMessage(ToLine(message)) == message);
  const auto data = message.find("data");
  if (data == message.end() || !data->is_string()) return;
  const std::string content = FromHexadecimal(*data);
  Check(FromHexadecimal(ToHexadecimal(content.data(), content.size())) == content);
}

void ServiceReport(Bytes bytes) {
  static_cast<void>(ParseServiceReport(TextOf(bytes)));
}

}  // namespace troupe::fuzz
