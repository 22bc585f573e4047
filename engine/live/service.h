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

/// Between HTTP and what a person does: requests that the guard let through, answers.
namespace nonio::live {

struct Request {
  const Head& head;
  const Route& route;
  const std::vector<std::string>& names;  ///< what stands for the names in the route's path
  std::string body;
  bool may_write = true;  ///< the user's role allows it

  /// A value of the query; none if it is missing.
  std::optional<std::string> query(std::string_view name) const;
};

struct Answer {
  int status = 200;
  std::string type = "application/json", body;
  std::vector<std::pair<std::string, std::string>> headers{};
  Said said{};                         ///< why it is refused; `body`: more members, or nothing
  std::shared_ptr<Listener> stream{};  ///< instead of a body: events until one side ends
  Events* events = nullptr;            ///< of the stream
  std::function<bool()> may_go_on{};   ///< asked once a second: the stream ends with its user
};

/// {"error": sentence, "id": name, "status": status}; `name` without "refused." in front.
Answer refused(int status, const std::string& name,
               std::vector<std::pair<std::string, std::string>> places = {});
/// The same with a sentence that the caller has made.
Answer refusal(int status, const std::string& words);

/// A value as JSON.
Answer json_answer(int status, const storage::Json& json);

/// Sentences of the page in the language of the site, by their names.
class Sentences {
 public:
  explicit Sentences(std::map<std::string, std::string> all) : all_(std::move(all)) {}
  /// Its name if there is none.
  std::string operator()(const Said& said) const;
  /// The answer with its refusal as a body.
  Answer spelled(Answer answer) const;

 private:
  std::map<std::string, std::string> all_;
};

class Service {
 public:
  virtual ~Service() = default;
  virtual const std::vector<Route>& routes() const = 0;
  virtual Answer answer(const Request& request) = 0;
  /// A refusal that needs no body: of whoever is not signed in.
  virtual std::optional<Answer> before_body(const Head&, const Route&) { return std::nullopt; }
  /// For what is refused.
  virtual const Sentences& sentences() const = 0;
  /// Requests have a session in place of the token.
  virtual bool signs_in() const { return false; }
  /// All streams end; nothing is begun any more.
  virtual void close() = 0;
};

/// The page's own files, which have no data.
std::vector<Route> shell_routes();
/// One of them, with the words of a language in the shell; status 404 if it is none. Answers
/// If-None-Match.
Answer shell_file(const Request& request, const std::string& shell);

}  // namespace nonio::live
