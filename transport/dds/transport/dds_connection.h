// Common to the endpoints of a DdsTransport: the participant with its publisher and subscriber, and typed ends of
// topics: Outbox to send messages, Inbox to receive them.
//
// What all topics have in common is here: a sample is accepted only from a sender of the run (RunProof), converted by
// the functions of transport/dds/convert, which check it, and reported if it is malformed, through a limiter, so that a
// hostile peer can fill no log. No exception of DDS leaves an Outbox: a message that cannot be written is lost, as the
// tick protocol allows.
//
// Threads: Drain is called by Cyclone's receiving thread (Listen) or by the starting one, under the endpoint's own
// lock: an Inbox is not safe by itself. `on_problem` and `on_foreign_run` are called on any thread.
//
// Endpoints refer to their connection, which outlives them.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/text.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/dds/transport/senders.h"
#include "troupe/result.h"

namespace troupe::dds {

struct DdsConnection {
  // `agent`: the name of the agent that sends (transport/protocol/message_texts.h); empty: another participant does.
  DdsConnection(const DomainConfig& config, const std::string& session_name, const FloodLimiter::Tell& on_problem,
                const std::optional<RunToken>& token = {}, const std::string& agent = {})
      : session(session_name),
        secured(!config.security_enclave.empty()),
        participant(config),
        proof(token, participant.guid_prefix()),
        publisher(participant, agent.empty() ? qos_profiles::Session(session) : qos_profiles::Agent(session, agent)),
        subscriber(participant, qos_profiles::Session(session)),
        lease_seconds(config.lease_seconds),
        problems(on_problem) {}

  // All senders whose samples pass are of the run.
  bool proves() const { return secured || proof.asks(); }
  void Report(const std::string& problem) const { problems.Add(problem); }

  const std::string session;
  const bool secured;  // DDS Security keeps others out
  DomainParticipant participant;
  RunProof proof;
  Publisher publisher;
  Subscriber subscriber;
  double lease_seconds;
  mutable FloodLimiter problems;
  // A participant of a run with a token has sent a message, and this participant lacks the token. On any thread.
  std::function<void()> on_foreign_run;
};

// A topic's writer for messages. A message that cannot be written is lost, as it could be on any network.
template <typename Wire>
class Outbox {
 public:
  // `sharing`: the address of shared memory to be announced; empty: none.
  Outbox(const DdsConnection& connection, const char* topic, const Qos& qos, const std::string& sharing = {})
      : connection_(connection),
        topic_(connection.participant, topic),
        writer_(connection.publisher, topic_, connection.proof.Announced(qos, sharing)) {}

  // `message`: the arguments of the ToWire that makes a Wire, without its arena.
  template <typename... Message>
  void Send(const Message&... message) {
    WireArena arena;
    SendWire(ToWire(message..., arena));
  }
  void SendWire(const Wire& wire) {
    try {
      writer_.write(wire);
    } catch (const Exception& failure) {
      connection_.Report(topic_.name() + ": not sent: " + failure.what());
    }
  }

  DataWriter<Wire>& writer() { return writer_; }
  std::uint32_t CountReaders() const { return writer_.publication_matched_status().current_count; }

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
      : WireInbox(connection, connection.subscriber, topic, qos) {}
  WireInbox(const DdsConnection& connection, const Subscriber& subscriber, const char* topic, const Qos& qos)
      : connection_(connection),
        senders_(connection.proof),
        topic_(connection.participant, topic, senders_),
        reader_(subscriber, topic_, qos) {}

  // Calls `drain`, on a thread of Cyclone's, whenever there may be samples, or a sender may have ended.
  void Listen(const std::function<void()>& drain) {
    DataReaderListener listener;
    listener.on_data_available = drain;
    listener.on_subscription_matched = [this, drain](const SubscriptionMatchedStatus&) {
      matches_changed_ = true;
      drain();
    };
    listener.on_exception = [this](std::exception_ptr exception) { ReportException(exception); };
    reader_.set_listener(std::move(listener));
  }
  // No call of `drain` runs any more when it returns.
  void Close() { reader_.clear_listener(); }

  // Empties the reader: on_sample gets each sample and its sender, then on_end each sender that has ended.
  template <typename OnSample, typename OnEnd>
  void Drain(OnSample on_sample, OnEnd on_end) {
    // The buffer is filled again and again: taking samples allocates nothing in the long run.
    do {
      reader_.take(buffer_);
      for (std::size_t i = 0; i < buffer_.length(); ++i) {
        const SampleInfo info = buffer_.info(i);
        if (!info.valid()) continue;
        const Sender* sender = senders_.Find(reader_.handle(), info.publication_handle());
        if (sender != nullptr && IsOfRun(*sender)) on_sample(buffer_.data(i), *sender);
      }
    } while (buffer_.full());  // later samples are announced again
    if (!matches_changed_.exchange(false)) return;
    for (const Sender& ended : senders_.ForgetEnded(reader_.handle())) on_end(ended);
  }

  // The senders that the reader is matched with, before their first sample, too, without senders of other runs. Valid
  // until Drain.
  std::vector<const Sender*> Matched() {
    std::vector<const Sender*> matched;
    for (const dds_instance_handle_t writer : MatchedPublications(reader_.handle())) {
      const Sender* sender = senders_.Find(reader_.handle(), writer);
      if (sender != nullptr && IsOfRun(*sender)) matched.push_back(sender);
    }
    return matched;
  }

  // Reports that the sender is not entitled to this topic, and drops all that it sends from now on.
  void Refuse(const Sender& sender, const std::string& reason) {
    if (!senders_.Refuse(sender)) return;
    connection_.Report(topic_.name() + ": ignored participant " + ToText(sender.participant) + ": " + reason);
  }

  // Refuses a sender that does not prove to be of the run. `on_foreign_run` is called if it could be proven to a
  // participant with the run's token.
  bool IsOfRun(const Sender& sender) {
    switch (sender.proof) {
      case ProofCheck::kAccepted:
        return true;
      case ProofCheck::kNoProof:
        Refuse(sender, "it is not of this run's user");
        return false;
      case ProofCheck::kUnknownProof:
        Refuse(sender, "it is of a run whose token this program does not have");
        if (connection_.on_foreign_run) connection_.on_foreign_run();
        return false;
    }
    return false;
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
  Senders senders_;
  std::atomic<bool> matches_changed_ = false;
  Topic<Wire> topic_;
  DataReader<Wire> reader_;
  SampleBuffer<Wire> buffer_;
};

// The admission of topics that any participant may write.
struct AdmitAll {
  template <typename Wire>
  bool operator()(const Wire&, const Sender&) const {
    return true;
  }
};

// A topic's reader that passes messages to a function.
template <typename Wire, typename Message>
class Inbox : public WireInbox<Wire> {
 public:
  using WireInbox<Wire>::WireInbox;

  // Empties the reader. Samples for which admits(wire, sender) is false are skipped before they are converted;
  // on_message gets each of the others that is well-formed, and its sender; on_end as in WireInbox.
  template <typename Admits, typename OnMessage, typename OnEnd>
  void Drain(Admits admits, OnMessage on_message, OnEnd on_end) {
    const auto convert = [&](const Wire& wire, const Sender& sender) {
      if (!admits(wire, sender)) return;
      if constexpr (requires { FromWire(wire, message_); }) {
        if (!CanRead(wire, message_)) return;
        if (Status malformed = FromWire(wire, message_); !malformed.ok())
          return this->ReportMalformed(malformed.error());
        on_message(message_, sender);
      } else {
        const Result<Message> message = FromWire(wire);
        if (!message.ok()) return this->ReportMalformed(message.error());
        on_message(message.value(), sender);
      }
    };
    WireInbox<Wire>::Drain(convert, on_end);
  }
  template <typename Admits, typename OnMessage>
  void Drain(Admits admits, OnMessage on_message) {
    Drain(admits, on_message, [](const Sender&) {});
  }

 private:
  Message message_;  // filled again and again by the converters of the messages of each tick
};

}  // namespace troupe::dds
