#include "worldfile/scenario/people_entries.h"

#include <algorithm>
#include <utility>

#include "worldfile/text/text_file.h"

namespace troupe {
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

// Goals by name are resolved later: a place may be that of a building.
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
  for (const JsonNode& goal : object.ItemsOf("goals")) {
    if (goal.is_string()) {
      entry.goals.push_back({goal.text, tree.Where(goal)});
    } else {
      const Vec2 point(goal.items[0].number, goal.items[1].number);
      const double z = goal.items.size() > 2 ? goal.items[2].number : rule.z;
      entry.goals.push_back({PeopleEntry::PlacedGoal{point, z}, tree.Where(goal)});
    }
  }
  return entry;
}

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

// Appends the goal sets of an entry; the number of the first.
Result<std::uint32_t> AddGoals(WorldDescription& world, const PeopleEntry& entry, std::size_t number) {
  const auto first = static_cast<std::uint32_t>(world.goal_sets.size());
  std::vector<Vec2> points;
  std::vector<double> heights;
  for (const PeopleEntry::Goal& goal : entry.goals) {
    const Result<PeopleEntry::PlacedGoal> place = PlaceOf(world, goal);
    if (!place.ok()) return place.error();
    points.push_back(place.value().point);
    heights.push_back(place.value().z);
  }
  // Goals in a fixed order are a ring of sets of one point; goals in any order are one set, from which each person
  // draws.
  const std::size_t sets = entry.in_turn && !points.empty() ? points.size() : 1;
  for (std::size_t i = 0; i < sets; ++i) {
    GoalSet set;
    set.name = "people " + std::to_string(number + 1) + (sets > 1 ? ", goal " + std::to_string(i + 1) : "");
    set.points = sets > 1 ? std::vector<Vec2>{points[i]} : points;
    set.heights = sets > 1 ? std::vector<double>{heights[i]} : heights;
    set.wait = entry.wait;
    if (points.size() > 1) set.next = {{first + static_cast<std::uint32_t>((i + 1) % sets), 1.0}};
    world.goal_sets.push_back(std::move(set));
  }
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

// The world's seed draws places and speeds of people, so that a seed gives one crowd.
Result<LoadedWorld> AddPeople(LoadedWorld loaded, const std::vector<PeopleEntry>& entries) {
  std::vector<PeopleRule> rules;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Result<std::uint32_t> goals = AddGoals(loaded.world, entries[i], i);
    if (!goals.ok()) return goals.error();
    rules.push_back(entries[i].rule);
    rules.back().person.goals = goals.value();
  }
  const std::uint64_t seed = loaded.world.seed;
  return AddPeople(std::move(loaded), rules, seed);
}

}  // namespace troupe
