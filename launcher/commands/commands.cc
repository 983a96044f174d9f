#include "launcher/commands/commands.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "command_line/parse_command_line.h"
#include "command_line/terminal.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/security/session_keys.h"
#include "troupe/deterministic_math.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {
namespace {

// The finite numbers of "1,-2.5,3"; nothing if it is anything else.
// std::from_chars knows no locale: a comma is always a separator, and a point the decimal point.
std::optional<std::vector<double>> ParseNumberList(const std::string& text) {
  std::vector<double> numbers;
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  for (;;) {
    double number = 0.0;
    const auto [next, fault] = std::from_chars(position, end, number);
    if (fault != std::errc() || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    if (next == end) return numbers;
    if (*next != ',') return std::nullopt;
    position = next + 1;
  }
}

std::string CheckListen(const std::string& text) {
  return ParseListen(text)
             ? ""
             : "found '" + text + "', expected ADDRESS:PORT with an IPv4 address, for instance 127.0.0.1:8470";
}

}  // namespace

int Fail(const Error& error) {
  fmt::print(stderr, "{}\n", StyledLine(error.ToString(), HasStyles(stderr)));
  return ExitStatusOf(error);
}

// Sessions arrive by the discovery of DDS, one after another: the loop ends when the choice is made, and not with the
// first session.
Status SelectSession(NetworkSettings& network) {
  if (!network.session.empty()) return {};
  using std::chrono::steady_clock;
  const auto begin = steady_clock::now();
  SessionMonitor monitor(network);
  SessionChoice choice;
  for (;;) {
    const std::chrono::duration<double> passed = steady_clock::now() - begin;
    std::set<std::string> found;
    for (const SessionInfo& info : monitor.Sessions()) found.insert(info.session);
    // The user's own runs on this host are known before they are discovered.
    std::set<std::string> published;
    for (const SessionKeys& known : FindSessionKeys(network.domain)) published.insert(known.session);
    choice.Update(found, std::includes(found.begin(), found.end(), published.begin(), published.end()), passed.count());
    if (choice.is_made() || passed.count() > kDiscoverySeconds) break;
    monitor.WaitForChange(0.02);
  }
  if (choice.sessions().empty()) return Failure("found no session");
  if (choice.sessions().size() > 1) {
    return Failure(
        fmt::format("found several sessions ({}), expected the name of one", fmt::join(choice.sessions(), ", ")));
  }
  network.session = *choice.sessions().begin();
  return {};
}

void SessionChoice::Update(const std::set<std::string>& found, bool all_known, double now) {
  if (found != sessions_) changed_at_ = now;
  sessions_ = found;
  if (sessions_.empty()) return;
  // Another run answers about as soon as the first one did; on a busy machine it may take several times as long.
  const double quiet = all_known ? std::clamp(4.0 * changed_at_, kMinQuiet, kMaxQuiet) : kMaxQuiet;
  is_made_ = sessions_.size() > 1 || now - changed_at_ >= quiet;
}

// The heading is last in both forms, so that its place does not depend on the height.
Result<PoseText> ParsePoseText(const std::string& text) {
  const Error failure{{}, "found '" + text + "', expected X,Y,HEADING or X,Y,Z,HEADING, in metres and degrees"};
  const std::optional<std::vector<double>> list = ParseNumberList(text);
  if (!list) return failure;
  const std::vector<double>& numbers = *list;
  if (numbers.size() != 3 && numbers.size() != 4) return failure;
  const bool has_height = numbers.size() == 4;
  return PoseText{{numbers[0], numbers[1], has_height ? numbers[2] : 0.0, DegreesToRadians(numbers.back())},
                  has_height};
}

Result<Goal> ParseGoalText(const std::vector<std::string>& points) {
  Goal goal;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<std::vector<double>> numbers = ParseNumberList(points[i]);
    const bool is_last = i + 1 == points.size();
    const bool has_heading = numbers && numbers->size() == 3;
    if (!numbers || (numbers->size() != 2 && !(has_heading && is_last))) {
      return Error{{},
                   fmt::format("found '{}', expected {} in metres{}", points[i],
                               is_last ? "X,Y or X,Y,HEADING" : "X,Y of a point before the last one",
                               is_last ? " and degrees" : ""),
                   ErrorCode::kBadInput};
    }
    goal.waypoints.emplace_back((*numbers)[0], (*numbers)[1]);
    if (has_heading) goal.heading = WrapAngle(DegreesToRadians((*numbers)[2]));
  }
  return goal;
}

std::optional<ListenAddress> ParseListen(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  ListenAddress listen{text.substr(0, colon)};
  in_addr address{};
  const char* const end = text.data() + text.size();
  const auto port = std::from_chars(text.data() + colon + 1, end, listen.port);
  const bool good =
      inet_pton(AF_INET, listen.address.c_str(), &address) == 1 && port.ec == std::errc() && port.ptr == end;
  return good ? std::optional(listen) : std::nullopt;
}

void AddListenOption(CLI::App& command, std::string& listen) {
  command
      .add_option("--listen", listen,
                  fmt::format("Where the web server listens (default: 127.0.0.1:{}, or another port if that one is in "
                              "use)",
                              kViewerPort))
      ->check(CLI::Validator(CheckListen, ""))
      ->type_name("ADDRESS:PORT");
}

}  // namespace troupe
