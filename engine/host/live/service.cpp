// SPDX-License-Identifier: Apache-2.0
#include "host/live/service.h"

#include "host/storage/digest.h"
#include "host/storage/json_values.h"
#include "nonio/workbench/page.h"

namespace nonio::host::live {

std::optional<std::string> Request::query(std::string_view name) const {
  const auto values = query_of(head.target);
  if (!values) return std::nullopt;
  for (const auto& [key, value] : *values)
    if (key == name) return value;
  return std::nullopt;
}

Answer refusal(int status, const std::string& words) {
  const storage::Json json = {{"error", words}, {"status", status}};
  return {status, "application/json", storage::dump_line(json)};
}

std::vector<Route> shell_routes() {
  std::vector<Route> routes;
  for (const char* path : {"/", "/app.js", "/app.css", "/uplot.js", "/uplot.css"})
    routes.push_back({Method::get, path, true});
  return routes;
}

Answer shell_file(const Request& request, const std::string& shell) {
  const std::string& path = request.route.path;
  Answer out;
  if (path == "/app.js" || path == "/uplot.js") {
    out.type = "text/javascript; charset=utf-8";
    out.body = path == "/app.js" ? workbench::app_js() : workbench::uplot_js();
  } else if (path == "/app.css" || path == "/uplot.css") {
    out.type = "text/css; charset=utf-8";
    out.body = path == "/app.css" ? workbench::app_css() : workbench::uplot_css();
  } else if (path.ends_with('/')) {
    out.type = "text/html; charset=utf-8";
    out.body = shell;
  } else {
    return refusal(404, "there is nothing at this address");
  }
  const std::string tag = "\"" + storage::sha256(out.body).substr(0, 32) + "\"";
  out.headers = {{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (request.head.first("If-None-Match") == tag) {
    out.status = 304;
    out.body.clear();
  }
  return out;
}

}  // namespace nonio::host::live
