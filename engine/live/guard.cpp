// SPDX-License-Identifier: Apache-2.0
#include "live/guard.h"

#include <algorithm>
#include <charconv>

namespace nonio::live {

namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

Verdict denied(int status, std::string name,
               std::vector<std::pair<std::string, std::string>> places = {}) {
  return {status, {"refused." + std::move(name), std::move(places)}};
}

struct Authority {
  std::string name, port;  ///< without ":"; the port may be empty
};

/// Parses "NAME:PORT", "[::1]:PORT" or "NAME"; std::nullopt for other texts.
std::optional<Authority> authority_of(std::string_view text) {
  if (text.empty() || text.find_first_of("@/\\ \t,%?#") != std::string_view::npos)
    return std::nullopt;
  const std::size_t bracket = text.front() == '[' ? text.find(']') : 0;
  if (bracket == std::string_view::npos) return std::nullopt;
  const std::size_t colon = text.find(':', bracket);
  Authority out{lower(text.substr(0, colon)), ""};
  if (colon != std::string_view::npos) {
    out.port = text.substr(colon + 1);
    if (out.port.empty() || out.port.size() > 5 ||
        out.port.find_first_not_of("0123456789") != std::string::npos)
      return std::nullopt;
  }
  // A name may end with a dot, but an address may not.
  if (out.name.size() > 1 && out.name.back() == '.' &&
      out.name.find_first_not_of("0123456789.") != std::string::npos)
    out.name.pop_back();
  return out;
}

/// Whether the authority is this server or a host of --host. `scheme` is that of an Origin header,
/// in which the default port is omitted; empty for a Host header.
bool is_ours(std::string_view text, const Post& post, std::string_view scheme) {
  const auto given = authority_of(text);
  if (!given) return false;
  const std::string port = std::to_string(post.port);
  const bool own_port = given->port == port || (given->port.empty() && post.port == 80);
  if (scheme != "https" && own_port &&
      (given->name == "127.0.0.1" || given->name == "localhost" ||
       (post.ipv6 && given->name == "[::1]")))
    return true;
  return std::any_of(post.hosts.begin(), post.hosts.end(), [&](const std::string& host) {
    const auto allowed = authority_of(host);
    if (!allowed || allowed->name != given->name) return false;
    if (given->port == allowed->port) return true;
    // The proxy uses the default port of http or https, which may be omitted.
    const std::string usual = scheme == "http" ? "80" : "443";
    return (allowed->port.empty() && (given->port == usual || given->port == "80")) ||
           (given->port.empty() && allowed->port == usual);
  });
}

bool is_our_origin(std::string_view origin, const Post& post) {
  for (const std::string_view scheme : {"http", "https"}) {
    const std::string begin = std::string(scheme) + "://";
    if (origin.starts_with(begin)) return is_ours(origin.substr(begin.size()), post, scheme);
  }
  return false;
}

std::string known_addresses(const Post& post) {
  std::string out = address_of(post);
  for (const std::string& host : post.hosts) out += ", https://" + host + "/";
  return out;
}

Verdict judge_size(const Head& head) {
  if (head.target.size() > most_target)
    return denied(414, "target", {{"most", std::to_string(most_target)}});
  std::size_t size = head.method.size() + head.target.size() + 12;
  for (const auto& [name, value] : head.fields) size += name.size() + value.size() + 4;
  if (size > most_head || head.fields.size() > most_fields)
    return denied(431, "head",
                  {{"fields", std::to_string(most_fields)}, {"bytes", std::to_string(most_head)}});
  return {};
}

Verdict judge_sender(const Head& head, const Post& post) {
  const auto hosts = head.all("Host");
  if (hosts.size() != 1 || !is_ours(hosts.front(), post, ""))
    return denied(421, "host", {{"address", known_addresses(post)}});
  for (const std::string& site : head.all("Sec-Fetch-Site"))
    if (site != "same-origin" && site != "none") return denied(403, "site");
  for (const std::string& origin : head.all("Origin"))
    if (!is_our_origin(origin, post)) return denied(403, "origin");
  return {};
}

bool is_name_step(std::string_view step) { return step.starts_with('{') && step.ends_with('}'); }

bool fits(std::string_view path, std::string_view pattern, std::vector<std::string>& names) {
  names.clear();
  while (true) {
    const std::size_t a = path.find('/', 1), b = pattern.find('/', 1);
    const std::string_view step = path.substr(0, a), wanted = pattern.substr(0, b);
    if (wanted.size() > 1 && is_name_step(wanted.substr(1))) {
      auto name = percent_decoded(step.substr(std::min<std::size_t>(1, step.size())));
      if (!name || name->empty()) return false;
      names.push_back(std::move(*name));
    } else if (step != wanted) {
      return false;
    }
    if (a == std::string_view::npos || b == std::string_view::npos)
      return (a == std::string_view::npos) == (b == std::string_view::npos);
    path.remove_prefix(a);
    pattern.remove_prefix(b);
  }
}

/// The status distinguishes a wrong path from a wrong method.
Verdict route_of(const Head& head, const std::vector<Route>& routes) {
  Verdict out;
  const std::string_view path =
      std::string_view(head.target).substr(0, head.target.find_first_of("?#"));
  bool other_method = false;
  for (const Route& route : routes) {
    if (!fits(path, route.path, out.names)) continue;
    if (head.method == (route.method == Method::get ? "GET" : "POST")) {
      out.route = &route;
      return out;
    }
    other_method = true;
  }
  out.names.clear();
  if (other_method) return denied(405, "method", {{"method", head.method.substr(0, 16)}});
  return denied(404, "nothing");
}

bool is_one_of(std::string_view type, std::string_view all) {
  while (!all.empty()) {
    const std::size_t end = std::min(all.find(' '), all.size());
    if (all.substr(0, end) == type) return true;
    all.remove_prefix(std::min(end + 1, all.size()));
  }
  return false;
}

Verdict judge_body(const Head& head, const Route& route) {
  const auto lengths = head.all("Content-Length");
  const auto codings = head.all("Transfer-Encoding");
  if (lengths.size() > 1 || codings.size() > 1 || (!lengths.empty() && !codings.empty()) ||
      (!codings.empty() && lower(codings.front()) != "chunked"))
    return denied(400, "length");
  std::uint64_t length = 0;
  if (!lengths.empty()) {
    const std::string& text = lengths.front();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
    if (error == std::errc::result_out_of_range)
      return denied(413, "body", {{"most", std::to_string(route.most)}});
    if (error != std::errc() || end != text.data() + text.size()) return denied(400, "length");
  }
  if (route.method == Method::get)
    return length == 0 && codings.empty() ? Verdict{} : denied(400, "get_body");
  if (length > route.most) return denied(413, "body", {{"most", std::to_string(route.most)}});
  const std::string type = head.first("Content-Type");
  if (!is_one_of(lower(type.substr(0, type.find(';'))), route.body))
    return denied(415, "type", {{"type", route.body}});
  return {};
}

/// Whether the text is a token (RFC 9110, 5.6.2).
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

int request_line_status(std::string_view line) {
  constexpr std::size_t longest_method = 32;
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return 400;
  const std::string_view method = line.substr(0, first), version = line.substr(last + 1),
                         target = line.substr(first + 1, last - first - 1);
  const bool plain =
      std::all_of(target.begin(), target.end(), [](char c) { return c > ' ' && c < '\x7f'; });
  if (!is_token(method) || method.size() > longest_method || target.empty() || !plain ||
      (version != "HTTP/1.1" && version != "HTTP/1.0"))
    return 400;
  return target.size() > most_target ? 414 : 200;
}

/// Lengths are limited to those that Poco accepts.
bool is_field(std::string_view line) {
  constexpr std::size_t longest_name = 200, longest_value = 8000;
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return false;
  const std::string_view value = line.substr(colon + 1);
  return colon <= longest_name && value.size() <= longest_value &&
         std::all_of(value.begin(), value.end(), [](char c) {
           return c == '\t' || (static_cast<unsigned char>(c) >= ' ' && c != '\x7f');
         });
}

}  // namespace

int head_status(std::string_view bytes) {
  if (bytes.size() > most_head) return 431;
  int status = 400;
  for (std::size_t lines = 0; !bytes.empty(); ++lines) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    // The last line has no LF, because the bytes end at its CR.
    if (end < bytes.size() && line.ends_with('\r')) line.remove_suffix(1);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    status = lines == 0 ? request_line_status(line) : is_field(line) ? 200 : 400;
    if (lines > most_fields) status = 431;
    if (status != 200) return status;
  }
  return status;
}

std::vector<std::string> Head::all(std::string_view name) const {
  std::vector<std::string> out;
  const std::string wanted = lower(name);
  for (const auto& [field, value] : fields)
    if (lower(field) == wanted) out.push_back(value);
  return out;
}

std::string Head::first(std::string_view name) const {
  const auto found = all(name);
  return found.empty() ? std::string() : found.front();
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned code = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const char* const begin = text.data() + i + 1;
    const auto [end, error] = std::from_chars(begin, begin + 2, code, 16);
    if (error != std::errc() || end != begin + 2 || code == 0) return std::nullopt;
    out += static_cast<char>(code);
    i += 2;
  }
  return out;
}

std::optional<std::vector<std::pair<std::string, std::string>>> query_of(std::string_view target) {
  std::vector<std::pair<std::string, std::string>> out;
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return out;
  std::string_view rest = target.substr(mark + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view one = rest.substr(0, end);
    const std::size_t equals = std::min(one.find('='), one.size());
    auto name = percent_decoded(one.substr(0, equals));
    auto value = percent_decoded(one.substr(std::min(equals + 1, one.size())));
    if (!name || !value || name->empty()) return std::nullopt;
    out.emplace_back(std::move(*name), std::move(*value));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return out;
}

bool same_secret(std::string_view one, std::string_view other) {
  unsigned different = one.size() == other.size() ? 0U : 1U;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const char second = i < other.size() ? other[i] : '\0';
    different |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(second);
  }
  return different == 0;
}

std::string address_of(const Post& post) {
  return "http://127.0.0.1:" + std::to_string(post.port) + "/";
}

Verdict judge(const Head& head, const Post& post, const std::vector<Route>& routes) {
  if (Verdict v = judge_size(head); v.status != 200) return v;
  if (Verdict v = judge_sender(head, post); v.status != 200) return v;
  if (head.method != "GET" && head.method != "POST")
    return denied(405, "method", {{"method", head.method.substr(0, 16)}});
  Verdict found = route_of(head, routes);
  if (found.status == 200 && found.route->open) {
    if (Verdict v = judge_body(head, *found.route); v.status != 200) return v;
    return found;
  }
  // The token is checked before the path, so that a client without it cannot find out which paths
  // exist.
  std::vector<std::string> tokens = head.all("X-Nonio-Token");
  // Programs that collect metrics send the token in this header (RFC 6750).
  constexpr std::string_view bearer = "Bearer ";
  if (tokens.empty())
    for (const std::string& given : head.all("Authorization"))
      if (given.starts_with(bearer)) tokens.push_back(given.substr(bearer.size()));
  if (!post.sign_in &&
      (tokens.size() != 1 || post.token.empty() || !same_secret(tokens.front(), post.token)))
    return denied(403, "token");
  if (found.status != 200) return found;
  if (found.route->writes && !post.edit) return denied(403, "read_only");
  if (Verdict v = judge_body(head, *found.route); v.status != 200) return v;
  return found;
}

std::vector<std::pair<std::string, std::string>> security_headers() {
  return {{"Content-Security-Policy",
           "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
           "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
           "require-trusted-types-for 'script'; trusted-types 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"X-Frame-Options", "DENY"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cache-Control", "no-store"}};
}

}  // namespace nonio::live
