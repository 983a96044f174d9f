// FakeServiceEndpoint: records the messages that a world service sends, and delivers none.
// Tests of the service's parts look at what would be sent; a test of the protocol uses the memory transport instead.
#pragma once

#include <vector>

#include "transport/protocol/transport.h"

namespace troupe::test {

class FakeServiceEndpoint final : public ServiceEndpoint {
 public:
  void Start(ServiceHandler&) override {}
  void SendSession(const SessionMessage& session) override { sessions.push_back(session); }
  void SendAdmissions(const std::vector<AdmissionMessage>& sent) override {
    admissions.insert(admissions.end(), sent.begin(), sent.end());
  }
  void SendFrame(const FrameMessage& frame) override { frames.push_back(frame); }
  void SendHistory(const HistoryMessage& history) override { histories.push_back(history); }
  void SendStatus(const StatusMessage& status) override { statuses.push_back(status); }
  void Flush(double) override {}

  std::vector<SessionMessage> sessions;
  std::vector<AdmissionMessage> admissions;
  std::vector<FrameMessage> frames;
  std::vector<HistoryMessage> histories;
  std::vector<StatusMessage> statuses;
};

}  // namespace troupe::test
