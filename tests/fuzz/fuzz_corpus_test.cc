// Findings of fuzzing stay fixed: each target passes the files of its corpus, and small changes of them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "fuzz/targets.h"

namespace troupe::fuzz {
namespace {

struct Target {
  const char* name;
  void (*run)(Bytes);
};

constexpr Target kTargets[] = {
    {"admissions", Admissions},
    {"building", Building},
    {"changes", Changes},
    {"control", Control},
    {"control_reply", ControlReply},
    {"expectation", Expectation},
    {"frame", Frame},
    {"frame_request", FrameRequest},
    {"gazebo", Gazebo},
    {"history", History},
    {"host_message", HostMessage},
    {"image", Image},
    {"join", Join},
    {"floor_plan", FloorPlan},
    {"layout", Layout},
    {"route_graph", RouteGraph},
    {"map_yaml", MapYaml},
    {"mesh", Mesh},
    {"page_request", PageRequest},
    {"proposal", Proposal},
    {"recording", Recording},
    {"report", Report},
    {"ros_sample", RosSample},
    {"scenario", Scenario},
    {"service_report", ServiceReport},
    {"session", Session},
    {"status", Status},
    {"test_file", TestFile},
    {"world", World},
    {"zone_mask", ZoneMask},
};

std::filesystem::path CorpusFolder() {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  return source == nullptr ? std::filesystem::path() : std::filesystem::path(source) / "fuzz" / "corpus";
}

std::vector<std::byte> ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

TEST(FuzzCorpus, IsPassedByEachTarget) {
  const std::filesystem::path folder = CorpusFolder();
  if (folder.empty()) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  for (const Target& target : kTargets) {
    SCOPED_TRACE(target.name);
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / target.name)) {
      std::vector<std::byte> bytes = ReadBytes(entry.path());
      target.run(bytes);
      ++count;
      // Cut off, and with one byte changed, at some places.
      const std::size_t step = bytes.size() / 16 + 1;
      for (std::size_t at = 0; at < bytes.size(); at += step) {
        target.run(Bytes(bytes).first(at));
        bytes[at] ^= std::byte{0xff};
        target.run(bytes);
        bytes[at] ^= std::byte{0xff};
      }
    }
    EXPECT_GE(count, 1u);
  }
}

TEST(FuzzCorpus, HasAFolderForEachTargetOnly) {
  const std::filesystem::path folder = CorpusFolder();
  if (folder.empty()) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  std::set<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) folders.insert(entry.path().filename());
  std::set<std::string> names;
  for (const Target& target : kTargets) names.insert(target.name);
  EXPECT_EQ(folders, names);
}

}  // namespace
}  // namespace troupe::fuzz
