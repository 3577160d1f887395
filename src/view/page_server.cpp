// SPDX-License-Identifier: Apache-2.0
#include "view/page_server.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

/// In a time that does not tell how much of it is right.
bool is_same(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

Response found(const std::shared_ptr<const std::string>& body, const char* type) {
  if (!body) return {404, "text/plain; charset=utf-8", nullptr};
  return {200, type, body};
}

}  // namespace

std::string make_token() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
    throw IoError("the system gives no random numbers for the address of the page");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

Response answer_request(const Served& served, const Request& request) {
  const Response forbidden{403, "text/plain; charset=utf-8", nullptr};
  if (request.host != fmt::format("127.0.0.1:{}", served.port) &&
      request.host != fmt::format("localhost:{}", served.port))
    return forbidden;
  const std::string_view target = request.target;  // begins with '/'
  const std::size_t slash = target.find('/', 1);
  if (!is_same(target.substr(1, slash == std::string_view::npos ? slash : slash - 1), served.token)) return forbidden;
  const std::string_view path = slash == std::string_view::npos ? "?" : target.substr(slash + 1);
  if (path.empty()) return found(std::make_shared<const std::string>(served.page), "text/html; charset=utf-8");
  if (path == "grid") return found(served.grid, "application/octet-stream");
  if (path == "progress")
    return found(served.progress ? served.progress : std::make_shared<const std::string>("null"), "application/json");
  return {404, "text/plain; charset=utf-8", nullptr};
}

}  // namespace delfront
