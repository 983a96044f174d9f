#include "fleet/vehicle_news.h"

#include <algorithm>

namespace troupe::fleet {
namespace {

std::string Named(const TrackedAction& tracked) {
  const bool is_instant = tracked.scope == ActionScope::kInstant;
  const bool is_of_zone = tracked.scope == ActionScope::kZone;
  std::string text = is_instant   ? tracked.action.type
                     : is_of_zone ? tracked.action.type + " of a zone"
                                  : "action " + tracked.action.id;
  text += std::string(" ") + NameOf(tracked.status);
  if (tracked.result && !tracked.result->empty()) text += ": " + *tracked.result;
  return text;
}

bool IsRequest(const TrackedAction& tracked) {
  return tracked.action.type == "stateRequest" || tracked.action.type == "factsheetRequest";
}

void AddEnded(const std::vector<TrackedAction>& before, const std::vector<TrackedAction>& now,
              std::vector<std::string>& news) {
  for (const TrackedAction& tracked : now) {
    if (!IsFinal(tracked.status) || (IsRequest(tracked) && tracked.status == ActionStatus::kFinished)) continue;
    const bool is_known = std::any_of(before.begin(), before.end(), [&](const TrackedAction& other) {
      return other.action.id == tracked.action.id && IsFinal(other.status);
    });
    if (!is_known) news.push_back(Named(tracked));
  }
}

// Of those that have an end of their own: others belong to a rejection or to an action that has failed.
bool Has(const VehicleMemory& memory, const ReportedError& error) {
  return std::any_of(memory.errors.begin(), memory.errors.end(), [&](const ReportedError& other) {
    return other.end == ErrorEnd::kCause && other.error.type == error.error.type &&
           other.error.references == error.error.references;
  });
}

void AddErrors(const VehicleMemory& before, const VehicleMemory& now, std::vector<std::string>& news) {
  for (const ReportedError& error : now.errors) {
    if (error.end != ErrorEnd::kCause || Has(before, error)) continue;
    const std::string reason = error.error.description.value_or("");
    news.push_back("error " + error.error.type + ": " + (reason.empty() ? NameOf(error.error.level) : reason));
  }
  for (const ReportedError& error : before.errors) {
    if (error.end == ErrorEnd::kCause && !Has(now, error)) news.push_back("error " + error.error.type + " cleared");
  }
}

}  // namespace

std::vector<std::string> NewsOf(const VehicleMemory& before, const VehicleMemory& now) {
  std::vector<std::string> news;
  const bool is_new = now.order_id != before.order_id;
  if (is_new) news.push_back("order " + now.order_id + " accepted");
  AddEnded(before.actions, now.actions, news);
  AddEnded(before.instant_actions, now.instant_actions, news);
  AddEnded(before.zone_actions, now.zone_actions, news);
  if ((is_new || IsBusy(before)) && !now.order_id.empty() && !IsBusy(now)) {
    news.push_back("order " + now.order_id + (now.is_cancelled ? " cancelled" : " finished"));
  }
  if (now.mode != before.mode) news.push_back(std::string("mode ") + NameOf(now.mode));
  AddErrors(before, now, news);
  return news;
}

}  // namespace troupe::fleet
