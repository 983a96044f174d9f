#include "worldfile/scenario/people_entries.h"

#include <algorithm>
#include <utility>

#include "common/geometry/limits.h"
#include "worldfile/scenario/track_file.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

Result<PeopleEntry::PlacedGoal> PlaceOf(const WorldDescription& world, const PeopleEntry::Goal& goal) {
  if (const auto* const placed = std::get_if<PeopleEntry::PlacedGoal>(&goal.place)) return *placed;
  const std::string& name = std::get<std::string>(goal.place);
  std::vector<std::string> names;
  for (const NamedPlace& place : world.places) {
    if (place.name == name) return PeopleEntry::PlacedGoal{place.X_WN.translation(), place.X_WN.z};
    names.push_back(place.name);
  }
  return Error{goal.where, "found no place " + Quoted(name) +
                               ", expected the name of one, or a point [x, y] or [x, y, z]" + DidYouMean(name, names)};
}

}  // namespace

// Goals by name are resolved later: a place may be that of a building.
std::vector<PeopleEntry::Goal> ReadGoals(const JsonTree& tree, const JsonNode& object, const char* key, double floor) {
  std::vector<PeopleEntry::Goal> goals;
  for (const JsonNode& goal : object.ItemsOf(key)) {
    if (goal.is_string()) {
      goals.push_back({goal.text, tree.Where(goal)});
      continue;
    }
    const Vec2 point(goal.items[0].number, goal.items[1].number);
    const double z = goal.items.size() > 2 ? goal.items[2].number : floor;
    goals.push_back({PeopleEntry::PlacedGoal{point, z}, tree.Where(goal)});
  }
  return goals;
}

Result<GoalSet> PlacesOf(const WorldDescription& world, const std::vector<PeopleEntry::Goal>& goals) {
  GoalSet set;
  for (const PeopleEntry::Goal& goal : goals) {
    const Result<PeopleEntry::PlacedGoal> place = PlaceOf(world, goal);
    if (!place.ok()) return place.error();
    set.points.push_back(place.value().point);
    set.heights.push_back(place.value().z);
  }
  return set;
}

namespace {

Result<Polygon> ReadRectangle(const JsonTree& tree, const JsonNode& numbers) {
  if (numbers.items.size() != 4) {
    return tree.ErrorAt(
        numbers, "found " + std::to_string(numbers.items.size()) + " numbers, expected [xmin, ymin, xmax, ymax]");
  }
  const double x0 = numbers.items[0].number, y0 = numbers.items[1].number;
  const double x1 = numbers.items[2].number, y1 = numbers.items[3].number;
  if (!(x0 < x1)) return tree.ErrorAt(numbers.items[2], "found an xmax that is not above xmin, expected one that is");
  if (!(y0 < y1)) return tree.ErrorAt(numbers.items[3], "found a ymax that is not above ymin, expected one that is");
  return Polygon{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

// A number, or the least and the greatest.
Result<Interval> ReadInterval(const JsonTree& tree, const JsonNode& value) {
  if (value.is_number()) return Interval{value.number, value.number};
  const Interval interval{value.items[0].number, value.items[1].number};
  if (interval.min <= interval.max) return interval;
  return tree.ErrorAt(value.items[1], "found a greatest value below the least, expected one that is not");
}

Result<PeopleEntry::Visits> ReadVisits(const JsonTree& tree, const JsonNode& object, double floor) {
  PeopleEntry::Visits visits;
  const JsonNode& rate = object.Member("per_hour");
  if (rate.is_number()) {
    visits.flow.times = {0.0};
    visits.flow.per_hour = {rate.number};
  }
  for (const JsonNode& pair : rate.items) {
    const double time = pair.items[0].number;
    const double per_hour = pair.items[1].number;
    if (visits.flow.times.empty() ? time != 0.0 : time <= visits.flow.times.back()) {
      return tree.ErrorAt(pair.items[0],
                          visits.flow.times.empty()
                              ? "found a time table that begins later, expected the first time to be 0"
                              : "found a time that is not after the one before it, expected a later one");
    }
    if (per_hour > kMaxVisitorsPerHour) {
      return tree.ErrorAt(pair.items[1], "found more than 36000 an hour, expected at most these");
    }
    visits.flow.times.push_back(time);
    visits.flow.per_hour.push_back(per_hour);
  }
  visits.exits = ReadGoals(tree, object, "exits", floor);
  if (visits.exits.empty()) {
    return tree.ErrorAt(object.Member("exits"), "found no exit, expected places or points at which people leave");
  }
  if (const JsonNode* const stops = object.Find("stops")) visits.stops = stops->ToInteger<std::uint32_t>();
  if (const JsonNode* const found = object.Find("arrive")) visits.flow.is_random = found->text == "random";
  return visits;
}

Result<PeopleEntry> ReadEntry(const JsonTree& tree, const JsonNode& object) {
  PeopleEntry entry;
  PeopleRule& rule = entry.rule;
  rule.where = tree.Where(object);
  rule.count = object.Member("count").ToInteger<std::uint32_t>();
  Result<Polygon> region = ReadRegion(tree, object.Member("region"));
  if (!region.ok()) return region.error();
  rule.region = std::move(region).value();
  object.Read("z", rule.z);
  object.Read("radius", rule.person.radius);
  object.Read("height", rule.height);
  object.Read("max_speed", rule.person.max_speed);
  object.Read("group", rule.group);
  object.Read("name_prefix", rule.name_prefix);
  for (const auto& [key, interval] : {std::pair{"speed", &rule.speed}, std::pair{"wait", &entry.wait}}) {
    const JsonNode* const found = object.Find(key);
    if (found == nullptr) continue;
    const Result<Interval> read = ReadInterval(tree, *found);
    if (!read.ok()) return read.error();
    *interval = read.value();
  }
  object.Read("reaction", rule.person.reaction);
  if (const JsonNode* const found = object.Find("order")) entry.in_turn = found->text == "in turn";
  entry.goals = ReadGoals(tree, object, "goals", rule.z);
  if (const JsonNode* const visits = object.Find("visits")) {
    Result<PeopleEntry::Visits> read = ReadVisits(tree, *visits, rule.z);
    if (!read.ok()) return read.error();
    entry.visits = std::move(read).value();
  }
  return entry;
}

// The set of one point of another one.
GoalSet PointOf(const GoalSet& set, std::size_t point) {
  GoalSet one = set;
  one.points = {set.points[point]};
  one.heights = {set.heights[point]};
  return one;
}

// Appends the goal sets of an entry; the number of the first.
Result<std::uint32_t> AddGoals(WorldDescription& world, const PeopleEntry& entry, std::size_t number) {
  const auto first = static_cast<std::uint32_t>(world.goal_sets.size());
  Result<GoalSet> places = PlacesOf(world, entry.goals);
  if (!places.ok()) return places.error();
  GoalSet all = std::move(places).value();
  all.name = "people " + std::to_string(number + 1);
  all.wait = entry.wait;
  const std::size_t points = all.points.size();
  // Goals in a fixed order are a ring of sets of one point; goals in any order are one set, from which each person
  // draws.
  const std::size_t sets = entry.in_turn && points > 0 ? points : 1;
  for (std::size_t i = 0; i < sets; ++i) {
    GoalSet set = sets > 1 ? PointOf(all, i) : all;
    if (sets > 1) set.name += ", goal " + std::to_string(i + 1);
    if (points > 1) set.next = {{first + static_cast<std::uint32_t>((i + 1) % sets), 1.0}};
    world.goal_sets.push_back(std::move(set));
  }
  return first;
}

// Appends the goal sets of visits, a chain of stops with an exit as its end, and their flow; the number of the first.
Result<std::uint32_t> AddVisits(WorldDescription& world, const PeopleEntry& entry, std::size_t number) {
  const auto first = static_cast<std::uint32_t>(world.goal_sets.size());
  const PeopleEntry::Visits& visits = *entry.visits;
  Result<GoalSet> goals = PlacesOf(world, entry.goals);
  if (!goals.ok()) return goals.error();
  Result<GoalSet> exits = PlacesOf(world, visits.exits);
  if (!exits.ok()) return exits.error();
  const std::string name = "people " + std::to_string(number + 1);
  const std::size_t points = goals.value().points.size();
  const std::size_t stops = points == 0 ? 0 : visits.stops.value_or(entry.in_turn ? points : 1);
  for (std::size_t i = 0; i < stops; ++i) {
    GoalSet set = entry.in_turn ? PointOf(goals.value(), i % points) : goals.value();
    set.name = name + ", goal " + std::to_string(i + 1);
    set.wait = entry.wait;
    set.next = {{first + static_cast<std::uint32_t>(i + 1), 1.0}};
    world.goal_sets.push_back(std::move(set));
  }
  exits.value().name = name + ", exit";
  world.exits.push_back(static_cast<std::uint32_t>(world.goal_sets.size()));
  world.goal_sets.push_back(std::move(exits).value());
  VisitorFlow flow = visits.flow;
  const auto is_taken = [&](const VisitorFlow& other) { return other.name == entry.rule.name_prefix; };
  const bool taken = std::any_of(world.visitor_flows.begin(), world.visitor_flows.end(), is_taken);
  flow.name = taken ? name : entry.rule.name_prefix;
  world.visitor_flows.push_back(std::move(flow));
  return first;
}

}  // namespace

// [xmin, ymin, xmax, ymax], or a list of corners; m, in W.
Result<Polygon> ReadRegion(const JsonTree& tree, const JsonNode& region) {
  const bool rectangle = region.items[0].is_number();
  for (const JsonNode& item : region.items) {
    if (item.is_number() == rectangle) continue;
    return tree.ErrorAt(item, "found " + Describe(item) + ", expected " + (rectangle ? "a number" : "a corner [x, y]") +
                                  " as before it");
  }
  if (rectangle) return ReadRectangle(tree, region);
  Polygon corners;
  for (const JsonNode& corner : region.items) corners.emplace_back(corner.items[0].number, corner.items[1].number);
  Result<Polygon> outline = Normalized(std::move(corners));
  if (outline.ok()) return outline;
  return tree.ErrorAt(region, "found a region that is no simple polygon: " + outline.error().message);
}

Result<std::vector<PeopleEntry>> ReadPeopleEntries(const JsonTree& tree, const JsonNode& root) {
  std::vector<PeopleEntry> entries;
  for (const JsonNode& object : root.ItemsOf("people")) {
    Result<PeopleEntry> entry = ReadEntry(tree, object);
    if (!entry.ok()) return entry.error();
    entries.push_back(std::move(entry).value());
  }
  return entries;
}

std::vector<RecordedEntry> ReadRecordedEntries(const JsonTree& tree, const JsonNode& root) {
  std::vector<RecordedEntry> entries;
  for (const JsonNode& object : root.ItemsOf("recorded_people")) {
    RecordedEntry& entry = entries.emplace_back();
    entry.file = object.Member("file").text;
    entry.file_where = tree.Where(object.Member("file"));
    object.Read("rate", entry.rate);
    object.Read("start", entry.start);
    if (const JsonNode* const pose = object.Find("pose")) {
      entry.pose = {pose->items[0].number, pose->items[1].number, 0.0, WrapAngle(pose->items[2].number * kPi / 180.0)};
    }
    entry.people.where = tree.Where(object);
    object.Read("z", entry.people.z);
    object.Read("react", entry.people.react);
    object.Read("reaction", entry.people.reaction);
    object.Read("radius", entry.people.radius);
    object.Read("height", entry.people.height);
    object.Read("name_prefix", entry.people.name_prefix);
  }
  return entries;
}

// The world's seed draws places and speeds of people, so that a seed gives one crowd.
Result<LoadedWorld> AddPeople(LoadedWorld loaded, const std::vector<PeopleEntry>& entries) {
  std::vector<PeopleRule> rules;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool visit = entries[i].visits.has_value();
    const Result<std::uint32_t> goals =
        visit ? AddVisits(loaded.world, entries[i], i) : AddGoals(loaded.world, entries[i], i);
    if (!goals.ok()) return goals.error();
    rules.push_back(entries[i].rule);
    if (visit) rules.back().flow = static_cast<std::uint32_t>(loaded.world.visitor_flows.size() - 1);
    rules.back().person.goals = goals.value();
  }
  const std::uint64_t seed = loaded.world.seed;
  return AddPeople(std::move(loaded), rules, seed);
}

Result<LoadedWorld> AddRecordedPeople(LoadedWorld loaded, const std::vector<RecordedEntry>& entries,
                                      const std::string& path, const AllowedPaths& allowed) {
  std::vector<RecordedPeople> recordings;
  for (const RecordedEntry& entry : entries) {
    const std::string file = FindFile(entry.file, DirectoryOf(path), path);
    const Result<std::string> text = ReadTextFile(file, entry.file_where, allowed);
    if (!text.ok()) return text.error();
    Result<std::vector<RecordedPerson>> people = ReadTracks(text.value(), file, entry.rate);
    if (!people.ok()) return people.error();
    RecordedPeople& recording = recordings.emplace_back(entry.people);
    recording.people = std::move(people).value();
    const Transform2 to_world(entry.pose);
    for (RecordedPerson& person : recording.people) {
      for (double& time : person.times) time += entry.start;
      for (Vec2& position : person.positions) position = to_world * position;
      const bool is_far = std::any_of(person.positions.begin(), person.positions.end(),
                                      [](const Vec2& at) { return at.cwiseAbs().maxCoeff() > kMaxMagnitude; });
      if (is_far || person.times.back() > kMaxMagnitude) {
        return Error{entry.file_where, "found a recorded position " +
                                           std::string(is_far ? "beyond 1000 km" : "later than a million seconds") +
                                           ", expected a 'pose', 'rate' and 'start' that bring all of them nearer"};
      }
    }
  }
  const std::uint64_t seed = loaded.world.seed;
  return AddRecordedPeople(std::move(loaded), recordings, seed);
}

}  // namespace troupe
