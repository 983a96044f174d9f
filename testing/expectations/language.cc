// The tables of docs/testing.md.
#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <tuple>

#include "testing/expectations/rewrite.h"
#include "testing/expectations/signals.h"
#include "troupe/expectation.h"

namespace troupe {
namespace {

// "Opening: from 0, closed, to 1."
std::string Sentence(const Signal& signal) {
  std::string text = signal.name;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  std::replace(text.begin(), text.end(), '_', ' ');
  return text + (signal.documentation.empty() ? "" : ": " + signal.documentation) + ".";
}

std::string ResultOf(const Signal& signal) {
  if (signal.type == ValueType::kTruth) return "condition";
  if (signal.type == ValueType::kText) return "text";
  return signal.unit.empty() ? "number" : signal.unit;
}

std::string UpperCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// The signals of the tables of things. Signals of one name and meaning are one row.
void AddTableSignals(std::vector<LanguageEntry>& entries) {
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> known;
  for (const StateTable& table : StateTables()) {
    if (table.varies) continue;
    for (const Signal& signal : table.signals) {
      std::string usage = signal.name + "(" + table.singular + ")";
      if (table.of_robots) usage += ", " + signal.name + "(r, \"" + UpperCase(table.singular) + "\")";
      LanguageEntry entry{usage, ResultOf(signal), Sentence(signal)};
      const auto [row, is_new] = known.try_emplace({signal.name, entry.result, entry.meaning}, entries.size());
      if (is_new) {
        entries.push_back(std::move(entry));
      } else {
        entries[row->second].usage += ", " + usage;
      }
    }
  }
}

}  // namespace

std::vector<LanguageEntry> ListSignals() {
  std::vector<LanguageEntry> entries;
  AddTableSignals(entries);
  for (const SignalInfo& info : RunSignals()) {
    std::string result = ToString(info.dimension);
    if (info.type == ValueType::kTruth) result = "condition";
    if (info.type == ValueType::kText) result = "text";
    if (info.type == ValueType::kNumber && result.empty()) result = "number";
    entries.push_back({info.usage, result, info.meaning});
  }
  entries.push_back({"count(event(...))", "number", "Number of such events so far."});
  entries.push_back(
      {"count(TABLE)", "number", "Number of rows of a table, such as transmissions: radio messages on their way."});
  entries.push_back({"abs(X)", "as X", "Absolute value."});
  entries.push_back({"sqrt(X)", "root of X", "Square root: m of m^2."});
  entries.push_back({"min(X, Y), max(X, Y)", "as X", "The lesser or greater of two numbers."});
  return entries;
}

std::vector<LanguageEntry> ListOperators() {
  return {
      {"always[A, B] P", "condition", "P holds at each tick from A to B after this one, always P: at all to the end."},
      {"eventually[A, B] P", "condition", "P holds at one of these ticks."},
      {"P until[A, B] Q", "condition",
       "Q holds at one of these ticks, and P at each tick from this one to the one before."},
      {"finally P", "condition", "P holds at the last tick of the run."},
      {"historically[A, B] P", "condition",
       "P has held at each tick from B to A before this one, or to the first one."},
      {"once[A, B] P", "condition", "P has held at one of these ticks."},
      {"P since Q", "condition", "Q has held at this tick or before, and P at each tick after it up to this one."},
      {"not P, P and Q, P or Q, P -> Q", "condition",
       "As usual; P -> Q is not P or Q. From strong to weak: not and the "
       "temporal operators, until and since, and, or, ->."},
      {"X < Y, <=, >, >=, ==, !=", "condition", "Comparison of two numbers of one unit. Robustness: their difference."},
      {"X + Y, X - Y, X * Y, X / Y, -X", "number", "Arithmetic with units."},
      {"forall r: P, exists r: P", "condition",
       "P holds for all robots, or for one. The formula behind ':' is as long as "
       "possible."},
      {"forall a, b: P", "condition", "For all pairs of different robots; up to four variables."},
      {"forall r in \"scout*\": P", "condition", "For robots with names like that: * any characters, ? one."},
      {"forall o in objects: P, in objects \"can*\": P", "condition", "For movable objects."},
      {"forall d in doors: P, exists p in people: P", "condition",
       "For doors, people, lifts, joints, sensors, levels, lanes and the things of all other tables, with names or "
       "without."},
      {"min r: X, max r: X, sum r: X, mean r: X", "as X", "Over the robots, at one tick."},
      {"count r: P", "number", "Number of robots for which P holds, at one tick."},
      {"true, false", "condition", "Constants."},
  };
}

std::vector<LanguageEntry> ListShorthands() {
  std::vector<LanguageEntry> entries;
  for (const Shorthand& shorthand : Shorthands()) {
    entries.push_back({shorthand.usage, shorthand.formula, shorthand.meaning});
  }
  return entries;
}

}  // namespace troupe
