#include "launcher/process/local_broker.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <thread>

#include "common/base/file.h"

namespace troupe {
namespace {

constexpr int kPort = 1883;
constexpr auto kStart = std::chrono::seconds(5);
constexpr auto kLook = std::chrono::milliseconds(20);

sockaddr_in LoopbackAddress(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

// A port of the loopback interface on which nothing listens: `wanted`, or for 0 any. Nothing: it is taken.
std::optional<int> FreePort(int wanted) {
  const FileDescriptor descriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int reuse = 1;
  setsockopt(descriptor.get(), SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  sockaddr_in address = LoopbackAddress(wanted);
  socklen_t length = sizeof address;
  if (bind(descriptor.get(), reinterpret_cast<sockaddr*>(&address), length) != 0 ||
      getsockname(descriptor.get(), reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    return std::nullopt;
  }
  return ntohs(address.sin_port);
}

// The broker inherits it: each of its clients is a descriptor.
void AllowManyClients() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

bool Listens(int port) {
  const FileDescriptor descriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in address = LoopbackAddress(port);
  return connect(descriptor.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

// Debian has it in a folder of administrators, which the path of users lacks.
std::optional<std::string> FindMosquitto() {
  const char* const path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "";
  folders += ":/usr/sbin:/usr/local/sbin";
  std::string_view rest = folders;
  while (!rest.empty()) {
    const std::string folder(rest.substr(0, rest.find(':')));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    const std::string file = folder + "/mosquitto";
    std::error_code ignored;
    if (!folder.empty() && std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0) {
      return file;
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::unique_ptr<LocalBroker>> LocalBroker::Start(const std::string& folder) {
  const std::optional<std::string> program = FindMosquitto();
  if (!program) {
    return Failure(
        "--vda5050 local: there is no program mosquitto, expected Debian's package mosquitto, or the URL of a "
        "broker");
  }
  std::optional<int> port = FreePort(kPort);
  if (!port) port = FreePort(0);
  if (!port) return Failure("--vda5050 local: no port of the loopback interface is free");
  const std::string settings = folder + "/mosquitto.conf";
  const std::string text = fmt::format(
      "listener {} 127.0.0.1\nallow_anonymous true\npersistence false\nlog_dest none\nset_tcp_nodelay true\n", *port);
  if (Status status = WriteWholeFile(settings, text); !status.ok()) return status.error();
  AllowManyClients();
  const FileDescriptor nowhere(open("/dev/null", O_WRONLY | O_CLOEXEC));
  Result<Process> process = Process::Start({*program, "-c", settings}, nowhere.get());
  if (!process.ok()) return process.error();
  const auto end = std::chrono::steady_clock::now() + kStart;
  while (!Listens(*port)) {
    process.value().Poll();
    if (!process.value().running()) {
      return Failure(fmt::format("--vda5050 local: {} {}", *program, process.value().end()->ToString()));
    }
    if (std::chrono::steady_clock::now() > end) {
      return Failure(fmt::format("--vda5050 local: {} does not listen on port {}", *program, *port));
    }
    std::this_thread::sleep_for(kLook);
  }
  return std::unique_ptr<LocalBroker>(new LocalBroker(std::move(process).value(), *port));
}

std::string LocalBroker::Url() const {
  return fmt::format("mqtt://127.0.0.1:{}", port_);
}

}  // namespace troupe
