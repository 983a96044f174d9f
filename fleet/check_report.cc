#include "fleet/check_report.h"

#include <algorithm>

#include "common/base/xml_text.h"
#include "troupe/enum_names.h"

namespace troupe::fleet {
namespace {

std::string Counted(std::uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

std::string CheckReport::Add(const Verdict& verdict, const std::string& place, const std::string& topic) {
  std::string line = place + ": " + NameOf(verdict.rule) + ": " + verdict.vehicle + ", " + topic + ": found " +
                     verdict.found + ", expected " + verdict.expected;
  Broken& broken = vehicles_[verdict.vehicle][verdict.rule];
  ++violations_;
  ++broken.count;
  if (broken.lines.size() < kMostKept) broken.lines.push_back(line);
  return line;
}

std::vector<std::string> CheckReport::Summary(const CheckerMemory& memory) const {
  std::vector<std::string> lines;
  for (const auto& [name, record] : memory.vehicles) {
    std::string line = name + " (" + NameOf(record.version.value_or(Version::k2_1)) +
                       "): " + Counted(record.messages, "message") + ", ";
    const auto found = vehicles_.find(name);
    if (found == vehicles_.end()) {
      line += "no violation";
    } else {
      std::uint64_t count = 0;
      std::string rules;
      for (const auto& [rule, broken] : found->second) {
        count += broken.count;
        rules += std::string(rules.empty() ? "" : ", ") + NameOf(rule) + " " + std::to_string(broken.count);
      }
      line += Counted(count, "violation") + ": " + rules;
    }
    lines.push_back(std::move(line));
  }
  lines.push_back(Counted(memory.vehicles.size(), "vehicle") + ", " + Counted(memory.messages, "message") + ", " +
                  Counted(violations_, "violation"));
  return lines;
}

// In the form that Jenkins and GitLab read.
std::string CheckReport::JUnit(const CheckerMemory& memory, const std::vector<Rule>& left_out) const {
  std::string suites;
  std::size_t all_cases = 0;
  std::size_t all_failures = 0;
  for (const auto& [name, record] : memory.vehicles) {
    const auto found = vehicles_.find(name);
    std::string cases;
    std::size_t count = 0;
    for (const RuleInfo& info : Rules()) {
      if (!info.IsIn(record.version.value_or(Version::k2_1))) continue;
      if (std::find(left_out.begin(), left_out.end(), info.rule) != left_out.end()) continue;
      ++count;
      cases += std::string("    <testcase classname=\"vda5050.") + NameOf(info.side) + "\" name=\"" +
               NameOf(info.rule) + "\"";
      const Broken* const broken =
          found != vehicles_.end() && found->second.contains(info.rule) ? &found->second.at(info.rule) : nullptr;
      if (broken == nullptr) {
        cases += "/>\n";
        continue;
      }
      cases += "><failure message=\"" + XmlText(broken->lines.front()) + "\" type=\"failure\">";
      for (const std::string& line : broken->lines) cases += XmlText(line) + "\n";
      if (broken->count > broken->lines.size()) {
        cases += Counted(broken->count - broken->lines.size(), "further violation") + "\n";
      }
      cases += "</failure></testcase>\n";
    }
    const std::size_t failures = found != vehicles_.end() ? found->second.size() : 0;
    suites += "  <testsuite name=\"" + XmlText(name) + "\" tests=\"" + std::to_string(count) + "\" failures=\"" +
              std::to_string(failures) + "\" errors=\"0\" skipped=\"0\">\n" + cases + "  </testsuite>\n";
    all_cases += count;
    all_failures += failures;
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"" + std::to_string(all_cases) +
         "\" failures=\"" + std::to_string(all_failures) + "\" errors=\"0\">\n" + suites + "</testsuites>\n";
}

}  // namespace troupe::fleet
