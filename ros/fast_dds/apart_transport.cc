#include "ros/fast_dds/apart_transport.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>

#include <chrono>
#include <optional>
#include <string_view>

#include "ros/fast_dds/rtps_datagram.h"

namespace troupe::ros {
namespace {

using eprosima::fastdds::rtps::ChainingTransport;
using eprosima::fastdds::rtps::ChainingTransportDescriptor;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportInterface;
using eprosima::fastdds::rtps::TransportReceiverInterface;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

constexpr std::string_view kTag = "troupe_fast_dds";

class ApartDescriptor final : public ChainingTransportDescriptor {
 public:
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  TransportInterface* create_transport() const override;
};

class ApartTransport final : public ChainingTransport {
 public:
  explicit ApartTransport(const ApartDescriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}

  TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(SenderResource* sender, const octet* bytes, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    const std::optional<Bytes> tagged = WithDomainTag({bytes, size}, kTag);
    if (!tagged) return sender->send(bytes, size, begin, end, timeout);
    return sender->send(tagged->data(), static_cast<std::uint32_t>(tagged->size()), begin, end, timeout);
  }
  void receive(TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size, const Locator_t& local,
               const Locator_t& remote) override {
    if (IsFromCyclone({bytes, size})) return;
    const std::optional<Bytes> safe = SafeParts({bytes, size});
    if (safe) receiver->OnDataReceived(safe->data(), static_cast<std::uint32_t>(safe->size()), local, remote);
  }

 private:
  ApartDescriptor descriptor_;
};

TransportInterface* ApartDescriptor::create_transport() const {
  return new ApartTransport(*this);
}

}  // namespace

std::shared_ptr<ChainingTransportDescriptor> ApartFromCyclone(
    const std::shared_ptr<TransportDescriptorInterface>& low_level) {
  return std::make_shared<ApartDescriptor>(low_level);
}

}  // namespace troupe::ros
