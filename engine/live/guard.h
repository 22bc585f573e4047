// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Decides from the head of a request alone whether the server accepts it. Attackers are web pages
/// in the same browser (also under a name that resolves to 127.0.0.1) and other users of the host.
namespace nonio::live {

/// Fields are in the order and the spelling in which they were sent.
struct Head {
  std::string method, target;
  std::vector<std::pair<std::string, std::string>> fields;

  /// Names are compared in any case of letters.
  std::vector<std::string> all(std::string_view name) const;
  /// Returns the first value; empty if there is none.
  std::string first(std::string_view name) const;
};

/// Settings of the server for the checks.
struct Post {
  std::uint16_t port = 0;
  std::string token;  ///< 32 hexadecimal digits
  /// Values of --host, such as "nonio.example.org" or "nonio.example.org:8443".
  std::vector<std::string> hosts{};
  bool ipv6 = false;  ///< whether the server is also bound to [::1]
  bool edit = false;
  /// Whether requests have a session, which the service checks, instead of a token.
  bool sign_in = false;
};

/// Limits of the head: bytes, fields, bytes of the target.
inline constexpr std::size_t most_head = 16UL * 1024UL, most_fields = 64, most_target = 2048;
/// Limits of a body in bytes: usual, and of a certificate to be verified.
inline constexpr std::size_t most_body = 1 << 20, most_certificate = 32 << 20;

enum class Method { get, post };

/// A path with its method and requirements. `writes` means that it changes a file and needs --edit.
struct Route {
  Method method = Method::get;
  std::string path;   ///< for example "/api/parts/{part}/fit", with placeholders in braces
  bool open = false;  ///< whether no token is needed, for files of the page without data
  bool writes = false;
  std::string body{};            ///< content types of a POST body, separated by spaces
  std::size_t most = most_body;  ///< limit of the body, bytes
};

/// A sentence for the user: name in words/<language>/workbench.toml or workbench-site.toml, and
/// values of its {placeholders}.
struct Said {
  std::string name;
  std::vector<std::pair<std::string, std::string>> places{};
};

struct Verdict {
  int status = 200;  ///< HTTP status; 200 if the request is accepted
  Said said{};       ///< reason and action, unless the status is 200
  const Route* route = nullptr;
  std::vector<std::string> names{};  ///< values of the placeholders, percent-decoded
};

/// Returns 200 if the bytes, up to the empty line, are the head of a request exactly as required by
/// RFC 9112, so that every parser interprets it alike; 431 if it is too large, 414 if its target
/// is, otherwise 400.
int head_status(std::string_view bytes);

/// Returns the route, or the first failed check: size of the head (414, 431), Host (421),
/// Sec-Fetch-Site and Origin (403), method (405), token (403), path (404, 405), --edit (403),
/// length of the body (400, 413), content type (415). Open routes need neither token nor --edit;
/// `sign_in` replaces the token.
Verdict judge(const Head& head, const Post& post, const std::vector<Route>& routes);

/// Returns the address of the page without the token, such as "http://127.0.0.1:4711/".
std::string address_of(const Post& post);

/// Returns the headers of every answer.
std::vector<std::pair<std::string, std::string>> security_headers();

/// Compares two texts in a time that depends only on their lengths.
bool same_secret(std::string_view one, std::string_view other);

/// Returns the percent-decoded names and values after "?", or std::nullopt if the query is
/// malformed.
std::optional<std::vector<std::pair<std::string, std::string>>> query_of(std::string_view target);
/// Decodes "%2F" to "/". std::nullopt if two hexadecimal digits do not follow a %, or if the result
/// contains NUL.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace nonio::live
