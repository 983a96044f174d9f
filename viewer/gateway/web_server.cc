#include "viewer/gateway/web_server.h"

#include <fmt/format.h>
#include <libwebsockets.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <exception>
#include <iterator>
#include <map>
#include <thread>
#include <utility>
#include <vector>

namespace troupe {
namespace {

// The policy of responses: the page loads nothing from elsewhere, and no other page embeds it.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// What lws keeps for each connection. Zeroed by lws.
struct Connection {
  const PageFile* file;  // on its way
  std::size_t sent;      // bytes of it
  ViewerId viewer;       // 0: none
};

struct Download {
  std::shared_ptr<const std::string> content;
  PageFile file;
};

struct ViewerConnection {
  lws* socket = nullptr;
  std::optional<WebMessage> message;        // on its way
  std::size_t sent = 0;                     // bytes of it
  std::string message_start;                // of one from the viewer
  std::optional<lws_close_status> refusal;  // of the viewer, for the close frame
  bool is_closing = false;                  // lws sends that, and waits for the viewer's
};

std::string Header(lws* socket, lws_token_indexes token) {
  std::array<char, 512> text{};
  const int length = lws_hdr_copy(socket, text.data(), static_cast<int>(text.size()), token);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

// Of the address "/?token=TOKEN".
std::string TokenIn(lws* socket) {
  std::array<char, 128> text{};
  const char* value = lws_get_urlarg_by_name(socket, "token=", text.data(), static_cast<int>(text.size()));
  return value != nullptr ? value : "";
}

// The token of "Authorization: Bearer TOKEN", for programs that keep it out of addresses; empty without one.
std::string BearerIn(lws* socket) {
  constexpr std::string_view kScheme = "Bearer ";
  const std::string header = Header(socket, WSI_TOKEN_HTTP_AUTHORIZATION);
  return header.starts_with(kScheme) ? header.substr(kScheme.size()) : std::string();
}

int Refuse(lws* socket, unsigned status, const char* reason) {
  return lws_return_http_status(socket, status, reason);
}

}  // namespace

// libwebsockets calls Callback for all events, on the thread of Serve; only Wake and Stop are for other threads.
class WebServer::Implementation final : public WebLoop {
 public:
  explicit Implementation(const Options& options) : options_(options) { period_.owner = this; }
  ~Implementation();
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Status Listen();
  void Serve(WebHandler& handler) {
    handler_ = &handler;
    thread_ = std::thread([this] {
      while (!ending_) lws_service(context_, 0);
    });
  }
  std::uint16_t port() const { return static_cast<std::uint16_t>(lws_get_vhost_listen_port(vhost_)); }
  void Stop() {
    ending_ = true;
    if (!thread_.joinable()) return;
    Wake();
    thread_.join();
  }
  void Wake() { lws_cancel_service(context_); }

  void RequestMessage(ViewerId viewer) override {
    const auto known = viewers_.find(viewer);
    if (known != viewers_.end()) lws_callback_on_writable(known->second.socket);
  }
  void SetPeriod(double seconds) override {
    period_us_ = static_cast<lws_usec_t>(seconds * 1e6);
    lws_sul_schedule(context_, 0, &period_.timer, OnTimer, period_us_ > 0 ? period_us_ : LWS_SET_TIMER_USEC_CANCEL);
  }

 private:
  struct Period {
    lws_sorted_usec_list_t timer{};  // first: OnTimer is given its address
    Implementation* owner = nullptr;
  };

  static int Callback(lws* socket, lws_callback_reasons reason, void* user, void* in, size_t length);
  static void OnTimer(lws_sorted_usec_list_t* timer);

  int OnHttp(lws* socket, lws_callback_reasons reason, Connection* connection, const char* in);
  int OnViewer(lws* socket, lws_callback_reasons reason, Connection& connection, const char* in, std::size_t length);
  // False: another connection is one too many.
  bool MakeRoom();
  int ConfirmUpgrade(lws* socket, const char* protocol);
  int ServeFile(lws* socket, Connection& connection, const std::string& path);
  // A file of the page. Null: there is none.
  const PageFile* FindFile(const std::string& path) const;
  const PageFile* MakeDownload(lws* socket, const std::string& path);
  int WriteFile(lws* socket, Connection& connection);
  int Receive(lws* socket, Connection& connection, std::string_view part);
  int RefuseViewer(lws* socket, ViewerConnection& viewer, lws_close_status status);
  int WritePiece(lws* socket, Connection& connection);

  const Options options_;
  WebHandler* handler_ = nullptr;  // while it serves
  std::array<lws_protocols, std::size(kProtocols) + 2> protocols_{};
  lws_retry_bo_t idle_policy_{};
  lws_context* context_ = nullptr;
  lws_vhost* vhost_ = nullptr;
  int connections_ = 0;
  std::vector<lws*> strangers_;  // connections that have not shown the token, the oldest first
  ViewerId last_viewer_ = 0;
  std::map<ViewerId, ViewerConnection> viewers_;
  std::map<lws*, Download> downloads_;  // on their way
  std::vector<unsigned char> piece_ = std::vector<unsigned char>(LWS_PRE + kPiece);
  Period period_;
  lws_usec_t period_us_ = 0;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

WebServer::Implementation::~Implementation() {
  Stop();
  if (context_ != nullptr) lws_context_destroy(context_);
}

Status WebServer::Implementation::Listen() {
  lws_set_log_level(0, nullptr);
  // The last member: without it lws sends no more at once than it receives, and keeps the rest of a piece in a buffer.
  protocols_[0] = {"http", Callback, sizeof(Connection), 2048, 0, this, kPiece};
  for (std::size_t i = 0; i < std::size(kProtocols); ++i) {
    protocols_[i + 1] = {kProtocols[i], Callback, sizeof(Connection), 4096, 0, this, kPiece};
  }
  idle_policy_.secs_since_valid_ping = kPingSeconds;
  idle_policy_.secs_since_valid_hangup = kHangUpSeconds;

  lws_context_creation_info info{};
  info.options =
      LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_DISABLE_IPV6 | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  info.gid = static_cast<decltype(info.gid)>(-1);
  info.uid = static_cast<decltype(info.uid)>(-1);
  info.user = this;
  info.protocols = protocols_.data();
  info.max_http_header_data2 = kMaxHeaders;
  info.fd_limit_per_thread = kMaxConnections + 20;
  info.server_string = "troupe";
  info.iface = options_.address == "0.0.0.0" ? nullptr : options_.address.c_str();
  info.vhost_name = "troupe";
  info.timeout_secs = kRequestSeconds;
  info.timeout_secs_ah_idle = kRequestSeconds;
  info.keepalive_timeout = kRequestSeconds;
  info.retry_and_idle_policy = &idle_policy_;
  context_ = lws_create_context(&info);
  if (context_ == nullptr) return Failure("cannot start a web server");
  info.port = options_.port;
  vhost_ = lws_create_vhost(context_, &info);
  if (vhost_ == nullptr && options_.any_port && options_.port != 0) {
    info.port = 0;
    vhost_ = lws_create_vhost(context_, &info);
  }
  if (vhost_ == nullptr) {
    return Failure(fmt::format("cannot listen on {}:{}: the port is in use, or the address is not one of this host",
                               options_.address, options_.port));
  }
  return Status();
}

// Scheduled again first, so that an exception ends no period but its own.
void WebServer::Implementation::OnTimer(lws_sorted_usec_list_t* timer) {
  Implementation& self = *reinterpret_cast<Period*>(timer)->owner;
  lws_sul_schedule(self.context_, 0, timer, OnTimer, self.period_us_);
  try {
    self.handler_->OnPeriod(self);
  } catch (const std::exception&) {  // as without memory: the next period repeats what is missing
    return;
  }
}

int WebServer::Implementation::Callback(lws* socket, lws_callback_reasons reason, void* user, void* in, size_t length) {
  auto* const self = static_cast<Implementation*>(lws_context_user(lws_get_context(socket)));
  auto* const connection = static_cast<Connection*>(user);
  const char* const text = static_cast<const char*>(in);
  if (self->ending_) return 0;
  try {
    switch (reason) {
      case LWS_CALLBACK_ESTABLISHED:
      case LWS_CALLBACK_CLOSED:
      case LWS_CALLBACK_RECEIVE:
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return self->OnViewer(socket, reason, *connection, text, length);
      default:
        return self->OnHttp(socket, reason, connection, text);
    }
  } catch (const std::exception&) {  // as without memory: the connection ends; no exception may pass a library in C
    return reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED ? 0 : -1;
  }
}

int WebServer::Implementation::OnHttp(lws* socket, lws_callback_reasons reason, Connection* connection,
                                      const char* in) {
  switch (reason) {
    case LWS_CALLBACK_WSI_CREATE:
      ++connections_;
      return 0;
    case LWS_CALLBACK_WSI_DESTROY:
      --connections_;
      downloads_.erase(socket);
      std::erase(strangers_, socket);
      return 0;
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      return MakeRoom() ? 0 : 1;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      strangers_.push_back(socket);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return ConfirmUpgrade(socket, in);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:  // an upgrade without a known protocol
      return std::strcmp(lws_get_protocol(socket)->name, "http") == 0 ? -1 : 0;
    case LWS_CALLBACK_HTTP:
      return ServeFile(socket, *connection, in);
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return WriteFile(socket, *connection);
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      if (std::strcmp(lws_get_protocol(socket)->name, "http") == 0) handler_->OnWake(*this);
      return 0;
    case LWS_CALLBACK_HTTP_BODY:  // the page sends none
    case LWS_CALLBACK_RAW_RX:
      return -1;
    default:
      return 0;
  }
}

// Other users of the host can open any number of connections, but cannot keep one that has shown the token away: the
// oldest one that has not is closed for it.
bool WebServer::Implementation::MakeRoom() {
  if (connections_ < kMaxConnections) return true;
  if (strangers_.empty()) return false;
  // The first call may only shut it down, and lws would then wait for its peer; the second one closes it.
  lws* const oldest = strangers_.front();
  for (int call = 0; call < 2 && !strangers_.empty() && strangers_.front() == oldest; ++call) {
    lws_set_timeout(oldest, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_SYNC);
  }
  return connections_ < kMaxConnections;
}

int WebServer::Implementation::ConfirmUpgrade(lws* socket, const char* protocol) {
  if (std::strcmp(protocol, "websocket") != 0) return -1;
  // Programs know only the address. A client of them names no protocol of the page.
  const std::string wanted = Header(socket, WSI_TOKEN_PROTOCOL);
  const bool is_page = wanted.find(kProtocols[0]) != std::string::npos;
  const std::string path = Header(socket, WSI_TOKEN_GET_URI);
  if (path != "/socket" && (is_page || path != "/")) {
    return Refuse(socket, HTTP_STATUS_NOT_FOUND, nullptr) < 0 ? -1 : 1;
  }
  const std::string host = Header(socket, WSI_TOKEN_HOST);
  const std::string origin = Header(socket, WSI_TOKEN_ORIGIN);
  const std::string token = TokenIn(socket);
  const Access access =
      is_page ? options_.access.ForSocket(host, origin, token) : options_.access.ForProgram(host, origin, token);
  const bool full = viewers_.size() >= kMaxViewers;
  if (access == Access::kGranted) std::erase(strangers_, socket);
  if (access == Access::kGranted && !full) return 0;
  const int written = full ? Refuse(socket, HTTP_STATUS_SERVICE_UNAVAILABLE, "too many viewers")
                           : Refuse(socket, HTTP_STATUS_FORBIDDEN, NameOf(access));
  return written < 0 ? -1 : 1;
}

const PageFile* WebServer::Implementation::FindFile(const std::string& path) const {
  const auto known = std::find_if(options_.files.begin(), options_.files.end(),
                                  [&](const PageFile& file) { return file.path == path; });
  return known != options_.files.end() ? &*known : nullptr;
}

const PageFile* WebServer::Implementation::MakeDownload(lws* socket, const std::string& path) {
  std::optional<WebDownload> made = handler_->OnDownload(path);
  if (!made) return nullptr;
  Download& download = downloads_[socket];
  download.content = std::move(made->content);
  download.file = {"", made->type, *download.content};
  return &download.file;
}

int WebServer::Implementation::ServeFile(lws* socket, Connection& connection, const std::string& path) {
  const auto finish = [&](unsigned status, const char* reason) {
    if (Refuse(socket, status, reason) != 0) return -1;
    return lws_http_transaction_completed(socket) != 0 ? -1 : 0;
  };
  if (lws_hdr_total_length(socket, WSI_TOKEN_GET_URI) <= 0) return finish(HTTP_STATUS_METHOD_NOT_ALLOWED, nullptr);
  const PageFile* file = FindFile(path);
  // Without the token a stranger learns nothing; the files of the page but "/" are the same for all runs.
  const AccessRules& rules = options_.access;
  const std::string host = Header(socket, WSI_TOKEN_HOST);
  const bool is_same_for_all = file != nullptr && path != "/";
  const Access access = is_same_for_all   ? rules.ForPage(host, rules.token)
                        : file != nullptr ? rules.ForPage(host, TokenIn(socket))
                                          : rules.ForDownload(host, TokenIn(socket), BearerIn(socket));
  if (access != Access::kGranted) return finish(HTTP_STATUS_FORBIDDEN, NameOf(access));
  if (!is_same_for_all) std::erase(strangers_, socket);
  if (file == nullptr) file = MakeDownload(socket, path);
  if (file == nullptr) return finish(HTTP_STATUS_NOT_FOUND, nullptr);
  if (path == "/") handler_->OnPage();

  std::array<unsigned char, LWS_PRE + 1024> buffer{};
  unsigned char* const start = buffer.data() + LWS_PRE;
  unsigned char* at = start;
  unsigned char* const end = buffer.data() + buffer.size() - 1;
  const auto add = [&](const char* name, std::string_view value) {
    return lws_add_http_header_by_name(socket, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end) == 0;
  };
  const bool written = lws_add_http_common_headers(socket, HTTP_STATUS_OK, std::string(file->type).c_str(),
                                                   file->content.size(), &at, end) == 0 &&
                       (!file->compressed || add("content-encoding:", "gzip")) &&
                       add("content-security-policy:", kContentSecurityPolicy) &&
                       add("x-content-type-options:", "nosniff") && add("referrer-policy:", "no-referrer") &&
                       add("cache-control:", "no-cache");
  if (!written || lws_finalize_write_http_header(socket, start, &at, end) != 0) return -1;
  connection.file = file;
  connection.sent = 0;
  lws_callback_on_writable(socket);
  return 0;
}

int WebServer::Implementation::WriteFile(lws* socket, Connection& connection) {
  if (connection.file == nullptr) return 0;
  const std::string_view rest = connection.file->content.substr(connection.sent);
  const std::size_t count = std::min(rest.size(), kPiece);
  std::memcpy(piece_.data() + LWS_PRE, rest.data(), count);
  const bool last = count == rest.size();
  if (lws_write(socket, piece_.data() + LWS_PRE, count, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0) return -1;
  connection.sent += count;
  if (!last) {
    lws_callback_on_writable(socket);
    return 0;
  }
  connection.file = nullptr;
  downloads_.erase(socket);
  return lws_http_transaction_completed(socket) != 0 ? -1 : 0;
}

int WebServer::Implementation::OnViewer(lws* socket, lws_callback_reasons reason, Connection& connection,
                                        const char* in, std::size_t length) {
  switch (reason) {
    case LWS_CALLBACK_ESTABLISHED: {
      connection.viewer = ++last_viewer_;
      viewers_[connection.viewer].socket = socket;
      handler_->OnOpened(*this, connection.viewer, lws_get_protocol(socket)->name);
      lws_callback_on_writable(socket);
      return 0;
    }
    case LWS_CALLBACK_CLOSED:
      if (viewers_.erase(connection.viewer) > 0) handler_->OnClosed(*this, connection.viewer);
      return 0;
    case LWS_CALLBACK_RECEIVE:
      return Receive(socket, connection, {in, length});
    default:
      return WritePiece(socket, connection);
  }
}

int WebServer::Implementation::Receive(lws* socket, Connection& connection, std::string_view part) {
  ViewerConnection& viewer = viewers_[connection.viewer];
  if (viewer.refusal) return 0;
  std::string& message = viewer.message_start;
  const bool is_binary = lws_frame_is_binary(socket) != 0;
  if (is_binary && std::strcmp(lws_get_protocol(socket)->name, kProtocols[0]) == 0) {
    return RefuseViewer(socket, viewer, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE);
  }
  // The announced rest of the frame counts before it is read.
  if (message.size() + part.size() + lws_remaining_packet_payload(socket) > options_.longest_text) {
    return RefuseViewer(socket, viewer, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE);
  }
  message.append(part);
  if (lws_is_final_fragment(socket) == 0 || lws_remaining_packet_payload(socket) > 0) return 0;
  const std::string whole = std::exchange(message, {});
  if (handler_->OnMessage(*this, connection.viewer, whole, !is_binary)) return 0;
  return RefuseViewer(socket, viewer, LWS_CLOSE_STATUS_POLICY_VIOLATION);
}

// Not at once: lws closes a connection without a close frame while a part of a message waits for the socket. WritePiece
// is called when none does. A viewer that does not read is disconnected after kRequestSeconds.
int WebServer::Implementation::RefuseViewer(lws* socket, ViewerConnection& viewer, lws_close_status status) {
  viewer.refusal = status;
  viewer.message_start.clear();
  lws_set_timeout(socket, PENDING_TIMEOUT_CLOSE_SEND, kRequestSeconds);
  lws_callback_on_writable(socket);
  return 0;
}

// A viewer that does not read is not asked for its next message: lws calls this when its socket can take more.
int WebServer::Implementation::WritePiece(lws* socket, Connection& connection) {
  ViewerConnection& viewer = viewers_[connection.viewer];
  if (viewer.refusal) {
    if (std::exchange(viewer.is_closing, true)) return 0;
    lws_close_reason(socket, *viewer.refusal, nullptr, 0);
    return -1;
  }
  if (!viewer.message) {
    viewer.message = handler_->NextMessage(connection.viewer);
    viewer.sent = 0;
    if (!viewer.message) return 0;
  }
  const std::string& content = *viewer.message->content;
  const std::size_t count = std::min(content.size() - viewer.sent, kPiece);
  std::memcpy(piece_.data() + LWS_PRE, content.data() + viewer.sent, count);
  const bool last = viewer.sent + count == content.size();
  const int flags =
      lws_write_ws_flags(viewer.message->is_text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY, viewer.sent == 0, last ? 1 : 0);
  if (lws_write(socket, piece_.data() + LWS_PRE, count, static_cast<lws_write_protocol>(flags)) < 0) return -1;
  viewer.sent += count;
  if (last) viewer.message.reset();
  lws_callback_on_writable(socket);
  return 0;
}

Result<std::unique_ptr<WebServer>> WebServer::Create(const Options& options) {
  auto implementation = std::make_unique<Implementation>(options);
  if (Status failure = implementation->Listen(); !failure.ok()) return failure.error();
  return std::unique_ptr<WebServer>(new WebServer(std::move(implementation)));
}

WebServer::WebServer(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const {
  return implementation_->port();
}

void WebServer::Serve(WebHandler& handler) {
  implementation_->Serve(handler);
}

void WebServer::Stop() {
  implementation_->Stop();
}

void WebServer::Wake() {
  implementation_->Wake();
}

}  // namespace troupe
