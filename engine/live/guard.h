// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Decides which requests the server of `nonio serve` accepts, as a pure function of the head of a
/// request. Attackers are web pages in the same browser (also under a name that now resolves to
/// 127.0.0.1) and other users of the host.
namespace nonio::live {

/// The head of a request; fields in their order, names as sent.
struct Head {
  std::string method, target;
  std::vector<std::pair<std::string, std::string>> fields;

  /// Returns the values of all fields with that name, in any case of letters.
  std::vector<std::string> all(std::string_view name) const;
  /// Returns the value of the first field with that name; empty if there is none.
  std::string first(std::string_view name) const;
};

/// Settings of the server that the checks depend on.
struct Post {
  std::uint16_t port = 0;
  std::string token;                 ///< secret token of 32 hexadecimal digits
  std::vector<std::string> hosts{};  ///< values of --host: "nonio.example.org",
                                     ///< "nonio.example.org:8443"
  bool ipv6 = false;                 ///< whether the server is also bound to [::1]
  bool edit = false;
  bool sign_in = false;  ///< whether requests have a session, which the service checks, instead of
                         ///< a token
};

/// Limits of the head: bytes, fields, bytes of the target.
inline constexpr std::size_t most_head = 16UL * 1024UL, most_fields = 64, most_target = 2048;
/// Limits of a body in bytes: in general, and for a certificate that is to be verified.
inline constexpr std::size_t most_body = 1 << 20, most_certificate = 32 << 20;

enum class Method { get, post };

/// A path with its method and requirements. `writes`: it changes a file of the user and needs
/// --edit.
struct Route {
  Method method = Method::get;
  std::string path;   ///< path, for example "/api/parts/{part}/fit"; a step in braces is a
                      ///< placeholder
  bool open = false;  ///< whether no token is needed: for files of the page itself, which contain
                      ///< no data
  bool writes = false;
  std::string body{};            ///< content types of a POST's body, separated by blanks
  std::size_t most = most_body;  ///< largest body in bytes
};

/// A sentence for a person: its name in words/<language>/workbench.toml or workbench-site.toml, and
/// the values of its {placeholders}.
struct Said {
  std::string name;
  std::vector<std::pair<std::string, std::string>> places{};
};

struct Verdict {
  int status = 200;  ///< HTTP status of the answer; 200: the request is accepted
  Said said{};       ///< what is wrong and what to do, if the status is not 200
  const Route* route = nullptr;
  std::vector<std::string> names{};  ///< values of the placeholders, percent-decoded
};

/// Returns 200 if these bytes, up to the empty line, are the head of a request exactly as RFC 9112
/// requires it, so that every reader interprets it alike: one blank between method, target and
/// version, no field on two lines, no blank before a colon, no control character. Otherwise 400;
/// 431 if it is too large, 414 if its target is.
int head_status(std::string_view bytes);

/// Returns the route, or the first check that failed. Order of the checks: size of the head (414,
/// 431), Host (421), Sec-Fetch-Site and Origin (403), method (405), token (403), path (404, 405),
/// --edit (403), announced length of the body (400, 413), content type (415). Open routes need
/// neither token nor --edit; with `sign_in`, no token is checked.
Verdict judge(const Head& head, const Post& post, const std::vector<Route>& routes);

/// Returns the address of the page without the token, for example "http://127.0.0.1:4711/".
std::string address_of(const Post& post);

/// Returns the headers that are sent with every answer.
std::vector<std::pair<std::string, std::string>> security_headers();

/// Returns whether two texts are equal; the duration of the comparison depends only on their
/// lengths.
bool same_secret(std::string_view one, std::string_view other);

/// Returns the names and values after "?", percent-decoded. None if the query is malformed.
std::optional<std::vector<std::pair<std::string, std::string>>> query_of(std::string_view target);
/// Decodes percent-encoded text: "%2F" becomes "/". None if a % is not followed by two digits, or
/// the result contains NUL.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace nonio::live
