#include "common/model/state_hash.h"

#include <optional>
#include <string_view>
#include <vector>

#include "common/base/hash.h"

namespace troupe {
namespace {

void Add(Hasher& hasher, double value) {
  hasher.Add(value);
}

template <typename Number>
requires(std::is_integral_v<Number> || std::is_enum_v<Number>) void Add(Hasher& hasher, Number value) {
  hasher.Add(static_cast<std::uint64_t>(value));
}

template <typename Tag>
void Add(Hasher& hasher, Id<Tag> id) {
  hasher.Add(std::uint64_t{id.index()});
}

template <typename Tag>
void Add(Hasher& hasher, const std::optional<Id<Tag>>& id) {
  hasher.Add(std::uint64_t{id ? id->index() + 1 : 0});
}

void Add(Hasher& hasher, const std::vector<std::uint8_t>& bytes) {
  hasher.Add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

template <HasFields Row>
void Add(Hasher& hasher, const Row& row) {
  ForEachLeaf<Row>([&](const auto& leaf) { Add(hasher, leaf.Of(row)); });
}

// Rows without their number: worlds without any of a kind keep their hashes when states have a new kind.
template <HasFields Row>
void Add(Hasher& hasher, const std::vector<Row>& rows) {
  for (const Row& row : rows) Add(hasher, row);
}

// At tick 0 the poses determine the supports: a state has the same hash before and after they are found.
std::vector<ObjectState> WithoutSupports(std::vector<ObjectState> objects) {
  for (ObjectState& object : objects) {
    if (object.mode != ObjectMode::kResting) continue;
    object.mode = ObjectMode::kPlaced;
    object.support.reset();
  }
  return objects;
}

}  // namespace

std::uint64_t StateHash(const WorldState& state) {
  Hasher hasher;
  ForEachField<WorldState>([&](const auto& field) {
    const auto& part = field.Of(state);
    if constexpr (std::is_same_v<decltype(part), const std::vector<ObjectState>&>) {
      if (state.tick == 0) return Add(hasher, WithoutSupports(part));
    }
    Add(hasher, part);
  });
  return hasher.value();
}

}  // namespace troupe
