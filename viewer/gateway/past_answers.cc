#include "viewer/gateway/past_answers.h"

#include <algorithm>

namespace troupe {
namespace {

// At least between two readings of the journal.
constexpr auto kJournalPeriod = std::chrono::seconds(2);

}  // namespace

PastAnswer PastAnswers::Answer(const PastQuestion& question) {
  if (const auto* series = std::get_if<SeriesRequest>(&question)) return reader_.Series(*series);
  if (const auto* totals = std::get_if<TotalsRequest>(&question)) return reader_.Totals(*totals);
  if (const auto* expectations = std::get_if<ExpectationsRequest>(&question)) return rows_.Answer(*expectations);
  if (const auto* position = std::get_if<std::uint64_t>(&question)) return Find(*position);
  if (link_ != nullptr) ReadJournal();
  reads_journal_ = false;
  return std::monostate();
}

FoundState PastAnswers::Find(std::uint64_t position) {
  FoundState found = past_.At(position);
  // A state that is not kept any more may be in the journal by now.
  if (link_ != nullptr && found.ok() && found.value()->position != position) {
    ReadJournal();
    found = past_.At(position);
  }
  return found;
}

// Rarely: the whole journal is read, on and on.
void PastAnswers::ReadJournal() {
  const auto start = std::chrono::steady_clock::now();
  if (start < journal_at_) return;
  feed_.SetRecorded(link_->ReadJournal(feed_.worlds()));
  const auto end = std::chrono::steady_clock::now();
  journal_at_ = end + std::max<std::chrono::steady_clock::duration>(kJournalPeriod, kJournalShare * (end - start));
}

}  // namespace troupe
