// McapFile: an MCAP file of messages on topics, for other programs.
//
// Schemas and channels are written when their first message is; the writer orders nothing, so messages must come with
// times that do not decrease. The counts per topic are those that a ROS bag repeats in its metadata.yaml.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "recording/mcap/writer.h"
#include "troupe/result.h"

namespace troupe {

class McapFile {
 public:
  static Result<McapFile> Create(const std::string& path, const std::string& profile);

  // A topic, made by the first call.
  struct Topic {
    std::string name;
    mcap::Schema schema;
    std::string message_encoding;
    std::map<std::string, std::string> metadata = {};
  };
  // `make` gives the topic if there is none of that name.
  template <typename Make>
  std::uint16_t FindTopic(const std::string& name, const Make& make) {
    const auto known = channels_.find(name);
    return known != channels_.end() ? known->second : AddTopic(make());
  }

  // `time`: ns, not less than in the call before.
  Status Write(std::uint16_t topic, std::uint64_t time, std::span<const std::byte> message);
  Status Close() { return writer_.Close(); }

  // Of the messages so far.
  struct TopicCount {
    std::string name;
    std::string type;  // name of the schema
    std::map<std::string, std::string> metadata;
    std::uint64_t messages = 0;
  };
  const std::map<std::uint16_t, TopicCount>& counts() const { return counts_; }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t first_time() const { return first_time_; }
  std::uint64_t last_time() const { return last_time_; }

 private:
  explicit McapFile(mcap::Writer writer) : writer_(std::move(writer)) {}
  std::uint16_t AddTopic(const Topic& topic);

  mcap::Writer writer_;
  std::map<std::string, std::uint16_t> schemas_;   // by name
  std::map<std::string, std::uint16_t> channels_;  // by topic
  std::map<std::uint16_t, TopicCount> counts_;     // by channel
  std::uint64_t messages_ = 0;
  std::uint64_t first_time_ = 0;
  std::uint64_t last_time_ = 0;
};

}  // namespace troupe
