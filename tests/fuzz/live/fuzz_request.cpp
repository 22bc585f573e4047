// SPDX-License-Identifier: Apache-2.0
// Any bytes as a request to `nonio serve`: what the guard lets through, Poco reads as the guard did, and
// nothing is let through that lacks the token or is none of the routes.
#include <Poco/Net/HTTPRequest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>

#include "live/guard.h"

namespace {

using namespace nonio::live;

void must(bool holds, int line = __builtin_LINE()) {
  if (holds) return;
  std::cerr << "line " << line << " does not hold\n";
  std::abort();
}

const std::string token = "0123456789abcdef0123456789abcdef";

const std::vector<Route>& routes() {
  static const std::vector<Route> all{
      {Method::get, "/", true},
      {Method::get, "/c/{campaign}/", true},
      {Method::get, "/api/state"},
      {Method::get, "/site/results/{campaign}/{file}"},
      {Method::get, "/c/{campaign}/api/parts/{part}/fit"},
      {Method::post, "/api/model", false, false, "application/json"},
      {Method::post, "/api/ack", false, true, "application/json"},
      {Method::post, "/api/verify", false, false, "application/pdf application/xml",
       most_certificate}};
  return all;
}

/// The head as Poco reads it; ends the program if it cannot.
Head read_by_poco(const std::string& bytes) {
  std::istringstream stream(bytes);
  Poco::Net::HTTPRequest request;
  try {
    request.read(stream);
  } catch (const std::exception& e) {
    std::cerr << "Poco refuses what the guard lets through: " << e.what() << "\n" << bytes << "\n";
    std::abort();
  }
  Head head{request.getMethod(), request.getURI(), {}};
  for (const auto& [name, value] : request) head.fields.emplace_back(name, value);
  return head;
}

void check(const Head& head, bool edit) {
  const Post post{4711, token, {"nonio.example.org"}, false, edit};
  const Verdict verdict = judge(head, post, routes());
  if (verdict.status != 200) {
    must(verdict.status >= 400 && verdict.status < 500 && verdict.route == nullptr);
    must(verdict.said.name.starts_with("refused."));
    return;
  }
  must(verdict.route != nullptr);
  must(head.all("Host").size() == 1);
  must(verdict.route->open || head.all("X-Nonio-Token") == std::vector<std::string>{token});
  must(!verdict.route->writes || edit);
  must(head.method == (verdict.route->method == Method::get ? "GET" : "POST"));
  must(head.target.size() <= most_target && head.fields.size() <= most_fields);
  const auto names = std::count(verdict.route->path.begin(), verdict.route->path.end(), '{');
  must(static_cast<std::size_t>(names) == verdict.names.size());
  for (const std::string& name : verdict.names)
    must(!name.empty() && name.find('\0') == std::string::npos);
  if (const auto query = query_of(head.target))
    for (const auto& [name, value] : *query)
      must(!name.empty() && value.find('\0') == std::string::npos);
  must(head.all("Content-Length").size() + head.all("Transfer-Encoding").size() <= 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::string_view head = all.substr(0, std::min(all.find("\r\n\r\n"), all.find("\n\n")));
  const int status = head_status(head);
  must(status == 200 || status == 400 || status == 414 || status == 431);
  if (status == 200) {
    // As it ended, or as it would have.
    const std::string end(head.size() < all.size()
                              ? all.substr(head.size(), all[head.size()] == '\r' ? 4 : 2)
                          : head.ends_with('\r') ? "\n\r\n"
                                                 : "\r\n\r\n");
    const Head read = read_by_poco(std::string(head) + end);
    check(read, false);
    check(read, true);
  }
  if (const auto text = percent_decoded(all)) must(text->size() <= all.size());
  return 0;
}
