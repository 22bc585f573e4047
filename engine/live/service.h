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

/// Interface between HTTP and the actions of the user. A Request has passed the checks of the
/// guard.
namespace nonio::live {

struct Request {
  const Head& head;
  const Route& route;
  const std::vector<std::string>& names;
  std::string body;
  bool may_write = true;  ///< whether the role of the user allows changes

  /// Returns the first value of this name in the query; std::nullopt if it is missing or the query
  /// is malformed.
  std::optional<std::string> query(std::string_view name) const;
};

struct Answer {
  int status = 200;
  std::string type = "application/json", body;
  std::vector<std::pair<std::string, std::string>> headers{};
  /// Reason of a rejection; `body` may contain additional members.
  Said said{};
  std::shared_ptr<Listener> stream{};  ///< events instead of a body
  Events* events = nullptr;            ///< source of the events in `stream`
  /// Called once per second; false ends the stream, because the session of the user has ended.
  std::function<bool()> may_go_on{};
};

/// Returns a rejection with the sentence "refused." + `name`; `Sentences::spelled` makes the body
/// {"error": sentence, "id": name, "status": status}.
Answer refused(int status, const std::string& name,
               std::vector<std::pair<std::string, std::string>> places = {});
/// Returns a rejection with a text made by the caller.
Answer refusal(int status, const std::string& words);

Answer json_answer(int status, const storage::Json& json);

/// Sentences of the page in the language of the site, by name.
class Sentences {
 public:
  explicit Sentences(std::map<std::string, std::string> all) : all_(std::move(all)) {}
  /// Inserts the values of the placeholders. Returns the name if there is no such sentence.
  std::string operator()(const Said& said) const;
  /// Writes the sentence of a rejection into its JSON body; other answers are unchanged.
  Answer spelled(Answer answer) const;

 private:
  std::map<std::string, std::string> all_;
};

class Service {
 public:
  virtual ~Service() = default;
  virtual const std::vector<Route>& routes() const = 0;
  virtual Answer answer(const Request& request) = 0;
  /// Returns a rejection before the body is read if the user is unknown. A service without users
  /// rejects nothing.
  virtual std::optional<Answer> before_body(const Head&, const Route&) { return std::nullopt; }
  virtual const Sentences& sentences() const = 0;
  /// Whether requests have a session instead of a token.
  virtual bool signs_in() const { return false; }
  virtual void close() = 0;
};

/// Returns the routes of the files of the page, which contain no data.
std::vector<Route> shell_routes();
/// Returns a file of the page; for a path that ends with "/" the page `shell`. Status 404 if there
/// is no such file. Handles If-None-Match.
Answer shell_file(const Request& request, const std::string& shell);

}  // namespace nonio::live
