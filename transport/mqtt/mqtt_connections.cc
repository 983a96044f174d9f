#include "transport/mqtt/mqtt_connections.h"

#include <fcntl.h>
#include <mosquitto.h>
#include <netdb.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <system_error>
#include <utility>

namespace troupe::mqtt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kKeepAlive = 15;          // s
constexpr double kFirstRetry = 1.0;     // s
constexpr double kLongestRetry = 30.0;  // s
constexpr double kReach = 2.0;          // s, for the broker's host to answer
constexpr double kGreeting = 30.0;      // s, for the broker to accept a client, of perhaps a thousand at once
constexpr int kPackets = 64;            // that are read or written at once

// A connection for each vehicle is a descriptor: the usual soft limit of 1024 is too few.
void UseLibrary() {
  static std::once_flag once;
  std::call_once(once, [] {
    mosquitto_lib_init();
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  });
}

Clock::time_point After(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

int MillisecondsTo(Clock::time_point time) {
  const double left = std::chrono::duration<double, std::milli>(time - Clock::now()).count();
  return static_cast<int>(std::ceil(std::clamp(left, 0.0, 60'000.0)));
}

struct Descriptor {
  explicit Descriptor(int number) : descriptor(number) {}
  ~Descriptor() {
    if (descriptor >= 0) close(descriptor);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  const int descriptor;
};

// Whether a TCP connection can be made, in bounded time: that of libmosquitto waits for minutes. Empty: yes.
std::string WhyUnreachable(const Broker& broker) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int problem = getaddrinfo(broker.host.c_str(), std::to_string(broker.port).c_str(), &hints, &found);
      problem != 0) {
    return gai_strerror(problem);
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, freeaddrinfo);
  std::string reason = "no address";
  for (const addrinfo* address = found; address; address = address->ai_next) {
    const Descriptor trial(socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (trial.descriptor < 0) return std::generic_category().message(errno);
    int problem = connect(trial.descriptor, address->ai_addr, address->ai_addrlen) == 0 ? 0 : errno;
    if (problem == EINPROGRESS) {
      pollfd waited{trial.descriptor, POLLOUT, 0};
      if (poll(&waited, 1, static_cast<int>(kReach * 1000.0)) <= 0) {
        problem = ETIMEDOUT;
      } else {
        socklen_t length = sizeof problem;
        if (getsockopt(trial.descriptor, SOL_SOCKET, SO_ERROR, &problem, &length) != 0) problem = errno;
      }
    }
    if (problem == 0) return {};
    reason = std::generic_category().message(problem);
  }
  return reason;
}

std::string TextOf(int problem) {
  return problem == MOSQ_ERR_ERRNO ? std::generic_category().message(errno) : mosquitto_strerror(problem);
}

}  // namespace

class Connections::Content {
 public:
  Content(Broker broker, int wake) : broker_(std::move(broker)), wake_(wake) { UseLibrary(); }

  ~Content() {
    for (const std::unique_ptr<Client>& client : clients_) mosquitto_destroy(client->handle);
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  const Broker& broker() const { return broker_; }
  bool IsConnected(std::size_t client) const { return clients_.at(client)->state == State::kConnected; }

  Result<std::size_t> Add(const ClientOptions& options) {
    auto client = std::make_unique<Client>();
    client->content = this;
    client->number = clients_.size();
    client->options = options;
    for (const std::string& filter : options.subscriptions) {
      if (mosquitto_sub_topic_check(filter.c_str()) != MOSQ_ERR_SUCCESS) {
        return Error{{}, "'" + filter + "' is no filter of MQTT topics"};
      }
    }
    const char* const id = options.id.empty() ? nullptr : options.id.c_str();
    client->handle = mosquitto_new(id, true, client.get());
    if (!client->handle) return Error{{}, "no client of MQTT can be made: " + TextOf(MOSQ_ERR_ERRNO)};
    mosquitto* const handle = client->handle;
    clients_.push_back(std::move(client));  // owns the handle from now on
    if (Status status = SetUp(handle, options); !status.ok()) {
      mosquitto_destroy(handle);
      clients_.pop_back();
      return status.error();
    }
    return clients_.size() - 1;
  }

  bool Publish(std::size_t number, const Message& message) {
    const Client& client = *clients_.at(number);
    if (client.state != State::kConnected) return false;
    if (message.payload.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return false;
    return mosquitto_publish(client.handle, nullptr, message.topic.c_str(), static_cast<int>(message.payload.size()),
                             message.payload.data(), message.qos, message.retained) == MOSQ_ERR_SUCCESS;
  }

  std::vector<Event> Wait(double seconds) {
    const Clock::time_point end = After(seconds);
    do {
      const Clock::time_point next = std::min(end, KeepUp());
      if (!events_.empty()) break;
      if (Exchange(MillisecondsTo(next))) break;
    } while (events_.empty() && Clock::now() < end);
    return std::exchange(events_, {});
  }

  void Close(double seconds) {
    const Clock::time_point end = After(seconds);
    closing_ = true;
    const int wake = std::exchange(wake_, -1);
    while (std::any_of(clients_.begin(), clients_.end(), [](const auto& c) { return HasMore(*c); }) &&
           Clock::now() < end) {
      Exchange(std::min(20, MillisecondsTo(end)));
    }
    for (const auto& client : clients_) {
      if (client->state == State::kConnected) mosquitto_disconnect(client->handle);
    }
    while (std::any_of(clients_.begin(), clients_.end(), [](const auto& c) { return HasMore(*c); }) &&
           Clock::now() < end) {
      Exchange(std::min(20, MillisecondsTo(end)));
    }
    wake_ = wake;
    events_.clear();
  }

 private:
  enum class State : std::uint8_t { kIdle, kGreeting, kConnected };

  struct Client {
    Content* content = nullptr;
    std::size_t number = 0;
    ClientOptions options;
    mosquitto* handle = nullptr;
    State state = State::kIdle;
    Clock::time_point due = {};  // of the next attempt; of the end of the greeting
    double retry = kFirstRetry;  // s
  };

  static bool HasMore(const Client& client) {
    return client.state == State::kConnected && mosquitto_want_write(client.handle);
  }

  Status SetUp(mosquitto* handle, const ClientOptions& options) {
    // Small messages go out at once: TCP would hold the second of two back until the broker's host acknowledges the
    // first, 40 ms later.
    mosquitto_int_option(handle, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_connect_callback_set(handle, [](mosquitto*, void* self, int code) { OnConnect(*ToClient(self), code); });
    mosquitto_disconnect_callback_set(handle,
                                      [](mosquitto*, void* self, int code) { OnDisconnect(*ToClient(self), code); });
    mosquitto_message_callback_set(handle, [](mosquitto*, void* self, const mosquitto_message* message) {
      const Client& client = *ToClient(self);
      const char* const bytes = static_cast<const char*>(message->payload);
      client.content->events_.emplace_back(
          Received{client.number,
                   {message->topic, bytes ? std::string(bytes, static_cast<std::size_t>(message->payloadlen)) : "",
                    message->qos, message->retain}});
    });
    if (!broker_.user.empty()) {
      if (const int problem = mosquitto_username_pw_set(handle, broker_.user.c_str(), broker_.password.c_str())) {
        return Error{{}, "the user of the broker cannot be used: " + TextOf(problem)};
      }
    }
    if (options.will) {
      const Message& will = *options.will;
      if (const int problem = mosquitto_will_set(handle, will.topic.c_str(), static_cast<int>(will.payload.size()),
                                                 will.payload.data(), will.qos, will.retained)) {
        return Error{{}, "'" + will.topic + "' is no topic of MQTT: " + TextOf(problem)};
      }
    }
    if (!broker_.tls) return {};
    for (const std::string& file : {broker_.ca_file, broker_.certificate_file, broker_.key_file}) {
      if (!file.empty() && access(file.c_str(), R_OK) != 0) {
        return Error{{file}, "cannot be read: " + TextOf(MOSQ_ERR_ERRNO)};
      }
    }
    const auto or_null = [](const std::string& file) { return file.empty() ? nullptr : file.c_str(); };
    // Without a file of authorities those of the system.
    const char* const folder = broker_.ca_file.empty() ? "/etc/ssl/certs" : nullptr;
    if (const int problem = mosquitto_tls_set(handle, or_null(broker_.ca_file), folder,
                                              or_null(broker_.certificate_file), or_null(broker_.key_file), nullptr)) {
      return Error{{}, "the certificates for " + broker_.Url() + " cannot be used: " + TextOf(problem)};
    }
    return {};
  }

  static Client* ToClient(void* self) { return static_cast<Client*>(self); }

  static void OnConnect(Client& client, int code) {
    if (code != 0) {
      client.content->Fail(client, std::string("the broker refuses it: ") + mosquitto_connack_string(code));
      return;
    }
    client.state = State::kConnected;
    client.retry = kFirstRetry;
    for (const std::string& filter : client.options.subscriptions) {
      mosquitto_subscribe(client.handle, nullptr, filter.c_str(), client.options.qos);
    }
    client.content->events_.emplace_back(Connected{client.number});
  }

  static void OnDisconnect(Client& client, int code) {
    if (code == 0) {
      client.state = State::kIdle;  // asked for
      client.due = Clock::time_point::max();
    } else {
      client.content->Fail(client, TextOf(code));
    }
  }

  void Fail(Client& client, const std::string& reason) {
    if (client.state == State::kIdle) return;
    events_.emplace_back(Disconnected{client.number, reason, client.state == State::kConnected});
    client.state = State::kIdle;
    client.due = After(client.retry);
    client.retry = std::min(2.0 * client.retry, kLongestRetry);
  }

  // Makes connections that are due, and returns when to come again at the latest.
  Clock::time_point KeepUp() {
    Clock::time_point next = After(1.0);  // for the keep-alive of libmosquitto
    std::optional<std::string> unreachable;
    for (const auto& client : clients_) {
      if (closing_) break;
      if (client->state == State::kIdle && client->due <= Clock::now()) {
        client->state = State::kGreeting;
        client->due = After(kGreeting);
        if (!unreachable) unreachable = WhyUnreachable(broker_);
        if (!unreachable->empty()) {
          Fail(*client, *unreachable);
        } else if (const int problem =
                       mosquitto_connect(client->handle, broker_.host.c_str(), broker_.port, kKeepAlive)) {
          Fail(*client, TextOf(problem));
        }
      } else if (client->state == State::kGreeting && client->due <= Clock::now()) {
        Fail(*client, "the broker does not answer");
      }
      if (client->state != State::kConnected) next = std::min(next, client->due);
    }
    return next;
  }

  // True if the wake descriptor is readable.
  bool Exchange(int milliseconds) {
    polled_.clear();
    of_polled_.clear();
    for (const auto& client : clients_) {
      if (client->state == State::kIdle) continue;
      const int socket = mosquitto_socket(client->handle);
      if (socket < 0) {
        Fail(*client, "the connection is closed");
        continue;
      }
      const bool writes = mosquitto_want_write(client->handle);
      polled_.push_back({socket, static_cast<short>(POLLIN | (writes ? POLLOUT : 0)), 0});
      of_polled_.push_back(client.get());
    }
    if (wake_ >= 0) polled_.push_back({wake_, POLLIN, 0});
    if (!events_.empty()) milliseconds = 0;
    if (poll(polled_.data(), polled_.size(), milliseconds) < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "poll");
    }
    for (std::size_t i = 0; i < of_polled_.size(); ++i) {
      Client& client = *of_polled_[i];
      int problem = MOSQ_ERR_SUCCESS;
      if ((polled_[i].revents & (POLLIN | POLLERR | POLLHUP)) != 0) {
        problem = mosquitto_loop_read(client.handle, kPackets);
      }
      if (problem == MOSQ_ERR_SUCCESS && (polled_[i].revents & POLLOUT) != 0) {
        problem = mosquitto_loop_write(client.handle, kPackets);
      }
      if (problem == MOSQ_ERR_SUCCESS) problem = mosquitto_loop_misc(client.handle);
      if (problem != MOSQ_ERR_SUCCESS) Fail(client, TextOf(problem));
    }
    return wake_ >= 0 && (polled_.back().revents & POLLIN) != 0;
  }

  const Broker broker_;
  int wake_;
  bool closing_ = false;
  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<Event> events_;
  std::vector<pollfd> polled_;
  std::vector<Client*> of_polled_;
};

Connections::Connections(Broker broker, int wake) : content_(std::make_unique<Content>(std::move(broker), wake)) {}
Connections::~Connections() = default;

const Broker& Connections::broker() const {
  return content_->broker();
}
Result<std::size_t> Connections::Add(const ClientOptions& options) {
  return content_->Add(options);
}
bool Connections::IsConnected(std::size_t client) const {
  return content_->IsConnected(client);
}
bool Connections::Publish(std::size_t client, const Message& message) {
  return content_->Publish(client, message);
}
std::vector<Event> Connections::Wait(double seconds) {
  return content_->Wait(seconds);
}
void Connections::Close(double seconds) {
  content_->Close(seconds);
}

}  // namespace troupe::mqtt
