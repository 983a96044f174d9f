// WebServer: HTTP for the files of the page, and WebSockets for viewers, on libwebsockets. It knows nothing of the
// simulation.
//
// Bounds: kMaxConnections connections, of which kMaxViewers are viewers (a further one replaces the oldest that has not
// shown the token of the page); headers of kMaxHeaders; messages from a viewer as long as Options says; one message on
// its way to each viewer, in pieces of kPiece bytes. A connection that sends no request for kRequestSeconds, or does
// not answer a ping, is closed.
//
// Pieces, so that a world of many megabytes needs one buffer for all viewers and other connections are served between
// two of them. Messages are shared bytes, never changed after they are made.
//
// Threads: the handler is called on the server's own thread. Wake may be called on any thread. An exception of the
// handler ends the connection that caused it, and no other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "troupe/result.h"
#include "viewer/gateway/access.h"

namespace troupe {

// The files of the page. They are a part of the program.

struct PageFile {
  std::string_view path;  // of the URL: "/viewer.js"
  std::string_view type;  // of the content: "text/javascript"
  std::string_view content;
  bool compressed = false;  // with gzip
};

// Generated at the build (viewer/web/build.mjs). Without node it is a page that says so.
std::span<const PageFile> PageFiles();

// A message to a viewer. Viewers share its bytes.
struct WebMessage {
  std::shared_ptr<const std::string> content;
  bool is_text = false;
};

// A file that is made for one request.
struct WebDownload {
  std::string_view type;  // of the content, a constant
  std::shared_ptr<const std::string> content;
};

using ViewerId = std::uint64_t;  // of a connection; never used twice

// What a handler can do inside of its calls, and only there.
class WebLoop {
 public:
  // Calls NextMessage as soon as the viewer can receive one.
  virtual void RequestMessage(ViewerId viewer) = 0;
  // Seconds between two calls of OnPeriod; 0: none.
  virtual void SetPeriod(double seconds) = 0;

 protected:
  ~WebLoop() = default;
};

// The application behind the server. Calls come one at a time.
class WebHandler {
 public:
  virtual ~WebHandler() = default;
  // Someone with access loads the page, and will probably open a connection.
  virtual void OnPage() = 0;
  // The file at `path` of the URL, for a client with access; nothing: there is none.
  virtual std::optional<WebDownload> OnDownload(std::string_view path) {
    (void)path;
    return std::nullopt;
  }
  // `protocol`: one of WebServer::kProtocols.
  virtual void OnOpened(WebLoop& loop, ViewerId viewer, std::string_view protocol) = 0;
  virtual void OnClosed(WebLoop& loop, ViewerId viewer) = 0;
  // False closes the connection: the message is none that such a viewer sends. The page sends only text.
  virtual bool OnMessage(WebLoop& loop, ViewerId viewer, std::string_view message, bool is_text) = 0;
  // The viewer has received all messages before: the next one, if there is one already.
  virtual std::optional<WebMessage> NextMessage(ViewerId viewer) = 0;
  virtual void OnPeriod(WebLoop& loop) = 0;  // each period of SetPeriod
  virtual void OnWake(WebLoop& loop) = 0;    // after Wake
};

class WebServer {
 public:
  // The page's protocol, then the protocols of other programs (viewer/foxglove/protocol.h).
  static constexpr const char* kProtocols[] = {"troupe", "foxglove.sdk.v1", "foxglove.websocket.v1"};
  static constexpr int kMaxConnections = 100;
  static constexpr int kMaxViewers = 40;
  static constexpr int kMaxHeaders = 4096;                       // bytes
  static constexpr std::size_t kPiece = std::size_t{32} * 1024;  // bytes
  static constexpr int kRequestSeconds = 5;
  static constexpr int kPingSeconds = 10;    // of silence, until a ping
  static constexpr int kHangUpSeconds = 30;  // of silence

  struct Options {
    std::string address = "127.0.0.1";  // IPv4
    std::uint16_t port = 0;
    bool any_port = true;  // if the port is in use, another one
    AccessRules access;
    std::size_t longest_text = 8192;  // of a viewer, bytes
    std::span<const PageFile> files;
  };

  // Listens.
  static Result<std::unique_ptr<WebServer>> Create(const Options& options);
  ~WebServer();  // stops it
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;

  // Serves until Stop. REQUIRES: called once; the handler is valid until Stop has returned.
  void Serve(WebHandler& handler);
  // No handler call runs any more when it returns.
  void Stop();

  void Wake();

 private:
  class Implementation;
  explicit WebServer(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace troupe
