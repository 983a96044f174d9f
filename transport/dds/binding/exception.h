// Exception: a DDS call failed. The text names the operation, and the return code in words.
#pragma once

#include <dds/dds.h>

#include <stdexcept>
#include <string>

namespace troupe::dds {

class Exception : public std::runtime_error {
 public:
  // `doing` completes the sentence "while ...": "creating topic 'troupe/frame'".
  Exception(dds_return_t code, const std::string& doing);

  dds_return_t code() const { return code_; }

 private:
  dds_return_t code_;
};

// Returns `result` (a handle, a count or OK). Throws Exception if it is a failure.
template <typename Doing>
dds_return_t Check(dds_return_t result, const Doing& doing) {
  if (result < 0) throw Exception(result, doing);
  return result;
}

}  // namespace troupe::dds
