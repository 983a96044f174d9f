// Common to the endpoints of a DdsTransport: the participant, and sending and receiving of messages.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include "common/base/result.h"
#include "common/dds/binding/data_reader.h"
#include "common/dds/binding/data_writer.h"
#include "common/dds/binding/domain_participant.h"
#include "common/dds/binding/publisher.h"
#include "common/dds/convert/convert.h"
#include "common/dds/transport/qos_profiles.h"

namespace troupe::dds {

struct DdsConnection {
  DdsConnection(const DomainConfig& config, const std::string& session,
                std::function<void(const std::string&)> problem_handler)
      : participant(config),
        publisher(participant, qos_profiles::Session(session)),
        subscriber(participant, qos_profiles::Session(session)),
        on_problem(std::move(problem_handler)),
        lease_seconds(config.lease_seconds) {}

  void Report(const std::string& problem) const {
    if (on_problem) on_problem(problem);
  }

  DomainParticipant participant;
  Publisher publisher;
  Subscriber subscriber;
  std::function<void(const std::string&)> on_problem;
  double lease_seconds;
};

// A topic's writer for messages. A message that cannot be written is lost, as it could be on any network.
template <typename Wire>
class Outbox {
 public:
  Outbox(const DdsConnection& connection, const char* topic, const Qos& qos)
      : connection_(connection), topic_(connection.participant, topic), writer_(connection.publisher, topic_, qos) {}

  // `message`: the arguments of the ToWire that makes a Wire, without its arena.
  template <typename... Message>
  void Send(const Message&... message) {
    try {
      WireArena arena;
      writer_.write(ToWire(message..., arena));
    } catch (const Exception& failure) {
      connection_.Report(topic_.name() + ": not sent: " + failure.what());
    }
  }

  DataWriter<Wire>& writer() { return writer_; }

 private:
  const DdsConnection& connection_;
  Topic<Wire> topic_;
  DataWriter<Wire> writer_;
};

// A topic's reader that passes its samples to a function. It keeps their memory for the next ones.
template <typename Wire>
class WireInbox {
 public:
  WireInbox(const DdsConnection& connection, const char* topic, const Qos& qos)
      : connection_(connection), topic_(connection.participant, topic), reader_(connection.subscriber, topic_, qos) {}

  // Calls `drain`, on a thread of Cyclone's, whenever there may be samples.
  void Listen(const std::function<void()>& drain) {
    DataReaderListener listener;
    listener.on_data_available = drain;
    listener.on_liveliness_changed = [drain](const LivelinessChangedStatus&) { drain(); };
    listener.on_subscription_matched = [drain](const SubscriptionMatchedStatus&) { drain(); };
    listener.on_exception = [this](std::exception_ptr exception) { ReportException(exception); };
    reader_.set_listener(std::move(listener));
  }
  // No call of `drain` runs any more when it returns.
  void Close() { reader_.clear_listener(); }

  // Empties the reader: on_sample gets each sample, on_end the last one of each instance that ended (its key fields
  // only).
  template <typename OnSample, typename OnEnd>
  void Drain(OnSample on_sample, OnEnd on_end) {
    do {
      reader_.take(buffer_);
      for (std::size_t i = 0; i < buffer_.length(); ++i) {
        const SampleInfo info = buffer_.info(i);
        if (!info.instance_alive()) {
          on_end(buffer_.data(i));
        } else if (info.valid()) {
          on_sample(buffer_.data(i));
        }
      }
    } while (buffer_.full());  // later samples are announced again
  }

  void ReportMalformed(const Error& error) const { connection_.Report(topic_.name() + ": ignored: " + error.message); }

  // Frees the memory of the last samples.
  void Clear() { buffer_.clear(); }

 private:
  void ReportException(const std::exception_ptr& exception) const {
    try {
      std::rethrow_exception(exception);
    } catch (const std::exception& failure) {
      connection_.Report(topic_.name() + ": " + failure.what());
    } catch (...) {
      connection_.Report(topic_.name() + ": an exception of an unknown type");
    }
  }

  const DdsConnection& connection_;
  Topic<Wire> topic_;
  DataReader<Wire> reader_;
  SampleBuffer<Wire> buffer_;
};

// A topic's reader that passes messages to a function.
template <typename Wire, typename Message>
class Inbox : public WireInbox<Wire> {
 public:
  using WireInbox<Wire>::WireInbox;

  // Empties the reader: on_message gets each well-formed message, on_end as in WireInbox.
  template <typename OnMessage, typename OnEnd>
  void Drain(OnMessage on_message, OnEnd on_end) {
    const auto convert = [&](const Wire& wire) {
      if constexpr (requires { FromWire(wire, message_); }) {
        if (!CanRead(wire, message_)) return;
        if (Status malformed = FromWire(wire, message_); !malformed.ok())
          return this->ReportMalformed(malformed.error());
        on_message(message_);
      } else {
        const Result<Message> message = FromWire(wire);
        if (!message.ok()) return this->ReportMalformed(message.error());
        on_message(message.value());
      }
    };
    WireInbox<Wire>::Drain(convert, on_end);
  }
  template <typename OnMessage>
  void Drain(OnMessage on_message) {
    Drain(on_message, [](const Wire&) {});
  }

 private:
  Message message_;  // filled again and again by the converters of the messages of each tick
};

}  // namespace troupe::dds
