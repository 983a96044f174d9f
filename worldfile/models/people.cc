#include "worldfile/models/people.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <memory_resource>
#include <optional>
#include <set>
#include <utility>

#include "common/model/states.h"
#include "common/spatial/body_index.h"
#include "common/spatial/lift_shafts.h"
#include "common/spatial/scene.h"
#include "common/spatial/walk_grid.h"
#include "common/spatial/walk_routes.h"
#include "troupe/random.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Separates the starts of people from other uses of the same seed.
constexpr std::uint64_t kStartStream = 0x7374'6172'7473;
constexpr std::uint64_t kMaxDraws = 5000;
constexpr double kGap = 0.02;  // m between people, and to walls, at the start
// Of recorded people.
constexpr double kLeastSpeed = 0.1;    // m/s
constexpr double kCatchUp = 1.5;       // times the highest recorded speed
constexpr double kLeastCatchUp = 2.0;  // m/s
constexpr double kTogether = 1.25;     // m: people of a group start at most so far beside each other

constexpr std::array kShirts{Color{0.75, 0.22, 0.17, 1.0}, Color{0.16, 0.50, 0.73, 1.0}, Color{0.15, 0.60, 0.38, 1.0},
                             Color{0.56, 0.27, 0.68, 1.0}, Color{0.90, 0.49, 0.13, 1.0}, Color{0.20, 0.29, 0.37, 1.0},
                             Color{0.09, 0.63, 0.52, 1.0}, Color{0.83, 0.68, 0.21, 1.0}};
constexpr std::array kSkins{Color{0.95, 0.80, 0.69, 1.0}, Color{0.76, 0.57, 0.42, 1.0}, Color{0.45, 0.31, 0.22, 1.0}};

// A prism of `sides` sides whose corners are at `radius`.
Block Prism(int sides, double radius, const ZRange& z) {
  return {RegularPolygon(sides, radius), z};
}

class Crowd {
 public:
  Crowd(LoadedWorld loaded, std::uint64_t seed)
      : loaded_(std::move(loaded)), world_(loaded_.world), seed_(seed), scene_(world_), bodies_(scene_) {
    // Robots, objects and doors at their places at load; people are checked against `starts_`.
    bodies_.Assign(PlacedState(world_));
    shafts_ = EmptyShafts(world_);
    for (const ModelDescription& model : world_.models) names_.insert(model.name);
  }

  Status Add(const PeopleRule& rule, std::uint64_t number) {
    const Look look = LookOf(rule);
    FindWays(rule);
    for (std::uint32_t i = 0; i < rule.count; ++i) {
      const bool leads = i % rule.group == 0;
      const std::optional<PersonId> leader = leads ? std::nullopt : leader_;
      const std::optional<Pose> start = FindStart(rule, number, i, leader);
      if (!start) {
        return Error{rule.where, "found room for " + std::to_string(i) + " of " + std::to_string(rule.count) +
                                     " people, expected room for all: enlarge the region or reduce count or radius"};
      }
      AddPerson(rule, look, number, i, *start, leader);
      if (leads) leader_ = PersonId(world_.people.size() - 1);
    }
    return Status();
  }

  void Add(const RecordedPeople& recording, std::uint64_t number) {
    PeopleRule rule;
    rule.z = recording.z;
    rule.height = recording.height;
    rule.person.radius = recording.radius;
    rule.person.reaction = recording.reaction;
    rule.name_prefix = recording.name_prefix;
    const Look look = LookOf(rule);
    if (!recording.react) rule.person.goals = AddGoals(recording.name_prefix);
    for (std::size_t i = 0; i < recording.people.size(); ++i) {
      const RecordedPerson& recorded = recording.people[i];
      const Vec2& from = recorded.positions.front();
      const Vec2& to = recorded.positions.back();
      SetSpeeds(recorded, rule);
      if (recording.react) {
        rule.person.goals = AddGoals(recording.name_prefix);
        world_.goal_sets.back().points = {to};
        world_.goal_sets.back().heights = {recording.z};
        world_.exits.push_back(rule.person.goals);
      }
      const Vec2 ahead = to - from;
      const double heading = ahead == Vec2(0.0, 0.0) ? 0.0 : Atan2(ahead.y(), ahead.x());
      AddPerson(rule, look, number, i, {from.x(), from.y(), recording.z, heading}, std::nullopt);
      VisitorDescription visitor{.person = PersonId(world_.people.size() - 1), .enters_at = recorded.times.front()};
      if (!recording.react) {
        visitor.track = recorded.positions;
        visitor.track_times = recorded.times;
      }
      world_.visitors.push_back(std::move(visitor));
    }
  }

  // An error if the ways of the people would not fit into the memory of most machines.
  Status CheckWays(const SourceLocation& where) const {
    constexpr std::uint64_t kMax = 8;  // GiB
    const double size = std::ceil(WalkRoutes::MostBytes(scene_, world_) / (1 << 30));
    if (size <= static_cast<double>(kMax)) return Status();
    return Error{where, "found people whose ways may take " + std::to_string(static_cast<std::uint64_t>(size)) +
                            " GiB of memory, expected at most " + std::to_string(kMax) +
                            ": each person takes a grid of the whole ground for its present goal"};
  }

  LoadedWorld Release() { return std::move(loaded_); }

 private:
  double Random(std::uint64_t rule, std::uint64_t person, std::uint64_t draw, std::uint64_t component) const {
    return RandomUniform({seed_, kStartStream, rule, person, draw, component});
  }

  // A set without points, where people stay.
  std::uint32_t AddGoals(const std::string& name) {
    world_.goal_sets.emplace_back().name = name;
    return static_cast<std::uint32_t>(world_.goal_sets.size() - 1);
  }

  // The mean speed of a recorded way, and a highest one with which it can catch up on it.
  static void SetSpeeds(const RecordedPerson& recorded, PeopleRule& rule) {
    double length = 0.0;
    double most = 0.0;
    for (std::size_t i = 1; i < recorded.times.size(); ++i) {
      const double step = (recorded.positions[i] - recorded.positions[i - 1]).norm();
      length += step;
      most = std::max(most, step / (recorded.times[i] - recorded.times[i - 1]));
    }
    const double speed = length / (recorded.times.back() - recorded.times.front());
    rule.speed.min = rule.speed.max = std::clamp(speed, kLeastSpeed, kMaxPersonSpeed);
    rule.person.max_speed = std::clamp(kCatchUp * most, kLeastCatchUp, kMaxPersonSpeed);
  }

  // The ways within the region to the point of the rule; none if the rule has no point, or no person can stand there.
  void FindWays(const PeopleRule& rule) {
    ways_.reset();
    grid_.reset();
    if (!rule.point) return;
    if (!portals_) portals_.emplace(scene_);
    grid_ = std::make_unique<const WalkGrid>(scene_.static_index(), *portals_, ZRange{rule.z, rule.z + rule.height},
                                             rule.person.radius, BoundingBox(rule.region));
    ways_ = std::make_unique<const WalkField>(*grid_, *rule.point);
    if (!ways_->target()) ways_.reset();
  }

  std::optional<Pose> FindStart(const PeopleRule& rule, std::uint64_t number, std::uint64_t person,
                                const std::optional<PersonId>& leader) {
    Rectangle box = BoundingBox(rule.region);
    // A group starts together: around its leader, still within the region.
    if (leader) {
      box = Rectangle::Around(world_.model(world_.person(*leader).root).X_PM.translation(), kTogether);
    }
    for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
      const Vec2 at(box.min_x + Random(number, person, draw, 0) * box.width(),
                    box.min_y + Random(number, person, draw, 1) * box.height());
      if (!Contains(rule.region, at) || (ways_ && !ways_->Reaches(at)) || !IsFree(at, rule)) continue;
      return Pose{at.x(), at.y(), rule.z, WrapAngle((2.0 * Random(number, person, draw, 2) - 1.0) * kPi)};
    }
    return std::nullopt;
  }

  bool IsFree(const Vec2& at, const PeopleRule& rule) {
    const ZRange z{rule.z, rule.z + rule.height};
    const double reach = rule.person.radius + kGap;
    const Rectangle box = Rectangle::Around(at, reach);
    const auto is_near = [&](const ConvexPiece& piece) {
      return piece.obstacle && piece.z.Overlaps(z) &&
             FindNearestPoints(std::span(&at, 1), piece.vertices).distance < reach;
    };
    if (std::any_of(shafts_.begin(), shafts_.end(), is_near)) return false;
    scene_.static_index().Query(box, near_);
    if (std::any_of(near_.begin(), near_.end(), [&](const ConvexPiece* piece) { return is_near(*piece); }))
      return false;
    near_bodies_.clear();
    bodies_.Query(box, near_bodies_);
    for (const BodyId body : near_bodies_) {
      const std::vector<ConvexPiece>& pieces = bodies_.pieces_in_world(body);
      if (std::any_of(pieces.begin(), pieces.end(), is_near)) return false;
    }
    return std::none_of(starts_.begin(), starts_.end(), [&](const Start& other) {
      // Visitors of one flow enter one after another.
      return !(rule.flow && other.flow == rule.flow) && other.z.Overlaps(z) &&
             (other.at - at).norm() < other.radius + reach;
    });
  }

  // What all people of a rule have in common.
  struct Look {
    double neck;       // m, the height at which the head begins
    double head_size;  // m
    ShapeId body;
    ShapeId head;
  };

  Look LookOf(const PeopleRule& rule) {
    const double hips = 0.48 * rule.height;
    const double neck = 0.86 * rule.height;
    const double head_radius = std::min(0.12, 0.7 * rule.person.radius);
    const ShapeId body = AddShape(
        {{Prism(8, 0.8 * rule.person.radius, {0.0, hips}), Prism(12, rule.person.radius, {hips, neck})}, {}, {}});
    const ShapeId head = AddShape({{Prism(8, head_radius, {0.0, rule.height - neck})}, {}, {}});
    return {neck, 2.0 * head_radius, body, head};
  }

  void AddPerson(const PeopleRule& rule, const Look& look, std::uint64_t number, std::uint64_t i, const Pose& start,
                 const std::optional<PersonId>& leader) {
    // A person needs two free names, for the trunk and for the head.
    std::string name;
    do {
      name = rule.name_prefix + std::to_string(++numbers_[rule.name_prefix]);
    } while (names_.contains(name) || names_.contains(name + ".head"));
    ModelDescription model;
    model.name = name;
    model.type = "person";
    model.X_PM = start;
    model.shape = look.body;
    model.size_x = model.size_y = 2.0 * rule.person.radius;
    model.size_z = rule.height;
    model.color = kShirts[RandomBits({seed_, kStartStream, number, i, 0}) % kShirts.size()];
    PersonDescription person = rule.person;
    person.root = ModelId(world_.models.size());
    person.speed = rule.speed.min + Random(number, i, kMaxDraws, 0) * (rule.speed.max - rule.speed.min);
    // Never below the own speed: a rule's limit holds for evasion, not for walking.
    person.max_speed = person.max_speed > 0.0 ? std::max(person.max_speed, person.speed) : 1.4 * person.speed;
    person.leader = leader;
    world_.models.push_back(model);
    model.name += ".head";
    model.type = "model";
    model.parent = person.root;
    model.X_PM = {0.0, 0.0, look.neck, 0.0};
    model.shape = look.head;
    model.size_x = model.size_y = look.head_size;
    model.size_z = rule.height - look.neck;
    model.color = kSkins[RandomBits({seed_, kStartStream, number, i, 1}) % kSkins.size()];
    world_.models.push_back(std::move(model));
    world_.people.push_back(person);
    if (rule.flow) world_.visitors.push_back({.person = PersonId(world_.people.size() - 1), .flow = rule.flow});
    starts_.push_back({start.translation(), rule.person.radius, {rule.z, rule.z + rule.height}, rule.flow});
  }

  ShapeId AddShape(Shape shape) {
    // One shape for all people of a rule, and for rules of equal sizes.
    const auto same = std::find(world_.shapes.begin(), world_.shapes.end(), shape);
    const ShapeId id(static_cast<std::size_t>(same - world_.shapes.begin()));
    if (same == world_.shapes.end()) world_.shapes.push_back(std::move(shape));
    return id;
  }

  struct Start {
    Vec2 at;
    double radius;
    ZRange z;
    std::optional<std::uint32_t> flow;
  };

  LoadedWorld loaded_;
  WorldDescription& world_;
  const std::uint64_t seed_;
  const Scene scene_;  // without people
  BodyIndex bodies_;
  std::vector<ConvexPiece> shafts_;
  std::optional<WalkPortals> portals_;
  std::unique_ptr<const WalkGrid> grid_;   // of the present rule, like the next
  std::unique_ptr<const WalkField> ways_;  // to its point
  std::set<std::string> names_;
  std::map<std::string, std::uint64_t> numbers_;  // of the last person, by prefix
  std::vector<Start> starts_;
  std::optional<PersonId> leader_;
  NearPieces near_;
  std::pmr::vector<BodyId> near_bodies_;
};

// Recordings have numbers of their own among the rules, so that their draws do not depend on those.
constexpr std::uint64_t kFirstRecording = std::uint64_t{1} << 32U;

Error TooMany(const SourceLocation& where, std::uint64_t count) {
  return Error{where,
               "found " + std::to_string(count) + " people in all, expected at most " + std::to_string(kMaxPeople)};
}

}  // namespace

Result<LoadedWorld> AddPeople(LoadedWorld loaded, const std::vector<PeopleRule>& rules, std::uint64_t seed) {
  std::uint64_t count = loaded.world.people.size();
  for (const PeopleRule& rule : rules) {
    count += rule.count;
    // Before any index is built.
    if (count > kMaxPeople) return TooMany(rule.where, count);
  }
  if (rules.empty()) return loaded;
  const std::uint64_t first = loaded.world.people.size();
  Crowd crowd(std::move(loaded), seed);
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (Status full = crowd.Add(rules[i], first + i); !full.ok()) return full.error();
  }
  // After the people: their sizes and goals decide on the number of grids.
  if (Status large = crowd.CheckWays(rules.front().where); !large.ok()) return large.error();
  return crowd.Release();
}

Result<LoadedWorld> AddRecordedPeople(LoadedWorld loaded, const std::vector<RecordedPeople>& recordings,
                                      std::uint64_t seed) {
  if (recordings.empty()) return loaded;
  std::size_t count = loaded.world.people.size();
  for (const RecordedPeople& recording : recordings) {
    count += recording.people.size();
    if (count > kMaxPeople) return TooMany(recording.where, count);
  }
  Crowd crowd(std::move(loaded), seed);
  for (std::size_t i = 0; i < recordings.size(); ++i) crowd.Add(recordings[i], kFirstRecording + i);
  if (Status large = crowd.CheckWays(recordings.front().where); !large.ok()) return large.error();
  return crowd.Release();
}

}  // namespace troupe
