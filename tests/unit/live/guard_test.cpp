// SPDX-License-Identifier: Apache-2.0
#include "live/guard.h"

#include <gtest/gtest.h>

#include <random>

#include "live/service.h"

namespace guard_test {

using namespace nonio::live;

namespace {

const std::string token = "0123456789abcdef0123456789abcdef";

Post post() { return {4711, token, {"nonio.example.org", "proxy.example:8443"}, false, false}; }

std::vector<Route> routes() {
  return {{Method::get, "/", true, false, ""},
          {Method::get, "/api/state", false, false, ""},
          {Method::get, "/api/parts/{part}/fit", false, false, ""},
          {Method::post, "/api/model", false, false, "application/json"},
          {Method::post, "/api/save", false, true, "application/json"},
          {Method::post, "/api/verify", false, false, "application/pdf application/xml",
           most_certificate}};
}

Head good(const std::string& method = "GET", const std::string& target = "/api/state") {
  Head head{method, target, {{"Host", "127.0.0.1:4711"}, {"X-Nonio-Token", token}}};
  if (method == "POST") {
    head.fields.emplace_back("Content-Type", "application/json");
    head.fields.emplace_back("Content-Length", "2");
  }
  return head;
}

Head with(Head head, const std::string& name, const std::string& value) {
  for (auto& [field, old] : head.fields)
    if (field == name) {
      old = value;
      return head;
    }
  head.fields.emplace_back(name, value);
  return head;
}

int status(const Head& head, const Post& who = post()) {
  static const std::vector<Route> all = routes();
  return judge(head, who, all).status;
}

struct Case {
  const char *name, *value;
  int status;
};

}  // namespace

TEST(LiveGuard, HostsAndOrigins) {
  const Case cases[] = {
      {"Host", "127.0.0.1:4711", 200},
      {"Host", "localhost:4711", 200},
      {"Host", "LOCALHOST:4711", 200},
      {"Host", "localhost.:4711", 200},
      {"Host", "nonio.example.org", 200},
      {"Host", "Nonio.Example.ORG.", 200},
      {"Host", "nonio.example.org:443", 200},
      {"Host", "nonio.example.org:80", 200},
      {"Host", "proxy.example:8443", 200},
      {"Host", "proxy.example", 421},
      {"Host", "proxy.example:443", 421},
      {"Host", "nonio.example.org:4711", 421},
      {"Host", "", 421},
      {"Host", "127.0.0.1", 421},
      {"Host", "127.0.0.1:", 421},
      {"Host", "127.0.0.1:04711", 421},
      {"Host", "127.0.0.1:4712", 421},
      {"Host", "127.0.0.1:47110", 421},
      {"Host", "127.0.0.1:999999", 421},
      {"Host", "127.0.0.1.:4711", 421},
      {"Host", "[::1]:4711", 421},
      {"Host", "[::1", 421},
      {"Host", "evil.example", 421},
      {"Host", "evil.example:4711", 421},
      {"Host", "127.0.0.1:4711@evil.example", 421},
      {"Host", "evil.example#127.0.0.1:4711", 421},
      {"Host", "127.0.0.1:4711, evil.example", 421},
      {"Host", "127.0.0.1.evil.example:4711", 421},
      {"Origin", "http://127.0.0.1:4711", 200},
      {"Origin", "http://localhost:4711", 200},
      {"Origin", "https://nonio.example.org", 200},
      {"Origin", "http://nonio.example.org", 200},
      {"Origin", "https://proxy.example:8443", 200},
      {"Origin", "https://127.0.0.1:4711", 403},
      {"Origin", "http://127.0.0.1", 403},
      {"Origin", "http://127.0.0.1:4712", 403},
      {"Origin", "null", 403},
      {"Origin", "", 403},
      {"Origin", "ftp://127.0.0.1:4711", 403},
      {"Origin", "http://evil.example", 403},
      {"Origin", "http://127.0.0.1:4711/", 403},
      {"Sec-Fetch-Site", "same-origin", 200},
      {"Sec-Fetch-Site", "none", 200},
      {"Sec-Fetch-Site", "same-site", 403},
      {"Sec-Fetch-Site", "cross-site", 403},
      {"Sec-Fetch-Site", "", 403},
  };
  for (const Case& one : cases)
    EXPECT_EQ(status(with(good(), one.name, one.value)), one.status)
        << one.name << ": " << one.value;
}

TEST(LiveGuard, Ipv6OnlyWhereItIsBound) {
  Post both = post();
  both.ipv6 = true;
  EXPECT_EQ(status(with(good(), "Host", "[::1]:4711"), both), 200);
  EXPECT_EQ(status(with(good(), "Host", "[::1]"), both), 421);
  EXPECT_EQ(status(with(good(), "Host", "[::2]:4711"), both), 421);
}

TEST(LiveGuard, PortMayBeLeftOutWhereItIsTheUsualOne) {
  Post usual = post();
  usual.port = 80;
  EXPECT_EQ(status(with(good(), "Host", "127.0.0.1"), usual), 200);
  EXPECT_EQ(status(with(good(), "Host", "127.0.0.1:80"), usual), 200);
  EXPECT_EQ(status(with(with(good(), "Host", "localhost"), "Origin", "http://localhost"), usual),
            200);
}

TEST(LiveGuard, NamesOfFieldsHaveNoCase) {
  Head head = good();
  head.fields = {{"hOsT", "127.0.0.1:4711"}, {"x-nonio-TOKEN", token}};
  EXPECT_EQ(status(head), 200);
  head.fields.emplace_back("HOST", "127.0.0.1:4711");
  EXPECT_EQ(status(head), 421);
}

TEST(LiveGuard, TokenDecidesBeforeThePathIsLookedUp) {
  for (const char* path : {"/api/state", "/api/none", "/etc/passwd", "/api/model"}) {
    Head head = good("GET", path);
    head.fields.pop_back();
    EXPECT_EQ(status(head), 403) << path;
  }
  EXPECT_EQ(status(with(good(), "X-Nonio-Token", token.substr(1))), 403);
  EXPECT_EQ(status(with(good(), "X-Nonio-Token", token + "0")), 403);
  EXPECT_EQ(status(with(good(), "X-Nonio-Token", "")), 403);
  Head twice = good();
  twice.fields.emplace_back("X-Nonio-Token", token);
  EXPECT_EQ(status(twice), 403);
  Post none = post();
  none.token.clear();
  EXPECT_EQ(status(with(good(), "X-Nonio-Token", ""), none), 403);
  Head shell = good("GET", "/");
  shell.fields.pop_back();
  EXPECT_EQ(status(shell), 200);
}

TEST(LiveGuard, RefusalsSayWhatToDo) {
  const auto all = routes();
  const auto said = [&](const Head& head) { return judge(head, post(), all).said; };
  EXPECT_EQ(said(with(good(), "Host", "x")).name, "refused.host");
  EXPECT_NE(said(with(good(), "Host", "x")).places.at(0).second.find("http://127.0.0.1:4711/"),
            std::string::npos);
  EXPECT_EQ(said(with(good(), "X-Nonio-Token", "x")).name, "refused.token");
  EXPECT_TRUE(said(with(good(), "X-Nonio-Token", "x")).places.empty());
  EXPECT_EQ(said(good("POST", "/api/save")).name, "refused.read_only");
}

TEST(LiveGuard, ARefusalIsSpelledInTheWordsOfTheSite) {
  const Sentences sentences(
      std::map<std::string, std::string>{{"refused.part", "Kein Teil {part}, {other}, {part} {"}});
  const Answer answer = sentences.spelled(refused(404, "part", {{"part", "X {part}"}}));
  EXPECT_EQ(answer.status, 404);
  EXPECT_EQ(answer.body,
            R"({"error":"Kein Teil X {part}, {other}, X {part} {","id":"part","status":404})");
  EXPECT_EQ(sentences(Said{"refused.none"}), "refused.none");
  EXPECT_EQ(sentences.spelled(refusal(422, "as it is")).body,
            R"({"error":"as it is","status":422,"lang":"en"})");
}

TEST(LiveGuard, AHeadIsReadOnlyIfEverybodyReadsTheSame) {
  const std::string line = "GET /api/state?since=1 HTTP/1.1\r\n";
  for (const char* good_head : {"Host: a\r\nX-Nonio-Token: b", "Host:a", "A: b\tc", "A:"})
    EXPECT_EQ(head_status(line + good_head), 200) << good_head;
  for (const char* bad : {"Host : a", " Host: a", "Host: a\r\n folded: b", "Host", ": a", "A: \x01",
                          "A: b\rC: d", "A: \x7f", "\xc3\xa4: b"})
    EXPECT_EQ(head_status(line + bad), 400) << bad;
  EXPECT_EQ(head_status(line + "A: " + std::string(1, '\0')), 400);
  for (const char* bad : {"", "GET", "GET /", "GET / HTTP/2", "GET / HTTP/1.1 x", "GET  / HTTP/1.1",
                          " GET / HTTP/1.1", "G\x01T / HTTP/1.1", "GET /\x7f HTTP/1.1", "\r\n",
                          "GET / http/1.1", "GET /\xc3\xa4 HTTP/1.1"})
    EXPECT_EQ(head_status(bad), 400) << bad;
  EXPECT_EQ(head_status(std::string(33, 'G') + " / HTTP/1.1"), 400);
  EXPECT_EQ(head_status("GET /" + std::string(most_target, 'a') + " HTTP/1.1"), 414);
  std::string many = line;
  for (std::size_t i = 0; i <= most_fields; ++i) many += "A: b\r\n";
  EXPECT_EQ(head_status(many), 431);
  EXPECT_EQ(head_status(std::string(most_head + 1, 'a')), 431);
}

TEST(LiveGuard, MethodsAndPaths) {
  EXPECT_EQ(status(good("OPTIONS")), 405);
  EXPECT_EQ(status(good("HEAD")), 405);
  EXPECT_EQ(status(good("get")), 405);
  EXPECT_EQ(status(good("POST", "/api/state")), 405);
  EXPECT_EQ(status(good("GET", "/api/model")), 405);
  for (const char* path : {"/api", "/api/", "/api/state/", "//api/state", "/api/parts//fit",
                           "/api/parts/%00/fit", "/api/parts/%2/fit", "/api/parts/a/b/fit", "",
                           "http://127.0.0.1:4711/api/state", "/api/state%00"})
    EXPECT_EQ(status(good("GET", path)), 404) << path;
  EXPECT_EQ(status(good("GET", "/api/state?since=3")), 200);
  const auto all = routes();
  const Verdict found = judge(good("GET", "/api/parts/XY%2000/fit"), post(), all);
  ASSERT_EQ(found.status, 200);
  EXPECT_EQ(found.names, std::vector<std::string>{"XY 00"});
}

TEST(LiveGuard, WritingNeedsEdit) {
  EXPECT_EQ(status(good("POST", "/api/save")), 403);
  Post edit = post();
  edit.edit = true;
  EXPECT_EQ(status(good("POST", "/api/save"), edit), 200);
  EXPECT_EQ(status(good("POST", "/api/model")), 200);
}

TEST(LiveGuard, Sizes) {
  EXPECT_EQ(status(good("GET", "/api/state?" + std::string(most_target, 'x'))), 414);
  EXPECT_EQ(status(with(good(), "X-Much", std::string(most_head, 'x'))), 431);
  Head many = good();
  for (std::size_t i = 0; i < most_fields; ++i) many.fields.emplace_back("X", "1");
  EXPECT_EQ(status(many), 431);
  const Case lengths[] = {{"Content-Length", "1048576", 200},
                          {"Content-Length", "1048577", 413},
                          {"Content-Length", "99999999999999999999999", 413},
                          {"Content-Length", "-1", 400},
                          {"Content-Length", "2x", 400},
                          {"Content-Length", "", 400},
                          {"Transfer-Encoding", "chunked", 400},
                          {"Content-Type", "application/json; charset=utf-8", 200},
                          {"Content-Type", "text/plain", 415},
                          {"Content-Type", "", 415}};
  for (const Case& one : lengths)
    EXPECT_EQ(status(with(good("POST", "/api/model"), one.name, one.value)), one.status)
        << one.name << ": " << one.value;
  Head pdf = with(good("POST", "/api/verify"), "Content-Type", "application/pdf");
  EXPECT_EQ(status(with(pdf, "Content-Length", "20000000")), 200);
  EXPECT_EQ(status(with(pdf, "Content-Length", "40000000")), 413);
  EXPECT_EQ(status(with(good(), "Content-Length", "2")), 400);
}

TEST(LiveGuard, SecretsAreComparedWhole) {
  EXPECT_TRUE(same_secret("", ""));
  EXPECT_TRUE(same_secret("abc", "abc"));
  EXPECT_FALSE(same_secret("abc", "abd"));
  EXPECT_FALSE(same_secret("abc", "ab"));
  EXPECT_FALSE(same_secret("", "a"));
  EXPECT_FALSE(same_secret(std::string("a\0", 2), "a"));
}

TEST(LiveGuard, Queries) {
  const auto query = query_of("/x?a=1&b=%20c&d");
  ASSERT_TRUE(query);
  ASSERT_EQ(query->size(), 3U);
  EXPECT_EQ((*query)[1].second, " c");
  EXPECT_EQ((*query)[2].second, "");
  EXPECT_FALSE(query_of("/x?a=%g0"));
  EXPECT_FALSE(query_of("/x?=1"));
  EXPECT_TRUE(query_of("/x")->empty());
}

/// Whatever comes: a status of the list, and never through without the token.
TEST(LiveGuard, HostileHeads) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<std::string> pieces{"GET",
                                        "POST",
                                        "/api/state",
                                        "/",
                                        "%",
                                        "%41",
                                        "?",
                                        "Host",
                                        "Origin",
                                        "127.0.0.1:4711",
                                        ":",
                                        "[",
                                        "]",
                                        token.substr(0, 31),
                                        std::string("\0x", 2),
                                        "{part}",
                                        "/api/parts/",
                                        "fit",
                                        "chunked",
                                        std::string(300, 'a')};
  const auto text = [&] {
    std::string out;
    for (auto n = random() % 4; n > 0; --n) out += pieces[random() % pieces.size()];
    return out;
  };
  const auto all = routes();
  for (int i = 0; i < 20000; ++i) {
    Head head{random() % 2 == 0 ? "GET" : text(), random() % 2 == 0 ? "/api/state" : text(), {}};
    if (random() % 2 == 0) head.fields.emplace_back("Host", "127.0.0.1:4711");
    for (auto n = random() % 5; n > 0; --n) head.fields.emplace_back(text(), text());
    const Verdict v = judge(head, post(), all);
    EXPECT_TRUE(v.status != 200 || v.route->open);
  }
}

}  // namespace guard_test
