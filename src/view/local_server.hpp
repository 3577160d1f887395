// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace delfront {

/// @brief The first line and the Host of an HTTP request; no more is looked at.
struct Request {
  std::string method, target, host;
};

/// @brief Parse what stands before the empty line.
/// @return nothing where it is no HTTP/1.x request, or does not have exactly one Host
std::optional<Request> parse_request(std::string_view head);

struct Response {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body;  ///< null: a sentence about the status
};

/// @brief A small HTTP server for one person on this machine: 127.0.0.1 only, GET and HEAD only, one answer a
/// connection.
///
/// One thread; slow clients hold up nobody, silent ones are dropped after some seconds, requests over 16 kB refused.
class LocalServer {
 public:
  using Handler = std::function<Response(const Request&)>;

  /// @param port  0: any free one
  /// @throws IoError  the port cannot be had
  LocalServer(int port, Handler handler);
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  int port() const { return port_; }
  /// @brief Serve until `stop`. @param on_idle  called some five times a second
  void run(const std::atomic<bool>& stop, const std::function<void()>& on_idle);

 private:
  struct Connection;
  void serve_once(int wait_ms);
  void accept_all();
  void receive(Connection& connection);
  void answer(Connection& connection, std::string_view head);
  void send_some(Connection& connection);

  int socket_ = -1, port_ = 0;
  Handler handler_;
  std::vector<std::unique_ptr<Connection>> connections_;
};

}  // namespace delfront
