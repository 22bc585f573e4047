// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/events.h"
#include "live/guard.h"
#include "platform/storage/json_values.h"

/// Interface between HTTP and the actions of a person. A Request has passed the checks of the
/// guard.
namespace nonio::live {

struct Request {
  const Head& head;
  const Route& route;
  const std::vector<std::string>& names;  ///< values of the placeholders in the route's path
  std::string body;
  bool may_write = true;  ///< whether the user's role allows changes

  /// Returns the first value with this name in the query; none if it is missing or the query is
  /// malformed.
  std::optional<std::string> query(std::string_view name) const;
};

struct Answer {
  int status = 200;
  std::string type = "application/json", body;
  std::vector<std::pair<std::string, std::string>> headers{};
  Said said{};                         ///< why the request is refused; `body` then contains
                                       ///< additional members, or nothing
  std::shared_ptr<Listener> stream{};  ///< events until one side closes the connection, instead of
                                       ///< a body
  Events* events = nullptr;            ///< source of the events in `stream`; null without a stream
  std::function<bool()> may_go_on{};   ///< called once per second: false ends the stream, because
                                       ///< the user's session has ended
};

/// Returns a refusal with the sentence "refused." + `name`. `Sentences::spelled` makes its body
/// from this: {"error": sentence, "id": name, "status": status}.
Answer refused(int status, const std::string& name,
               std::vector<std::pair<std::string, std::string>> places = {});
/// Returns a refusal with a text made by the caller.
Answer refusal(int status, const std::string& words);

/// Returns the value as a JSON answer.
Answer json_answer(int status, const storage::Json& json);

/// Sentences of the page in the language of the site, by name.
class Sentences {
 public:
  explicit Sentences(std::map<std::string, std::string> all) : all_(std::move(all)) {}
  /// Returns the sentence with the values of its placeholders; the name itself if there is no such
  /// sentence.
  std::string operator()(const Said& said) const;
  /// Writes the sentence of a refusal in the site's language into its JSON body; other answers are
  /// returned unchanged.
  Answer spelled(Answer answer) const;

 private:
  std::map<std::string, std::string> all_;
};

class Service {
 public:
  virtual ~Service() = default;
  virtual const std::vector<Route>& routes() const = 0;
  virtual Answer answer(const Request& request) = 0;
  /// Returns the refusal of a request before its body is read, if the user is not known; otherwise
  /// none. A service without users refuses nothing.
  virtual std::optional<Answer> before_body(const Head&, const Route&) { return std::nullopt; }
  /// Returns the sentences for refusals.
  virtual const Sentences& sentences() const = 0;
  /// Whether requests have a session instead of a token.
  virtual bool signs_in() const { return false; }
  /// Ends all streams and prevents new ones.
  virtual void close() = 0;
};

/// Returns the routes of the page's own files, which contain no data.
std::vector<Route> shell_routes();
/// Returns one of the page's own files; for a path that ends with "/", the page itself, which is
/// `shell`. Status 404 if there is no such file. Handles If-None-Match.
Answer shell_file(const Request& request, const std::string& shell);

}  // namespace nonio::live
