// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Which requests the server of `nonio serve` accepts: a pure function over the head of a request.
/// Attackers are web pages in the same browser (also under a name that means 127.0.0.1 by now) and
/// other users of the machine.
namespace nonio::live {

/// The head of a request, fields in their order, names as they were sent.
struct Head {
  std::string method, target;
  std::vector<std::pair<std::string, std::string>> fields;

  /// Values of the fields of that name, whose case does not matter.
  std::vector<std::string> all(std::string_view name) const;
  /// The first of them; "" if there is none.
  std::string first(std::string_view name) const;
};

/// What the server is.
struct Post {
  std::uint16_t port = 0;
  std::string token;                 ///< 32 hexadecimal digits
  std::vector<std::string> hosts{};  ///< of --host: "nonio.example.org", "nonio.example.org:8443"
  bool ipv6 = false;                 ///< [::1] is bound
  bool edit = false;
  bool sign_in = false;  ///< requests have a session, which the service checks, and no token
};

/// Nothing of the head may be larger.
inline constexpr std::size_t most_head = 16UL * 1024UL, most_fields = 64, most_target = 2048;
/// Of a body, in bytes; of a certificate that is to be verified.
inline constexpr std::size_t most_body = 1 << 20, most_certificate = 32 << 20;

enum class Method { get, post };

/// What a path is for. `writes`: it changes a file of the user; only with --edit.
struct Route {
  Method method = Method::get;
  std::string path;   ///< "/api/parts/{part}/fit": one step may be a name
  bool open = false;  ///< without a token: the shell, which has no data
  bool writes = false;
  std::string body{};  ///< content type of a POST's body; several with blanks between them
  std::size_t most = most_body;  ///< bytes of it
};

/// A sentence for a person: its name in words/<language>/workbench.toml or workbench-site.toml, and
/// what stands for its {places}.
struct Said {
  std::string name;
  std::vector<std::pair<std::string, std::string>> places{};
};

struct Verdict {
  int status = 200;  ///< 200: go on
  Said said{};       ///< else what was wrong, and what to do
  const Route* route = nullptr;
  std::vector<std::string> names{};  ///< what stands for {part}, percent-decoded
};

/// 200 if these bytes, up to the empty line, are the head of a request as RFC 9112 requires it, so
/// that every reader reads it alike: one blank between method, target and version, no field on two
/// lines, no blank before a colon, no control character. 400 if not, 431 if it is too large, 414 if
/// its target is.
int head_status(std::string_view bytes);

/// The first thing that is wrong, or the route. Tests in this order: size of the head (414, 431),
/// Host (421), Sec-Fetch-Site and Origin (403), method (405), token (403), path (404, 405), --edit
/// (403), content type (415) and announced length of the body (413).
Verdict judge(const Head& head, const Post& post, const std::vector<Route>& routes);

/// The addresses under which the page can be opened, without token: "http://127.0.0.1:4711/".
std::string address_of(const Post& post);

/// Sent with every answer.
std::vector<std::pair<std::string, std::string>> security_headers();

/// Whether two texts are the same; the time depends on their lengths only.
bool same_secret(std::string_view one, std::string_view other);

/// What follows "?": names and values, percent-decoded. None if it is not well-formed.
std::optional<std::vector<std::pair<std::string, std::string>>> query_of(std::string_view target);
/// "%2F" as "/"; none where a % is not followed by two digits, or a NUL comes out.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace nonio::live
