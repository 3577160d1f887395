// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>

#include "delfront/errors.hpp"
#include "support/support.hpp"
#include "view/job_progress.hpp"
#include "view/page_server.hpp"

namespace delfront {
namespace {

TEST(ParseRequest, takes_method_target_and_host) {
  const auto request = parse_request("GET /a/b?c HTTP/1.1\r\nUser-Agent: x\r\nHOST:  127.0.0.1:80 \r\nX: host: y");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->target, "/a/b?c");
  EXPECT_EQ(request->host, "127.0.0.1:80");
}

TEST(ParseRequest, refuses_what_is_no_request) {
  for (const char* head : {"", " ", "GET", "GET /", "GET / HTTP/2\r\nHost: a", "GET  HTTP/1.1\r\nHost: a",
                           "GET / HTTP/1.1", "GET / HTTP/1.1\r\nHost: a\r\nHost: b", "GET / / HTTP/1.1\r\nHost: a",
                           "GET http://a/ HTTP/1.1\r\nHost: a", "\r\n\r\nGET / HTTP/1.1\r\nHost: a"})
    EXPECT_FALSE(parse_request(head)) << head;
}

class AnswerRequest : public ::testing::Test {
 protected:
  int ask(const std::string& target, const std::string& host = "127.0.0.1:4000") {
    response_ = answer_request(served_, {"GET", target, host});
    return response_.status;
  }
  std::string token_ = make_token();
  Served served_{token_, 4000, "page", std::make_shared<const std::string>("grid"), nullptr};
  Response response_;
};

TEST_F(AnswerRequest, serves_the_page_and_the_grid) {
  EXPECT_EQ(ask("/" + token_ + "/"), 200);
  EXPECT_EQ(*response_.body, "page");
  EXPECT_EQ(ask("/" + token_ + "/grid", "localhost:4000"), 200);
  EXPECT_EQ(*response_.body, "grid");
  EXPECT_EQ(ask("/" + token_ + "/progress"), 200);
  EXPECT_EQ(*response_.body, "null");  // there is no job
}

TEST_F(AnswerRequest, without_the_token_all_is_forbidden) {
  std::string other = token_;
  other.back() = other.back() == '0' ? '1' : '0';
  for (const std::string& target :
       {std::string("/"), std::string("/grid"), "/" + other + "/", "/" + token_.substr(1) + "/", "/" + token_ + "0/",
        std::string("//"), "/../" + token_ + "/", "/%2e%2e/" + token_ + "/", "/?" + token_})
    EXPECT_EQ(ask(target), 403) << target;
}

TEST_F(AnswerRequest, no_path_leads_out) {
  for (const char* path :
       {"..", "../", "../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "..%2f..%2fetc%2fpasswd", "/etc/passwd",
        "grid/../../etc/passwd", "grid?x", "./grid", "index.html", "..\\..\\etc\\passwd"})
    EXPECT_EQ(ask("/" + token_ + "/" + path), 404) << path;
  EXPECT_EQ(ask("/" + token_), 404);
}

TEST_F(AnswerRequest, another_host_is_forbidden) {
  for (const char* host : {"", "127.0.0.1", "127.0.0.1:4001", "evil.example:4000", "evil.example",
                           "127.0.0.1:4000.evil.example", "localhost", "0.0.0.0:4000", "[::1]:4000"})
    EXPECT_EQ(ask("/" + token_ + "/", host), 403) << host;
}

TEST(MakeToken, gives_128_bits_and_never_the_same) {
  const std::string a = make_token(), b = make_token();
  EXPECT_EQ(a.size(), 32u);
  EXPECT_EQ(a.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(a, b);
}

TEST(JobProgress, follows_a_file_that_grows) {
  const std::string path = (fixtures::scratch_folder() / "run.jsonl").string();
  JobProgress job(path);
  job.update();
  EXPECT_FALSE(job.state()["has_begun"]);
  std::ofstream file(path);
  file << R"({"event":"progress","stage":"read","done":1,"total":2,"unit":"files","seconds":0.1})"
       << "\n"
       << R"({"event":"progress","stage":"read","done":2,"to)" << std::flush;
  job.update();
  EXPECT_EQ(job.state()["stages"].size(), 1u);
  EXPECT_EQ(job.state()["stages"][0]["done"], 1);
  file << R"(tal":2,"unit":"files","seconds":0.2})"
       << "\nno json\n{\"a\":1}\n[]\n"
       << R"({"event":"log","level":"warning","message":"thin"})"
       << "\n"
       << R"({"event":"error","exit_code":4,"message":"no way"})"
       << "\n"
       << std::flush;
  job.update();
  EXPECT_EQ(job.state()["stages"].size(), 1u);
  EXPECT_EQ(job.state()["stages"][0]["done"], 2);
  EXPECT_EQ(job.state()["messages"][0]["message"], "thin");
  EXPECT_EQ(job.state()["error"]["message"], "no way");
  EXPECT_TRUE(job.state()["has_ended"]);
}

}  // namespace
}  // namespace delfront
