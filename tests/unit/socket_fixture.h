// SPDX-License-Identifier: Apache-2.0
// Sockets for tests of servers: raw bytes over TCP, WebSocket frames, and waiting for events. Timeouts are generous: a
// test fails by what it receives, not by the duration.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "live/net/websocket.h"

namespace fourdvt::live {

constexpr int kPatience = 60;  // timeout, s

// Values that one thread appends and another waits for.
template <class T>
class Log {
 public:
  void add(T value) {
    const std::lock_guard lock(mutex_);
    values_.push_back(std::move(value));
    changed_.notify_all();
  }
  bool waitFor(size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(kPatience), [&] { return values_.size() >= count; });
  }
  bool waitUntil(const std::function<bool(const std::vector<T>&)>& condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(kPatience), [&] { return condition(values_); });
  }
  std::vector<T> values() {
    const std::lock_guard lock(mutex_);
    return values_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> values_;
};

inline bool eventually(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kPatience);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    usleep(2000);
  }
  return true;
}

class RawSocket {
 public:
  explicit RawSocket(uint16_t port, int receive_bytes = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience{kPatience, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (receive_bytes > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
  }
  ~RawSocket() { close(socket_); }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  void send(const std::string& bytes) {
    for (size_t sent = 0; sent < bytes.size();) {
      const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;  // the peer has closed
      sent += static_cast<size_t>(count);
    }
  }
  // Receives until the peer closes, or until `end` has arrived.
  std::string receive(const std::string& end = {}) {
    std::string out;
    while (end.empty() || out.find(end) == std::string::npos) {
      char piece[4096];
      const ssize_t count = recv(socket_, piece, end.empty() ? sizeof piece : 1, 0);
      if (count <= 0) break;
      out.append(piece, static_cast<size_t>(count));
    }
    return out;
  }
  std::string receiveBytes(size_t count) {
    std::string out(count, '\0');
    return out.substr(0, static_cast<size_t>(std::max<ssize_t>(recv(socket_, out.data(), count, MSG_WAITALL), 0)));
  }
  // Payload of the server's next frame; for a close frame, its code and reason; "": connection lost.
  std::string receiveFrame(int* opcode = nullptr) {
    const std::string head = receiveBytes(2);
    if (head.size() < 2) return {};
    if (opcode) *opcode = head[0] & 15;
    size_t bytes = head[1] & 127;
    if (bytes >= 126) {
      const size_t digits = bytes == 126 ? 2 : 8;
      bytes = 0;
      for (const char c : receiveBytes(digits)) bytes = bytes * 256 + static_cast<uint8_t>(c);
    }
    return receiveBytes(bytes);
  }
  // Code of the server's close frame; closes this side without answering it. 0: connection lost.
  int receiveClose() {
    int opcode = 0, code = 0;
    for (std::string payload = "-"; opcode != 8 && !payload.empty();) {
      payload = receiveFrame(&opcode);
      if (opcode == 8 && payload.size() >= 2)
        code = static_cast<uint8_t>(payload[0]) * 256 + static_cast<uint8_t>(payload[1]);
    }
    shutdown(socket_, SHUT_WR);
    return code;
  }

 private:
  int socket_;
};

// Sends a request with additional header lines, each with its line end; returns the answer's status. 0: no answer.
inline std::string ask(uint16_t port, const std::string& line, const std::string& fields = {}) {
  RawSocket socket(port);
  const std::string host = fields.find("Host:") == std::string::npos ? "Host: 127.0.0.1\r\n" : "";
  socket.send(line + " HTTP/1.1\r\n" + host + fields + "Connection: close\r\n\r\n");
  return socket.receive();
}
inline int statusOf(const std::string& answer) { return answer.size() > 12 ? std::atoi(answer.c_str() + 9) : 0; }
inline std::string bodyOf(const std::string& answer) {
  const size_t at = answer.find("\r\n\r\n");
  return at == std::string::npos ? "" : answer.substr(at + 4);
}

inline std::string upgradeRequest(const std::string& target, const std::string& fields = {}) {
  const std::string host = fields.find("Host:") == std::string::npos ? "Host: 127.0.0.1\r\n" : "";
  return "GET " + target + " HTTP/1.1\r\n" + host +
         "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
         fields + "\r\n";
}

// Complete client frame, masked with zeros. opcode: 1 text, 2 binary, 8 close, 9 ping.
inline std::string clientFrame(const std::string& payload, int opcode = 2) {
  std::string out(1, static_cast<char>(0x80 | opcode));
  const size_t digits = payload.size() < 126 ? 0 : payload.size() < 65536 ? 2 : 8;
  out += static_cast<char>(0x80 | (digits == 0 ? payload.size() : digits == 2 ? 126 : 127));
  for (size_t i = digits; i > 0; --i) out += static_cast<char>(static_cast<uint64_t>(payload.size()) >> (8 * (i - 1)));
  return out + std::string(4, '\0') + payload;
}

inline Bytes bytesOf(const std::string& text) {
  return std::make_shared<std::vector<uint8_t>>(text.begin(), text.end());
}
inline std::string textOf(std::span<const uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

// Client that logs its events.
struct LoggedClient {
  Log<std::string> messages, closes;
  Log<bool> opens;
  std::unique_ptr<Client> client;
  std::atomic<bool> refused{false};

  explicit LoggedClient(const std::string& url, const std::string& token = {}, const std::string& ca_file = {}) {
    ClientOptions options;
    options.url = url;
    options.token = token;
    options.ca_file = ca_file;
    options.longest_pause_s = 0.2;
    ClientEvents events;
    events.on_open = [this] { opens.add(true); };
    events.on_message = [this](std::span<const uint8_t> bytes, bool) { messages.add(textOf(bytes)); };
    events.on_close = [this](const std::string& reason, bool is_refused) {
      if (is_refused) refused = true;
      closes.add(reason);
    };
    auto started = Client::start(options, std::move(events));
    EXPECT_TRUE(started.ok());
    if (started.ok()) client = started.take();
  }
  ~LoggedClient() { client.reset(); }
};

}  // namespace fourdvt::live
