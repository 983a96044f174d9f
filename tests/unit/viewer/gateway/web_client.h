// WebClient: a client of a web server on this host that sends any bytes, also wrong ones.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::test {

inline constexpr int kWebDeadline = 20'000;  // ms, for anything that happens at once

struct WebFrame {
  int opcode = 0;  // 1: text, 2: binary, 8: close
  std::string content;

  // The status of a close frame.
  int close_status() const {
    if (opcode != 8 || content.size() < 2) return 0;
    return static_cast<unsigned char>(content[0]) << 8 | static_cast<unsigned char>(content[1]);
  }
};

class WebClient {
 public:
  explicit WebClient(std::uint16_t port) : port_(port), socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~WebClient() { close(socket_); }
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  // Ends this side of the connection.
  void EndSending() { shutdown(socket_, SHUT_WR); }

  bool connected() const { return connected_; }
  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }

  // False once the server has closed the connection.
  bool Send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  // The head of the response to a request.
  std::string Get(const std::string& path, const std::string& headers) {
    Send("GET " + path + " HTTP/1.1\r\n" + headers + "\r\n");
    return ReadHead();
  }
  std::string Get(const std::string& path) { return Get(path, "Host: " + host() + "\r\n"); }

  static std::string UpgradeHeaders(const std::string& host, const std::string& origin,
                                    const std::string& protocol = "troupe") {
    return "Host: " + host + "\r\nOrigin: " + origin +
           "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
           "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: " +
           protocol + "\r\n";
  }
  // Becomes a viewer.
  void Upgrade(const std::string& path = "/socket") {
    const std::string head = Get(path, UpgradeHeaders(host(), "http://" + host()));
    ASSERT_TRUE(head.starts_with("HTTP/1.1 101")) << head;
  }

  // Up to the empty line; less if the server closes the connection before.
  std::string ReadHead() {
    while (input_.find("\r\n\r\n") == std::string::npos && ReadMore()) continue;
    const std::size_t end = std::min(input_.find("\r\n\r\n"), input_.size());
    std::string head = input_.substr(0, end);
    input_.erase(0, std::min(end + 4, input_.size()));
    return head;
  }

  // All that the server sends until it closes the connection; nothing if it does not.
  std::optional<std::string> ReadAll() {
    while (ReadMore()) continue;
    if (!closed_) return std::nullopt;
    return input_;
  }

  // A masked frame. The mask is zero: the bytes are sent as they are.
  static std::string Frame(int first_byte, std::string_view content, std::optional<std::uint64_t> claimed = {}) {
    const std::uint64_t length = claimed.value_or(content.size());
    std::string frame(1, static_cast<char>(first_byte));
    if (length < 126) {
      frame += static_cast<char>(0x80 | length);
    } else if (length < 65536) {
      frame += static_cast<char>(0x80 | 126);
      for (int shift = 8; shift >= 0; shift -= 8) frame += static_cast<char>(length >> shift & 0xff);
    } else {
      frame += static_cast<char>(0x80 | 127);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(length >> shift & 0xff);
    }
    return frame + std::string(4, '\0') + std::string(content);
  }
  bool SendText(std::string_view text) { return Send(Frame(0x81, text)); }

  // The next message of the server, with its fragments joined, or its close frame; nothing if the connection ends, or
  // after the deadline.
  std::optional<WebFrame> Read() {
    WebFrame message;
    for (;;) {
      const std::optional<WebFrame> part = ReadFrame();
      if (!part) return std::nullopt;
      if ((part->opcode & 0xf) == 9) continue;                           // a ping
      if ((part->opcode & 0xf) == 8) return WebFrame{8, part->content};  // also between two fragments
      if ((part->opcode & 0xf) != 0) message.opcode = part->opcode & 0xf;
      message.content += part->content;
      if ((part->opcode & 0x80) != 0) return message;
    }
  }

 private:
  bool Fill(std::size_t count) {
    while (input_.size() < count && ReadMore()) continue;
    return input_.size() >= count;
  }

  bool ReadMore() {
    pollfd waited = {socket_, POLLIN, 0};
    if (poll(&waited, 1, kWebDeadline) != 1) return false;
    char bytes[65536];
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    closed_ = count <= 0;
    if (closed_) return false;
    input_.append(bytes, static_cast<std::size_t>(count));
    return true;
  }

  std::optional<WebFrame> ReadFrame() {
    if (!Fill(2)) return std::nullopt;
    std::size_t head = 2;
    std::uint64_t length = static_cast<unsigned char>(input_[1]) & 0x7f;
    if (length >= 126) {
      const std::size_t bytes = length == 126 ? 2 : 8;
      if (!Fill(head + bytes)) return std::nullopt;
      length = 0;
      for (std::size_t i = 0; i < bytes; ++i) length = length << 8 | static_cast<unsigned char>(input_[head + i]);
      head += bytes;
    }
    if (!Fill(head + length)) return std::nullopt;
    WebFrame frame{static_cast<unsigned char>(input_[0]), input_.substr(head, length)};
    input_.erase(0, head + length);
    return frame;
  }

  const std::uint16_t port_;
  const int socket_;
  bool connected_ = false;
  bool closed_ = false;
  std::string input_;
};

}  // namespace troupe::test
