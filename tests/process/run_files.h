// The content of the files of --poses and --scans, by tick.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/files.h"
#include "troupe/ids.h"
#include "troupe/pose.h"

namespace troupe::test {

struct LoggedPose {
  Pose X_WR;
  bool stalled = false;
};

// The poses by tick and the name of a robot, an object or a joint.
inline std::map<std::pair<Tick, std::string>, LoggedPose> ReadPoses(const std::string& csv) {
  std::map<std::pair<Tick, std::string>, LoggedPose> poses;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);  // the header
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::vector<std::string> words;
    for (std::string word; std::getline(fields, word, ',');) words.push_back(word);
    if (words.size() < 7) continue;
    const auto number = [&](std::size_t i) { return std::stod(words[i]); };
    poses[{std::stoull(words[0]), words[1]}] = {{number(2), number(3), number(4), number(5)}, words[6] == "1"};
  }
  return poses;
}

// Ranges by tick, robot and sensor.
inline std::map<std::tuple<Tick, std::string, std::string>, std::vector<double>> ReadScans(const std::string& text) {
  std::map<std::tuple<Tick, std::string, std::string>, std::vector<double>> scans;
  for (const std::string& line : LinesOf(text)) {
    const nlohmann::json scan = nlohmann::json::parse(line);
    if (!scan.contains("ranges")) continue;  // of a sensor without rays
    scans[{scan["tick"], scan["robot"], scan["sensor"]}] = scan["ranges"].get<std::vector<double>>();
  }
  return scans;
}

}  // namespace troupe::test
