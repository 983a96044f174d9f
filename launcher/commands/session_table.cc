#include "launcher/commands/session_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/utf8.h"
#include "transport/protocol/waiting_text.h"

namespace troupe {
namespace {

using Row = std::array<std::string, 8>;

Row RowOf(const SessionInfo& session) {
  Row row = {session.session,
             session.world,
             fmt::format("{}:{}", session.host, session.pid),
             "-",
             "-",
             "-",
             fmt::format("-/{}", session.robots),
             "-"};
  if (!session.status) return row;
  const StatusMessage& status = *session.status;
  row[3] =
      status.target_ticks > 0 ? fmt::format("{}/{}", status.tick, status.target_ticks) : std::to_string(status.tick);
  row[4] = fmt::format("{:.1f}", status.sim_seconds);
  row[5] = fmt::format("{:.2f}", status.real_time_factor);
  row[6] = fmt::format("{}/{}", status.agents, status.robots);
  if (!status.waiting_for.empty()) row[7] = WaitingText(status);
  return row;
}

}  // namespace

std::string SessionTable(const std::vector<SessionInfo>& sessions) {
  std::vector<Row> rows = {
      {"SESSION", "WORLD", "SERVICE", "TICK", "SIM SECONDS", "X REAL TIME", "AGENTS/ROBOTS", "WAITING FOR"}};
  for (const SessionInfo& session : sessions) rows.push_back(RowOf(session));
  std::array<std::size_t, std::tuple_size_v<Row>> widths{};
  for (Row& row : rows) {
    for (std::string& cell : row) cell = PlainLine(cell);  // any host of the network may write them
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) text += fmt::format("{:<{}}  ", row[i], widths[i]);
    text += row.back() + "\n";
  }
  return text;
}

}  // namespace troupe
