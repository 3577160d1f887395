// SPDX-License-Identifier: Apache-2.0
// Sockets that never block, and one poll() over all of them.
#include "view/local_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kLongestHead = 16384, kMostConnections = 64;
constexpr std::chrono::seconds kPatience{20};
constexpr int kTickMs = 200;
const char* const kEndOfHead = "\r\n\r\n";

const char* reason_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 431:
      return "Request Header Fields Too Large";
    default:
      return "Internal Server Error";
  }
}

bool is_host_line(std::string_view line) {
  if (line.size() < 5) return false;
  return std::equal(line.begin(), line.begin() + 5, "host:", [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + 32) : a) == b;
  });
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<Request> parse_request(std::string_view head) {
  const std::size_t end = head.find("\r\n");
  const std::string_view line = head.substr(0, end);
  const std::size_t first = line.find(' '), second = line.rfind(' ');
  if (first == std::string_view::npos || second == first || first == 0) return std::nullopt;
  if (!line.substr(second + 1).starts_with("HTTP/1.")) return std::nullopt;
  Request request{std::string(line.substr(0, first)), std::string(line.substr(first + 1, second - first - 1)), ""};
  if (request.target.empty() || request.target[0] != '/' || request.target.find(' ') != std::string::npos)
    return std::nullopt;
  int num_hosts = 0;
  for (std::size_t begin = end; begin != std::string_view::npos && begin + 2 < head.size();) {
    const std::size_t stop = head.find("\r\n", begin + 2);
    const std::string_view field = head.substr(begin + 2, stop == std::string_view::npos ? stop : stop - begin - 2);
    if (is_host_line(field)) {
      request.host = std::string(without_blanks(field.substr(5)));
      ++num_hosts;
    }
    begin = stop;
  }
  if (num_hosts != 1) return std::nullopt;
  return request;
}

struct LocalServer::Connection {
  explicit Connection(int s) : socket(s) {}
  ~Connection() { close(socket); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int socket;
  Clock::time_point last_heard = Clock::now();
  std::string received, head;               ///< head of the answer
  std::shared_ptr<const std::string> body;  ///< null with HEAD
  std::size_t sent = 0;                     ///< of head and body
  bool is_answering = false, is_done = false;
};

LocalServer::LocalServer(int port, Handler handler) : handler_(std::move(handler)) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (socket_ >= 0) setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (socket_ < 0 || bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(socket_, 16) != 0 ||
      getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const int error = errno;
    if (socket_ >= 0) close(socket_);
    throw IoError(fmt::format("cannot serve on 127.0.0.1, port {}: {}; leave out --port for any free one",
                              port == 0 ? std::string("any") : std::to_string(port), std::strerror(error)));
  }
  port_ = ntohs(address.sin_port);
}

LocalServer::~LocalServer() { close(socket_); }

void LocalServer::run(const std::atomic<bool>& stop, const std::function<void()>& on_idle) {
  for (Clock::time_point last; !stop;) {
    serve_once(kTickMs);
    if (Clock::now() - last < std::chrono::milliseconds(kTickMs)) continue;
    last = Clock::now();
    on_idle();
  }
}

void LocalServer::serve_once(int wait_ms) {
  std::vector<pollfd> waiting = {{socket_, POLLIN, 0}};
  for (const auto& c : connections_)
    waiting.push_back({c->socket, static_cast<short>(c->is_answering ? POLLOUT : POLLIN), 0});
  if (poll(waiting.data(), waiting.size(), wait_ms) < 0) return;  // a signal: the caller looks at `stop`
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    Connection& c = *connections_[i];
    if (waiting[i + 1].revents == 0) continue;
    if (c.is_answering)
      send_some(c);
    else
      receive(c);
  }
  if (waiting[0].revents != 0) accept_all();
  const Clock::time_point now = Clock::now();
  std::erase_if(connections_, [&](const auto& c) { return c->is_done || now - c->last_heard > kPatience; });
}

void LocalServer::accept_all() {
  for (;;) {
    const int client = accept4(socket_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (client < 0) return;
    if (connections_.size() >= kMostConnections) connections_.erase(connections_.begin());  // the oldest
    connections_.push_back(std::make_unique<Connection>(client));
  }
}

void LocalServer::receive(Connection& c) {
  char buffer[4096];
  const ssize_t size = recv(c.socket, buffer, sizeof buffer, 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) {
    c.is_done = true;
    return;
  }
  c.last_heard = Clock::now();
  c.received.append(buffer, static_cast<std::size_t>(size));
  const std::size_t end = c.received.find(kEndOfHead);
  if (end != std::string::npos || c.received.size() > kLongestHead)
    answer(c, std::string_view(c.received).substr(0, end));
}

void LocalServer::answer(Connection& c, std::string_view head) {
  const std::optional<Request> request = parse_request(head);
  Response response{400, "text/plain; charset=utf-8", nullptr};
  if (head.size() > kLongestHead)
    response.status = 431;
  else if (request && request->method != "GET" && request->method != "HEAD")
    response.status = 405;
  else if (request)
    response = handler_(*request);
  c.body =
      response.body
          ? response.body
          : std::make_shared<const std::string>(fmt::format("{} {}\n", response.status, reason_of(response.status)));
  c.head = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n{}\r\n",
      response.status, reason_of(response.status), response.type, c.body->size(),
      response.status == 405 ? "Allow: GET, HEAD\r\n" : "");
  if (request && request->method == "HEAD") c.body = nullptr;
  c.is_answering = true;
  c.last_heard = Clock::now();
  send_some(c);
}

void LocalServer::send_some(Connection& c) {
  const std::size_t body_size = c.body ? c.body->size() : 0;
  while (c.sent < c.head.size() + body_size) {
    const bool is_head = c.sent < c.head.size();
    const char* data = is_head ? c.head.data() + c.sent : c.body->data() + (c.sent - c.head.size());
    const std::size_t left = (is_head ? c.head.size() : c.head.size() + body_size) - c.sent;
    const ssize_t size = send(c.socket, data, left, MSG_NOSIGNAL);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (size <= 0) break;
    c.sent += static_cast<std::size_t>(size);
    c.last_heard = Clock::now();
  }
  shutdown(c.socket, SHUT_WR);
  c.is_done = true;
}

}  // namespace delfront
