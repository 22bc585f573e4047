// SPDX-License-Identifier: Apache-2.0
#include "live/service.h"

#include <algorithm>

#include "nonio/workbench/page.h"
#include "platform/storage/digest.h"

namespace nonio::live {

std::optional<std::string> Request::query(std::string_view name) const {
  const auto values = query_of(head.target);
  if (!values) return std::nullopt;
  for (const auto& [key, value] : *values)
    if (key == name) return value;
  return std::nullopt;
}

Answer refused(int status, const std::string& name,
               std::vector<std::pair<std::string, std::string>> places) {
  Answer out;
  out.status = status;
  out.said = {"refused." + name, std::move(places)};
  return out;
}

std::string Sentences::operator()(const Said& said) const {
  const auto found = all_.find(said.name);
  const std::string& text = found == all_.end() ? said.name : found->second;
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    const std::size_t close = text.find('}', open);
    out += text.substr(at, open - at);
    if (close == std::string::npos) {
      out += text.substr(open);
      break;
    }
    const std::string name = text.substr(open + 1, close - open - 1);
    const auto place = std::find_if(said.places.begin(), said.places.end(),
                                    [&](const auto& one) { return one.first == name; });
    out += place == said.places.end() ? text.substr(open, close + 1 - open) : place->second;
    at = close + 1;
  }
  return out;
}

Answer Sentences::spelled(Answer answer) const {
  if (answer.said.name.empty()) return answer;
  storage::Json json = {{"error", (*this)(answer.said)},
                        {"id", answer.said.name.substr(answer.said.name.find('.') + 1)},
                        {"status", answer.status}};
  if (!answer.body.empty()) json.update(storage::parse(answer.body));
  Answer out{answer.status, "application/json", storage::dump_line(json)};
  out.headers = std::move(answer.headers);
  return out;
}

Answer json_answer(int status, const storage::Json& json) {
  return {status, "application/json", storage::dump_line(json)};
}

Answer refusal(int status, const std::string& words) {
  const storage::Json json = {{"error", words}, {"status", status}, {"lang", "en"}};
  return {status, "application/json", storage::dump_line(json)};
}

std::vector<Route> shell_routes() {
  std::vector<Route> routes;
  for (const char* path : {"/", "/app.js", "/app.css", "/site.js", "/site.css"})
    routes.push_back({Method::get, path, true});
  return routes;
}

Answer shell_file(const Request& request, const std::string& shell) {
  const std::string& path = request.route.path;
  Answer out;
  const std::pair<const char*, std::string_view> files[] = {{"/app.js", workbench::app_js()},
                                                            {"/app.css", workbench::app_css()},
                                                            {"/site.js", workbench::site_js()},
                                                            {"/site.css", workbench::site_css()}};
  const auto file = std::find_if(std::begin(files), std::end(files),
                                 [&](const auto& one) { return path == one.first; });
  if (file != std::end(files)) {
    out.type = path.ends_with(".js") ? "text/javascript; charset=utf-8" : "text/css; charset=utf-8";
    out.body = file->second;
  } else if (path.ends_with('/')) {
    out.type = "text/html; charset=utf-8";
    out.body = shell;
  } else {
    return refused(404, "nothing");
  }
  const std::string tag = "\"" + storage::sha256(out.body).substr(0, 32) + "\"";
  out.headers = {{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (request.head.first("If-None-Match") == tag) {
    out.status = 304;
    out.body.clear();
  }
  return out;
}

}  // namespace nonio::live
