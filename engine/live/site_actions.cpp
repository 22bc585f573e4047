// SPDX-License-Identifier: Apache-2.0
#include "certificates/certificate_list.h"
#include "certificates/users.h"
#include "live/site_service.h"
#include "platform/storage/files.h"

namespace nonio::live {
namespace fs = std::filesystem;
using storage::Json;

namespace {

/// Missing members are skipped.
void add_options(std::vector<std::string>& arguments, const Json& body,
                 std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (body.contains(name))
      arguments.push_back(verb_option(name, body.at(name).get<std::string>()));
}

}  // namespace

Answer SiteService::acknowledge(const Json& body) {
  std::vector<std::string> arguments{"machine", "ack", "--json"};
  if (body.value("withdraw", false)) arguments.emplace_back("--withdraw");
  add_options(
      arguments, body,
      {"finding", "machine", "axis", "quantity", "until", "value", "U", "by", "why", "date"});
  // Without a finding the command would only list acknowledgements.
  if (!body.contains("finding")) return refused(400, "body_form", {{"path", "/api/ack"}});
  arguments.push_back(wish_.folder.string());
  return entered(arguments);
}

Answer SiteService::event(const Json& body) {
  std::vector<std::string> arguments{"machine", "event", "--json"};
  add_options(arguments, body, {"machine", "axis", "kind", "text", "date", "by"});
  if (!body.contains("kind")) return refused(400, "body_form", {{"path", "/api/event"}});
  arguments.push_back(wish_.folder.string());
  return entered(arguments);
}

namespace {

constexpr std::size_t longest_account = 200;

/// Whether the request came through the TLS proxy: its origin is https, or its host is not this
/// computer.
bool is_by_proxy(const Head& head) {
  const std::string host = head.first("Host");
  if (head.first("Origin").starts_with("https:")) return true;
  return !host.starts_with("127.0.0.1") && !host.starts_with("localhost");
}

bool is_same_name(const std::string& one, const std::string& other) {
  return certificates::likeness_of(one) == certificates::likeness_of(other);
}

}  // namespace

Answer SiteService::begin_session(const Request& request) {
  const Json body = storage::parse_once(request.body);
  const auto text = [&](const char* name) {
    return body.is_object() && body.contains(name) && body[name].is_string()
               ? body[name].get<std::string>()
               : std::string();
  };
  const std::string account = text("account");
  if (account.empty() || account.size() > longest_account)
    return refused(400, "body_form", {{"path", "/api/sign-in"}});
  const auto users = certificates::read_users(wish_.folder);
  if (!users) return refused(503, "users");
  const auto user = certificates::user_with(*users, account);
  const auto checked = sign_in_.check(account, text("password"), user);
  if (checked.wait_s > 0)
    return refused(429, "wait", {{"seconds", std::to_string(checked.wait_s)}});
  if (!audit_.write({{"account", account},
                     {"request", "/api/sign-in"},
                     {"state", checked.fits ? "done" : "refused"}}))
    return refused(503, "audit");
  if (!checked.fits) return refused(403, "password");
  const auto cookie = sign_in_.begin(*user, is_by_proxy(request.head));
  if (!cookie) return refusal(503, cookie.error().message);
  Answer out = json_answer(200, {{"version", version_.load()}});
  out.headers.emplace_back("Set-Cookie", *cookie);
  return out;
}

Answer SiteService::end_session(const Request& request, const User& user) {
  // The session ends even if this cannot be recorded.
  const std::string cookie = sign_in_.end(request.head);
  if (!audit_.write({{"account", user.account},
                     {"name", user.name},
                     {"request", "/api/sign-out"},
                     {"state", "done"}}))
    return refused(503, "audit");
  Answer out = json_answer(200, {{"version", version_.load()}});
  out.headers.emplace_back("Set-Cookie", cookie);
  return out;
}

/// A user with a password must repeat it, and the command takes the name from users.toml. A user of
/// a proxy without a password must type the name, which is no authentication: if the site requires
/// two persons, the request is rejected.
Answer SiteService::release(const Json& body, const User* user) {
  const auto folder = folder_of(body.at("campaign").get<std::string>());
  if (!folder)
    return refused(404, "no_campaign", {{"campaign", body["campaign"].get<std::string>()}});
  std::vector<std::string> arguments{"certificate", "approve", "--json"};
  std::string password;
  if (user != nullptr && !user->password.empty()) {
    password = body.value("password", "");
    const auto checked = sign_in_.check(user->account, password, *user, true);
    if (checked.wait_s > 0)
      return refused(429, "wait", {{"seconds", std::to_string(checked.wait_s)}});
    if (!checked.fits) return refused(403, "password");
    arguments.push_back(verb_option("user", user->account));
  } else {
    if (user != nullptr) {
      const auto numbering = certificates::numbering_of(wish_.folder);
      if (!numbering) return refusal(503, numbering.error().message);
      if (numbering->two_persons) return refused(403, "two_persons", {{"account", user->account}});
      if (!is_same_name(body.value("confirmed", ""), user->name)) return refused(403, "name");
    }
    arguments.push_back(verb_option("by", body.at("by").get<std::string>()));
  }
  add_options(arguments, body, {"as"});
  const Json reasons = body.value("reasons", Json::object());
  for (const auto& [finding, why] : reasons.items())
    arguments.push_back(verb_option("reason", finding + "=" + why.get<std::string>()));
  arguments.push_back((wish_.folder / *folder).string());
  Answer out = entered(with_places(std::move(arguments)), password);
  campaigns_->index().look_at(*folder);
  return out;
}

Answer SiteService::mail(const Json& body) {
  const fs::path file =
      result_file(body.at("campaign").get<std::string>(), body.at("file").get<std::string>());
  if (file.empty()) return refused(404, "no_result");
  std::vector<std::string> arguments{"certificate", "send", "--json",
                                     verb_option("site", wish_.folder.string())};
  add_options(arguments, body, {"to"});
  arguments.push_back(file.string());
  return of_verb(arguments);
}

Answer SiteService::verify(const Request& request) {
  const std::string type = request.head.first("Content-Type");
  const std::string name = type.find("pdf") != std::string::npos   ? "certificate.pdf"
                           : type.find("xml") != std::string::npos ? "certificate.xml"
                                                                   : "certificate.json";
  const storage::ScratchFolder folder("live");
  if (folder.path().empty()) return refused(503, "no_scratch");
  if (const auto kept = storage::publish(folder.path(), {{name, request.body}}); !kept)
    return refusal(503, kept.error().message);
  return of_verb(
      with_places({"certificate", "verify", "--json", verb_option("site", wish_.folder.string()),
                   (folder.path() / name).string()}));
}

/// Starts `nonio run` for `campaign` alone (--only), otherwise for all changed campaigns. The first
/// run of a site includes all campaigns in any case.
Answer SiteService::run(const Json& body) {
  if (wish_.out.empty()) return refused(409, "no_out");
  std::vector<std::string> arguments{"run", verb_option("out", wish_.out.string())};
  std::string id, of_one;
  if (body.contains("campaign")) {
    const auto folder = folder_of(body["campaign"].get<std::string>());
    if (!folder)
      return refused(404, "no_campaign", {{"campaign", body["campaign"].get<std::string>()}});
    id = id_of(*folder);
    of_one = *folder;
    if (news_->run().last != 0) arguments.push_back(verb_option("only", *folder));
  }
  arguments.push_back(wish_.folder.string());
  const std::string command = command_line(arguments);
  arguments.emplace_back("--json");
  const auto begun = run_->begin(with_places(std::move(arguments)), command, id);
  if (!begun) return refusal(503, begun.error().message);
  if (!*begun) return refused(409, "run_at_work");
  {
    const std::lock_guard lock(mutex_);
    run_folder_ = of_one;
  }
  tell("run");
  return json_answer(202, {{"version", version_.load()}, {"command", command}});
}

}  // namespace nonio::live
