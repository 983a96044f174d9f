#include "common/traffic/move_sequence.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

namespace troupe {
namespace {

// Between labels: as many moves find a place between two of them.
constexpr MoveSequence::Position kGap = MoveSequence::Position{1} << 32;

constexpr auto kHasLess = [](const auto& entry, MoveSequence::Position label) { return entry.label < label; };

template <typename List>
auto FirstFrom(List& list, MoveSequence::Position position) {
  return std::lower_bound(list.begin(), list.end(), position, kHasLess);
}

}  // namespace

MoveSequence::MoveSequence(const TrafficGraph& graph, std::span<const std::uint32_t> places,
                           std::span<const RowMove> granted, std::span<const RowMove> moves)
    : graph_(graph),
      places_(places.begin(), places.end()),
      ready_(places.size(), 0.0),
      busy_(graph.lanes(), 0.0),
      groups_busy_(graph.groups(), 0.0),
      moves_on_(graph.lanes()),
      moves_to_(2 * graph.lanes()),
      moves_in_(graph.groups()),
      moves_of_(places.size()),
      stays_(graph.vertices()) {
  const auto claim = [&](std::uint32_t lane, double until, std::vector<double>& lanes, std::vector<double>& groups) {
    for (const std::uint32_t near : graph_.LanesNearLane(lane)) lanes[near] = std::max(lanes[near], until);
    for (const std::uint32_t group : graph_.GroupsOfLane(lane)) groups[group] = std::max(groups[group], until);
  };
  for (const RowMove& move : granted) {
    ready_[move.row] += graph_.seconds(move.lane);
    claim(move.lane, ready_[move.row], busy_, groups_busy_);
  }
  std::vector<double> lanes = busy_;
  std::vector<double> groups = groups_busy_;
  std::vector<double> ready = ready_;
  all_.reserve(moves.size());
  order_.reserve(moves.size());
  for (const RowMove& move : moves) {
    double start = std::max(ready[move.row], lanes[move.lane]);
    for (const std::uint32_t group : graph_.GroupsOfLane(move.lane)) start = std::max(start, groups[group]);
    const double finish = start + graph_.seconds(move.lane);
    ready[move.row] = finish;
    claim(move.lane, finish, lanes, groups);
    const Entry entry{kGap * (all_.size() + 1), static_cast<std::uint32_t>(all_.size())};
    all_.push_back({move, entry.label, start, finish});
    order_.push_back(entry);
    ForEachListOf(move, [&](List& list) { list.push_back(entry); });
  }
  for (std::uint32_t row = 0; row < places_.size(); ++row) AddStays(row);
}

std::vector<RowMove> MoveSequence::moves() const {
  std::vector<RowMove> moves;
  moves.reserve(order_.size());
  for (const Entry& entry : order_) moves.push_back(all_[entry.number].move);
  return moves;
}

// Calls visit(list) for each list with the moves that conflict with one along a lane; a move may be in several.
template <typename Visit>
void MoveSequence::ForEachListNear(std::uint32_t lane, const Visit& visit) const {
  for (const std::uint32_t near : graph_.LanesNearLane(lane)) visit(moves_on_[near]);
  for (const std::uint32_t group : graph_.GroupsOfLane(lane)) visit(moves_in_[group]);
}

// Calls visit(list) for each list that a move is in, but for the order.
template <typename Visit>
void MoveSequence::ForEachListOf(const RowMove& move, const Visit& visit) {
  visit(moves_on_[move.lane]);
  visit(moves_to_[graph_.DirectionOf(move.lane, move.to)]);
  for (const std::uint32_t group : graph_.GroupsOfLane(move.lane)) visit(moves_in_[group]);
  visit(moves_of_[move.row]);
}

// Calls visit(vertex, stay) for each rest of a robot.
template <typename Visit>
void MoveSequence::ForEachStay(std::uint32_t row, const Visit& visit) const {
  std::uint32_t at = places_[row];
  Position begin = 0;
  for (const Entry& entry : moves_of_[row]) {
    visit(at, Range{begin, entry.label});
    at = all_[entry.number].move.to;
    begin = entry.label + 1;
  }
  visit(at, Range{begin, kEnd});
}

void MoveSequence::AddStays(std::uint32_t row) {
  ForEachStay(row, [this](std::uint32_t vertex, const Range& stay) {
    std::vector<Range>& stays = stays_[vertex];
    const auto place = std::lower_bound(stays.begin(), stays.end(), stay.begin,
                                        [](const Range& a, Position begin) { return a.begin < begin; });
    stays.insert(place, stay);
  });
}

void MoveSequence::RemoveStays(std::uint32_t row) {
  ForEachStay(row, [this](std::uint32_t vertex, const Range& stay) {
    std::erase_if(stays_[vertex], [&](const Range& a) { return a.begin == stay.begin && a.end == stay.end; });
  });
}

std::vector<MoveSequence::Step> MoveSequence::TakeOut(std::uint32_t row) {
  RemoveStays(row);
  std::vector<Step> steps;
  const List own = std::exchange(moves_of_[row], {});
  if (own.empty()) return steps;
  for (const Entry& entry : own) {
    const RowMove& move = all_[entry.number].move;
    steps.push_back({entry.label, move.lane, move.to});
    ForEachListOf(move, [&](List& list) {
      const auto place = FirstFrom(list, entry.label);
      if (place != list.end() && place->label == entry.label) list.erase(place);
    });
  }
  std::vector<Entry> changed;
  for (const Entry& entry : own) {
    ForEachListNear(all_[entry.number].move.lane, [&](const List& list) {
      const auto next = FirstFrom(list, entry.label);
      if (next != list.end()) changed.push_back(*next);
    });
  }
  auto next = own.begin();
  std::erase_if(order_, [&](const Entry& entry) {
    if (next == own.end() || entry.label != next->label) return false;
    ++next;
    return true;
  });
  MoveOn(std::move(changed));
  return steps;
}

void MoveSequence::PutBack(std::uint32_t row, std::span<const Step> steps) {
  std::vector<std::size_t> places;  // in the order, before each of which a step is
  for (const Step& step : steps) {
    places.push_back(static_cast<std::size_t>(FirstFrom(order_, step.position) - order_.begin()));
  }
  const auto before = [&](std::size_t place) { return place == 0 ? Position{0} : order_[place - 1].label; };
  // A place at the end has room for as many as in any other gap.
  const auto after = [&](std::size_t place) {
    return place < order_.size() ? order_[place].label : before(place) + kGap;
  };
  const auto count_at = [&](std::size_t i) {
    return static_cast<std::size_t>(std::upper_bound(places.begin(), places.end(), places[i]) -
                                    std::lower_bound(places.begin(), places.end(), places[i]));
  };
  for (std::size_t i = 0; i < places.size(); i += count_at(i)) {
    // Two labels beside each other leave no position between them that is another one.
    if ((after(places[i]) - before(places[i])) / (count_at(i) + 1) < 2) {
      Spread(row);
      break;
    }
  }
  List merged;
  merged.reserve(order_.size() + steps.size());
  std::uint32_t at = places_[row];
  std::size_t taken = 0;
  std::vector<Entry> changed;
  for (std::size_t i = 0; i < steps.size();) {
    const std::size_t place = places[i];
    const std::size_t count = count_at(i);
    merged.insert(merged.end(), order_.begin() + static_cast<std::ptrdiff_t>(taken),
                  order_.begin() + static_cast<std::ptrdiff_t>(place));
    taken = place;
    const Position gap = (after(place) - before(place)) / (count + 1);
    for (std::size_t k = 1; k <= count; ++k, ++i) {
      const Entry entry{before(place) + k * gap, static_cast<std::uint32_t>(all_.size())};
      all_.push_back({{row, steps[i].lane, at, steps[i].to}, entry.label});
      at = steps[i].to;
      merged.push_back(entry);
      changed.push_back(entry);
      ForEachListOf(all_.back().move, [&](List& list) { list.insert(FirstFrom(list, entry.label), entry); });
    }
  }
  merged.insert(merged.end(), order_.begin() + static_cast<std::ptrdiff_t>(taken), order_.end());
  order_ = std::move(merged);
  AddStays(row);
  MoveOn(std::move(changed));
}

// Labels as far apart as at the start. `out`: the robot that has been taken out.
void MoveSequence::Spread(std::uint32_t out) {
  for (std::vector<List>* lists : {&moves_on_, &moves_to_, &moves_in_, &moves_of_}) {
    for (List& list : *lists) list.clear();
  }
  for (std::vector<Range>& stays : stays_) stays.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    Entry& entry = order_[i];
    entry.label = all_[entry.number].label = kGap * (i + 1);
    ForEachListOf(all_[entry.number].move, [&](List& list) { list.push_back(entry); });
  }
  for (std::uint32_t row = 0; row < places_.size(); ++row) {
    if (row != out) AddStays(row);
  }
}

// Its times, by the moves before it; `before`: the one of its robot. Whether they change.
bool MoveSequence::Update(Move& move, std::optional<std::uint32_t> before) const {
  const std::uint32_t lane = move.move.lane;
  double start = std::max(before ? all_[*before].finish : ready_[move.move.row], busy_[lane]);
  for (const std::uint32_t group : graph_.GroupsOfLane(lane)) start = std::max(start, groups_busy_[group]);
  ForEachListNear(lane, [&](const List& list) {
    const auto next = FirstFrom(list, move.label);
    if (next != list.begin()) start = std::max(start, all_[(next - 1)->number].finish);
  });
  const double finish = start + graph_.seconds(lane);
  const bool is_changed = start != move.start || finish != move.finish;
  move.start = start;
  move.finish = finish;
  return is_changed;
}

// The times of moves, of those after them in their lists, and so on, in their order.
void MoveSequence::MoveOn(std::vector<Entry> changed) {
  const auto is_later = [](const Entry& a, const Entry& b) { return a.label > b.label; };
  std::priority_queue<Entry, std::vector<Entry>, decltype(is_later)> open(is_later, std::move(changed));
  std::optional<Position> last;
  while (!open.empty()) {
    const Entry entry = open.top();
    open.pop();
    if (last == entry.label) continue;
    last = entry.label;
    Move& move = all_[entry.number];
    const List& own = moves_of_[move.move.row];
    const auto place = FirstFrom(own, entry.label);
    if (!Update(move, place == own.begin() ? std::nullopt : std::optional((place - 1)->number))) continue;
    if (place + 1 != own.end()) open.push(*(place + 1));
    ForEachListNear(move.move.lane, [&](const List& list) {
      const auto next = FirstFrom(list, entry.label + 1);
      if (next != list.end()) open.push(*next);
    });
  }
}

MoveSequence::Range MoveSequence::RestAt(std::uint32_t vertex, Position position) const {
  Range range{0, kEnd};
  for (const std::uint32_t direction : graph_.DirectionsNeeding(vertex)) {
    const List& list = moves_to_[direction];
    const auto next = FirstFrom(list, position);
    if (next != list.end()) range.end = std::min(range.end, next->label);
    if (next != list.begin()) range.begin = std::max(range.begin, (next - 1)->label + 1);
  }
  return range;
}

void MoveSequence::FindFree(std::uint32_t lane, std::uint32_t to, const Range& within, std::vector<Range>& free) const {
  free.clear();
  if (within.begin > within.end) return;
  free.push_back(within);
  const auto cut = [&](const Range& stay) {
    const auto first = std::find_if(free.begin(), free.end(), [&](const Range& a) { return a.end >= stay.begin; });
    const auto end = std::find_if(first, free.end(), [&](const Range& a) { return a.begin > stay.end; });
    if (first == end) return;
    const Range before{first->begin, stay.begin - 1};
    const Range after{stay.end + 1, (end - 1)->end};
    const bool has_before = first->begin < stay.begin;
    const bool has_after = stay.end < (end - 1)->end;
    auto place = free.erase(first, end);
    if (has_after) place = free.insert(place, after);
    if (has_before) free.insert(place, before);
  };
  const auto cut_stays = [&](std::uint32_t vertex) {
    const std::vector<Range>& stays = stays_[vertex];
    auto stay = std::lower_bound(stays.begin(), stays.end(), within.begin,
                                 [](const Range& a, Position begin) { return a.end < begin; });
    for (; stay != stays.end() && stay->begin <= within.end && !free.empty(); ++stay) cut(*stay);
  };
  const TrafficGraph::Need& need = graph_.NeedOf(lane, to);
  for (const std::uint32_t vertex : need.vertices) cut_stays(vertex);
  for (const std::uint32_t group : need.groups) {
    for (const std::uint32_t vertex : graph_.VerticesOfGroup(group)) cut_stays(vertex);
  }
}

bool MoveSequence::IsFreeAtEnd(std::uint32_t vertex) const {
  const auto is_taken = [this](std::uint32_t other) { return IsTakenAtEnd(other); };
  const auto near = graph_.VerticesNearVertex(vertex);
  const auto groups = graph_.GroupsOfVertex(vertex);
  return std::none_of(near.begin(), near.end(), is_taken) &&
         std::none_of(groups.begin(), groups.end(), [&](std::uint32_t group) {
           const auto vertices = graph_.VerticesOfGroup(group);
           return std::any_of(vertices.begin(), vertices.end(), is_taken);
         });
}

double MoveSequence::LastFinishNear(std::uint32_t vertex) const {
  double last = 0.0;
  for (const std::uint32_t direction : graph_.DirectionsNeeding(vertex)) {
    const List& list = moves_to_[direction];
    if (!list.empty()) last = std::max(last, all_[list.back().number].finish);
  }
  return last;
}

MoveSequence::Times MoveSequence::TimesNear(std::uint32_t lane, Position position) const {
  Times times;
  ForEachListNear(lane, [&](const List& list) {
    const auto next = FirstFrom(list, position);
    if (next != list.begin()) times.latest_finish = std::max(times.latest_finish, all_[(next - 1)->number].finish);
    if (next != list.end()) times.earliest_start = std::min(times.earliest_start, all_[next->number].start);
  });
  return times;
}

MoveSequence::Position MoveSequence::NextNear(std::uint32_t lane, Position position) const {
  Position first = kEnd;
  ForEachListNear(lane, [&](const List& list) {
    const auto next = FirstFrom(list, position);
    if (next != list.end()) first = std::min(first, next->label);
  });
  return first;
}

}  // namespace troupe
