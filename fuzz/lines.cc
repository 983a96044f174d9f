// Feed any bytes to the readers of the lines between a launcher and its processes.
#include <span>
#include <string>

#include "common/base/text.h"
#include "fuzz/targets.h"
#include "launcher/hosts/host.h"
#include "launcher/supervise/reports.h"

namespace troupe::fuzz {

void HostMessage(Bytes bytes) {
  const JsonReader message = ReadHostMessage(TextOf(bytes));
  if (!message.ok()) return;
  const std::string data = BytesIn(message, "data");
  if (message.ok()) Check(FromHexadecimal(ToHexadecimal(std::as_bytes(std::span(data)))) == data);
}

void ServiceReport(Bytes bytes) {
  static_cast<void>(ParseServiceReport(TextOf(bytes)));
}

}  // namespace troupe::fuzz
