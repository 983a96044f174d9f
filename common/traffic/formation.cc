#include "common/traffic/formation.h"

#include <algorithm>
#include <utility>

namespace troupe {

Formation::Formation(const TrafficGraph& graph, std::vector<std::uint32_t> places)
    : graph_(&graph), places_(std::move(places)), occupants_(graph.vertices(), kNone), members_(graph.groups()) {
  for (std::uint32_t row = 0; row < places_.size(); ++row) Place(row, places_[row]);
}

void Formation::Place(std::uint32_t row, std::uint32_t vertex) {
  places_[row] = vertex;
  occupants_[vertex] = row;
  for (const std::uint32_t group : graph_->GroupsOfVertex(vertex)) members_[group].push_back(row);
}

void Formation::Remove(std::uint32_t row) {
  occupants_[places_[row]] = kNone;
  for (const std::uint32_t group : graph_->GroupsOfVertex(places_[row])) std::erase(members_[group], row);
}

bool Formation::CanMove(std::uint32_t row, std::uint32_t lane, std::uint32_t to) const {
  bool can = true;
  ForEachBlocker(row, lane, to, [&](std::uint32_t) { can = false; });
  return can;
}

void Formation::Move(std::uint32_t row, std::uint32_t lane, std::uint32_t to) {
  moves_.push_back({row, lane, places_[row], to});
  Remove(row);
  Place(row, to);
}

void Formation::UndoTo(std::size_t count) {
  while (moves_.size() > count) {
    const RowMove& last = moves_.back();
    Remove(last.row);
    Place(last.row, last.from);
    moves_.pop_back();
  }
}

}  // namespace troupe
