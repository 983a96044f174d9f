#include "testing/cases/test_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "common/base/text.h"
#include "worldfile/scenario/scenario_schema.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Keys that a test of another scenario may have.
const std::set<std::string> kKeysOfTests = {"$schema", "scenario", "name",   "seed",  "ticks",   "vary",
                                            "where",   "design",   "expect", "cover", "metrics", "heat"};

// The offset in a JSON string's bytes, with its quotes, of byte `index` of the text that it stands for.
std::size_t OffsetInString(std::string_view quoted, std::size_t index) {
  std::size_t offset = 1;
  std::size_t made = 0;
  while (offset + 1 < quoted.size() && made < index) {
    if (quoted[offset] != '\\') {
      ++offset;
      ++made;
    } else if (quoted[offset + 1] == 'u' && offset + 6 <= quoted.size()) {
      // The bytes in UTF-8; both halves of a pair make two of them each.
      const unsigned long code = std::stoul(std::string(quoted.substr(offset + 2, 4)), nullptr, 16);
      made += code < 0x80 ? 1 : code < 0x800 || (code >= 0xd800 && code < 0xe000) ? 2 : 3;
      offset += 6;
    } else {
      offset += 2;
      ++made;
    }
  }
  return offset;
}

// `design`: null for the default.
Result<DesignSettings> ReadDesignSettings(const JsonTree& tree, const JsonNode* design) {
  DesignSettings settings;
  if (design == nullptr || design->text == "product") return settings;
  if (design->is_object()) {
    settings.kind = DesignKind::kRandom;
    settings.cases = design->Member("random").ToInteger<std::uint64_t>();
    design->Read("seed", settings.seed);
    return settings;
  }
  if (design->text == "pairwise") {
    settings.kind = DesignKind::kPairwise;
    return settings;
  }
  return tree.ErrorAt(*design,
                      fmt::format("found {}, expected 'product', 'pairwise', or {{\"random\": the number of cases}}",
                                  Quoted(design->text)));
}

}  // namespace

std::vector<HeatMap> TestHeat::EmptyMaps() const {
  std::vector<HeatMap> maps;
  for (const HeatKind kind : kinds) maps.emplace_back(kind, cell);
  return maps;
}

Result<TestFile> TestFile::Read(const std::string& path, const TestCase& fixed) {
  TestFile test;
  test.path_ = path;
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0});
  if (!text.ok()) return text.error();
  test.text_ = text.value();
  Result<ScenarioText> parsed = ScenarioText::Parse(text.value(), path);
  if (!parsed.ok()) return parsed.error();
  const ScenarioText own = std::move(parsed).value();
  const JsonTree& tree = own.tree();
  if (Status error = CheckSchema(tree); !error.ok()) return error.error();
  const JsonNode& root = tree.root();
  const JsonNode* const name = root.Find("name");
  test.name_ = name != nullptr ? name->text : std::filesystem::path(path).stem().string();
  if (name == nullptr && test.name_.ends_with(".test")) test.name_.resize(test.name_.size() - 5);

  test.scenario_path_ = path;
  if (const JsonNode* const scenario = root.Find("scenario")) {
    for (const JsonNode& member : root.items) {
      if (kKeysOfTests.contains(member.key)) continue;
      return Error{tree.WhereKey(member),
                   fmt::format("found the key {} in a test of another scenario, expected it in {}", Quoted(member.key),
                               Quoted(scenario->text))};
    }
    std::string file = (std::filesystem::path(DirectoryOf(path)) / scenario->text).lexically_normal().string();
    std::string scenario_text;
    if (std::filesystem::path(file).extension() == ".json") {
      Result<std::string> read = ReadTextFile(file, tree.Where(*scenario));
      if (!read.ok()) return read.error();
      scenario_text = std::move(read).value();
    } else {  // a world alone
      scenario_text = "{\"world\": " + nlohmann::json(std::filesystem::path(file).filename().string()).dump() + "}";
    }
    test.scenario_path_ = file;
    Result<ScenarioText> named = ScenarioText::Parse(std::move(scenario_text), file);
    if (!named.ok()) return named.error();
    test.scenario_ = std::move(named).value();
    // A test may set these two for a scenario of another file, since each test wants its own length.
    for (const char* key : {"seed", "ticks"}) {
      if (const JsonNode* const found = root.Find(key)) test.common_.push_back({key, found->text});
    }
  } else {
    test.scenario_ = own;
  }
  if (Status error = test.ReadClauses(tree); !error.ok()) return error.error();
  if (Status error = test.ReadHeat(tree); !error.ok()) return error.error();
  if (Status error = test.ReadDesign(tree, fixed); !error.ok()) return error.error();
  return test;
}

Status TestFile::ReadClauses(const JsonTree& tree) {
  const JsonNode& root = tree.root();
  const auto read = [&](const JsonNode& entry, const std::string& key) -> TestClause {
    const JsonNode& that = entry.is_string() ? entry : entry.Member("that");
    const JsonNode* const name = entry.is_object() ? entry.Find("name") : nullptr;
    const std::string shown = !key.empty() ? key : name != nullptr ? name->text : that.text;
    return {shown, that.text, that.span};
  };
  for (auto [key, clauses] : {std::pair{"expect", &expect_}, std::pair{"cover", &cover_}}) {
    const JsonNode* const list = root.Find(key);
    if (list == nullptr) continue;
    for (const JsonNode& entry : list->items) {
      TestClause clause = read(entry, "");
      const auto same = [&](const TestClause& other) { return other.name == clause.name; };
      if (std::any_of(clauses->begin(), clauses->end(), same)) {
        return tree.ErrorAt(entry, fmt::format("found the name {} again, expected another name", Quoted(clause.name)));
      }
      clauses->push_back(std::move(clause));
    }
  }
  if (const JsonNode* const list = root.Find("metrics")) {
    for (const JsonNode& entry : list->items) metrics_.push_back(read(entry, entry.key));
  }
  if (expect_.empty() && cover_.empty() && metrics_.empty()) {
    return tree.ErrorAt(root, "found none of 'expect', 'cover' and 'metrics', expected at least one in a test");
  }
  return {};
}

Status TestFile::ReadHeat(const JsonTree& tree) {
  const JsonNode* const heat = tree.root().Find("heat");
  if (heat == nullptr) return {};
  if (heat->is_object()) heat->Read("cell", heat_.cell);
  for (const JsonNode& entry : (heat->is_object() ? heat->Member("of") : *heat).items) {
    const HeatKind kind = FindByName<HeatKind>(entry.text).value();
    if (std::find(heat_.kinds.begin(), heat_.kinds.end(), kind) != heat_.kinds.end()) {
      return tree.ErrorAt(entry, fmt::format("found {} again, expected each map once", Quoted(entry.text)));
    }
    heat_.kinds.push_back(kind);
  }
  return {};
}

Result<std::vector<Variation>> TestFile::ReadVariations(const JsonTree& tree) const {
  std::vector<Variation> variations;
  for (const JsonNode& entry : tree.root().ItemsOf("vary")) {
    const auto error_at_key = [&](std::string message) { return Error{tree.WhereKey(entry), std::move(message)}; };
    Result<ValuePath> path = ValuePath::Parse(entry.key);
    if (!path.ok()) return error_at_key(path.error().message);
    if (const Result<const JsonNode*> found = scenario_->Find(path.value()); !found.ok()) {
      return error_at_key(found.error().message);
    }
    for (const Variation& other : variations) {
      if (!other.value_path().Overlaps(path.value())) continue;
      return error_at_key(fmt::format("found the path {}, a value that {} varies too, expected one of the two",
                                      Quoted(entry.key), Quoted(other.path())));
    }
    Result<Variation> variation = Variation::Read(tree, entry, std::move(path).value());
    if (!variation.ok()) return variation.error();
    variations.push_back(std::move(variation).value());
  }
  return variations;
}

Status TestFile::FixDraws(const TestCase& fixed, std::vector<Variation>& variations) const {
  for (const DrawnValue& draw : fixed) {
    const ValuePath path = ValuePath::Parse(draw.path).value();  // ParseCase has parsed it
    const auto varied = std::find_if(variations.begin(), variations.end(),
                                     [&](const Variation& variation) { return variation.value_path() == path; });
    if (varied != variations.end()) {
      if (!varied->Contains(draw.value)) {
        return BadInput(fmt::format("--case: found {} as {}, expected {}", Quoted(draw.value), Quoted(draw.path, 200),
                                    varied->Describe()));
      }
      *varied = Variation::Of(varied->value_path(), draw.value);
      continue;
    }
    if (const Result<const JsonNode*> found = scenario_->Find(path); !found.ok()) {
      return BadInput("--case: " + found.error().message);
    }
    for (const Variation& variation : variations) {
      if (!variation.value_path().Overlaps(path)) continue;
      return BadInput(fmt::format("--case: found {}, a value that {} varies, expected the latter", Quoted(draw.path),
                                  Quoted(variation.path())));
    }
    variations.push_back(Variation::Of(path, draw.value));
  }
  return {};
}

Result<std::vector<Constraint>> TestFile::ReadConstraints(const JsonTree& tree,
                                                          const std::vector<std::string>& names) const {
  std::vector<Constraint> constraints;
  for (const JsonNode& entry : tree.root().ItemsOf("where")) {
    Result<Constraint> constraint = Constraint::Parse(entry.text, names);
    if (!constraint.ok()) return At({"", entry.text, entry.span}, constraint.error());
    constraints.push_back(std::move(constraint).value());
  }
  return constraints;
}

Status TestFile::ReadDesign(const JsonTree& tree, const TestCase& fixed) {
  Result<std::vector<Variation>> variations = ReadVariations(tree);
  if (!variations.ok()) return variations.error();
  if (Status error = FixDraws(fixed, variations.value()); !error.ok()) return error;
  std::vector<std::string> names;
  for (const Variation& variation : variations.value()) names.push_back(variation.path());
  std::erase_if(
      common_, [&](const DrawnValue& draw) { return std::find(names.begin(), names.end(), draw.path) != names.end(); });
  Result<std::vector<Constraint>> constraints = ReadConstraints(tree, names);
  if (!constraints.ok()) return constraints.error();
  const JsonNode* const design = tree.root().Find("design");
  const Result<DesignSettings> settings = ReadDesignSettings(tree, design);
  if (!settings.ok()) return settings.error();
  Result<CaseDesign> made =
      CaseDesign::Make(std::move(variations).value(), std::move(constraints).value(), settings.value());
  if (!made.ok()) {
    const JsonNode* const place = design != nullptr ? design : tree.root().Find("vary");
    return place != nullptr ? tree.ErrorAt(*place, made.error().message) : made.error();
  }
  design_ = std::move(made).value();
  return {};
}

TestCase TestFile::WithCommon(const TestCase& draws) const {
  TestCase all;
  for (const DrawnValue& draw : common_) {
    const auto same = [&](const DrawnValue& other) { return other.path == draw.path; };
    if (std::none_of(draws.begin(), draws.end(), same)) all.push_back(draw);
  }
  all.insert(all.end(), draws.begin(), draws.end());
  return all;
}

Result<std::string> TestFile::TextOf(const TestCase& draws) const {
  return scenario_->With(WithCommon(draws));
}

Error TestFile::At(const TestClause& clause, Error error) const {
  const auto column = static_cast<std::size_t>(std::max(error.where.column, 1));
  const std::size_t offset = clause.span.begin + OffsetInString(clause.span.Of(text_), column - 1);
  return {TextLines(text_).Where(path_, offset), std::move(error.message), error.code};
}

bool TestFile::CanMake(const TestCase& draws) const {
  const std::vector<Variation>& variations = design_->variations();
  if (draws.size() < variations.size()) return false;
  for (std::size_t i = 0; i < variations.size(); ++i) {
    if (draws[i].path != variations[i].path() || !variations[i].Contains(draws[i].value)) return false;
  }
  return design_->MeetsConstraints(draws);
}

std::optional<TestCase> TestFile::WholeCase(const TestCase& draws) const {
  const std::vector<Variation>& variations = design_->variations();
  TestCase whole(variations.size());
  for (const DrawnValue& draw : draws) {
    const ValuePath path = ValuePath::Parse(draw.path).value();  // ParseCase has parsed it
    const auto varied = std::find_if(variations.begin(), variations.end(),
                                     [&](const Variation& variation) { return variation.value_path() == path; });
    if (varied != variations.end()) {
      whole[static_cast<std::size_t>(varied - variations.begin())] = {varied->path(), draw.value};
      continue;
    }
    if (draw.path == "ticks" || draw.path == "without") continue;
    const bool overlaps = std::any_of(variations.begin(), variations.end(), [&](const Variation& variation) {
      return variation.value_path().Overlaps(path);
    });
    if (overlaps || !scenario_->Find(path).ok()) return std::nullopt;
    whole.push_back(draw);
  }
  if (!CanMake(whole)) return std::nullopt;
  return whole;
}

Result<std::vector<std::string>> FindTests(const std::vector<std::string>& paths) {
  std::vector<std::string> tests;
  for (const std::string& path : paths) {
    std::error_code failure;
    if (!std::filesystem::is_directory(path, failure)) {
      tests.push_back(path);
      continue;
    }
    std::vector<std::string> found;
    std::filesystem::recursive_directory_iterator entry(path, failure);
    for (; !failure && entry != std::filesystem::recursive_directory_iterator(); entry.increment(failure)) {
      if (entry->path().string().ends_with(".test.json")) found.push_back(entry->path().string());
    }
    if (failure) return Error{{path}, "cannot read the folder: " + failure.message()};
    if (found.empty()) return Error{{path}, "found no test in this folder, expected files that end in .test.json"};
    // A folder's iteration order is the file system's; reports and shards need one that is the same everywhere.
    std::sort(found.begin(), found.end());
    tests.insert(tests.end(), found.begin(), found.end());
  }
  // A file that is named twice, or beside its folder, is one test.
  std::set<std::string> known;
  std::erase_if(tests, [&](const std::string& path) {
    std::error_code failure;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(path, failure);
    return !known.insert(failure ? path : canonical.string()).second;
  });
  return tests;
}

std::vector<std::string> FileNamesOf(const std::vector<std::string>& tests) {
  struct Named {
    std::vector<std::string> parts;  // of the path, the last one first
    std::size_t used = 1;

    std::string Name() const {
      std::string name;
      for (std::size_t i = used; i-- > 0;) name += parts[i] + (i > 0 ? "-" : "");
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
      return name;
    }
  };
  std::vector<Named> named;
  for (const std::string& test : tests) {
    const std::filesystem::path path = std::filesystem::path(test).lexically_normal();
    Named each{{path.stem().string()}};
    if (each.parts[0].ends_with(".test")) each.parts[0].resize(each.parts[0].size() - 5);
    for (std::filesystem::path folder = path.parent_path(); folder.has_filename(); folder = folder.parent_path()) {
      each.parts.push_back(folder.filename().string());
    }
    named.push_back(std::move(each));
  }
  std::map<std::string, std::size_t> count;
  for (bool changed = true; std::exchange(changed, false);) {
    count.clear();
    for (const Named& each : named) ++count[each.Name()];
    for (Named& each : named) {
      if (count[each.Name()] == 1 || each.used == each.parts.size()) continue;
      ++each.used;
      changed = true;
    }
  }
  std::vector<std::string> names;
  for (const Named& each : named) {
    std::string name = each.Name();
    // One test twice, or folders that differ in other characters.
    for (std::size_t i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i) {
      name = fmt::format("{}-{}", each.Name(), i);
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace troupe
