#include "viewer/gateway/page_texts.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxAwaited = 50;  // names in a status
constexpr std::size_t kMaxSpans = 500;   // of a timeline

}  // namespace

std::string SessionText(const ViewerGatewayOptions& options, const SessionFacts& facts) {
  return JsonText(nlohmann::json{{"type", "session"},
                                 {"session", options.session},
                                 {"view_only", options.view_only},
                                 {"connected", facts.connected},
                                 {"recording", facts.recording},
                                 {"editor", options.editor},
                                 {"command", options.command},
                                 {"runs_again", facts.runs_again},
                                 {"saves_recording", facts.saves_recording},
                                 {"expectations", options.expectations.list.size()},
                                 {"problem", facts.problem}});
}

// A page cannot show a thousand names; the count says how many there are.
std::shared_ptr<const std::string> StatusText(std::optional<StatusMessage> status) {
  if (!status) return nullptr;
  const std::size_t count = status->waiting_for.size();
  status->waiting_for.resize(std::min(count, kMaxAwaited));
  auto text = FieldsToJson<nlohmann::ordered_json>(*status);
  text["type"] = "status";
  text["waiting_count"] = count;
  return std::make_shared<const std::string>(JsonText(text));
}

std::shared_ptr<const std::string> TimelineText(const std::vector<TimeSpan>& spans) {
  nlohmann::json rows = nlohmann::json::array();
  // The oldest ones are told as one, if there are many.
  const std::size_t joined = spans.size() > kMaxSpans ? spans.size() - kMaxSpans : 0;
  if (joined > 0) rows.push_back({spans.front().first, spans[joined].last, spans.front().tick});
  for (std::size_t i = joined > 0 ? joined + 1 : 0; i < spans.size(); ++i) {
    rows.push_back({spans[i].first, spans[i].last, spans[i].tick});
  }
  const nlohmann::json text = {{"type", "timeline"}, {"spans", std::move(rows)}};
  return std::make_shared<const std::string>(JsonText(text));
}

}  // namespace troupe
