// WakeEvent: wakes a thread that waits for descriptors, from any other one.
#pragma once

namespace troupe {

class WakeEvent {
 public:
  // Throws std::system_error without resources.
  WakeEvent();
  ~WakeEvent();
  WakeEvent(const WakeEvent&) = delete;
  WakeEvent& operator=(const WakeEvent&) = delete;

  // Readable from Signal on until Clear.
  int descriptor() const { return descriptor_; }
  void Signal() const;
  void Clear() const;

 private:
  const int descriptor_;
};

}  // namespace troupe
