#include "transport/dds/tools/session_observer.h"

#include <exception>
#include <utility>

#include "transport/dds/binding/network_log.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

class DdsSessionObserver : public SessionObserver {
 public:
  DdsSessionObserver(const DdsOptions& options, ObserverHandler& handler)
      : transport_(MakeDdsObserverTransport(options)), endpoint_(transport_->MakeObserverEndpoint()) {
    endpoint_->Start(handler);
  }

 private:
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<ObserverEndpoint> endpoint_;
};

}  // namespace

Result<std::unique_ptr<SessionObserver>> ObserveSession(const NetworkSettings& network, ObserverHandler& handler) {
  Result<ParticipantKeys> keys = FindKeys(network.security, network.domain, network.session, Role::Observer());
  if (!keys.ok()) return keys.error();
  dds::PrintFirstNetworkMessage();
  DdsOptions options;
  static_cast<NetworkSettings&>(options) = network;
  options.keys = std::move(keys).value();
  try {
    return std::unique_ptr<SessionObserver>(std::make_unique<DdsSessionObserver>(options, handler));
  } catch (const std::exception& exception) {
    return FailureOf(exception);
  }
}

}  // namespace troupe
