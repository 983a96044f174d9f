// The text of an answer on /world/tick_done: the name of the participant, and entries behind it, each after one space.
#pragma once

#include <string>
#include <string_view>

namespace troupe::ros {

struct TickAnswer {
  std::string name;
  // "edition:3": of the announcement that is answered, as its first entry; empty: any of the tick.
  std::string edition = {};
  // "waits": no answer. Until others have answered or their calls are executed, the participant makes no call.
  bool waits = false;
};

// Any text is safe: one with other entries is a name as a whole, which no participant has.
TickAnswer ParseTickAnswer(std::string_view text);

}  // namespace troupe::ros
