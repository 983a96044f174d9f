#include "viewer/gateway/state_rows.h"

#include <utility>

#include "viewer/gateway/page_values.h"

namespace troupe {

void StateRows::Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh) {
  if (state == state_ && !fresh) return;
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    std::vector<std::uint64_t>& changed = changed_[table_number++];
    if (!kIsOnPage<Row>) return;
    const std::vector<Row>& before = table.Of(*state_);
    const std::vector<Row>& now = table.Of(*state);
    changed.resize(now.size(), number);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (fresh || i >= before.size() || !(before[i] == now[i])) changed[i] = number;
    }
  });
  state_ = std::move(state);
}

void StateRows::Write(ByteWriter& writer, std::uint64_t since) const {
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<std::uint64_t>& changed = changed_[table_number++];
    if constexpr (kIsOnPage<Row>) {
      const std::vector<Row>& rows = table.Of(*state_);
      const std::size_t place = writer.ReserveCount();
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (changed[i] <= since) continue;
        writer.WriteCount(i);
        ForEachField<Row>(
            [&]<typename Part>(const Field<Row, Part>& field) { PageValue<Part>::Write(writer, field.Of(rows[i])); });
        ++count;
      }
      writer.FillCount(place, count);
    }
  });
}

}  // namespace troupe
