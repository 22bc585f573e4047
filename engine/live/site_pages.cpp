// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/evaluation/record.h"
#include "live/site_service.h"
#include "platform/storage/files.h"
#include "platform/storage/packed_results.h"

namespace nonio::live {
namespace fs = std::filesystem;
using storage::Json;

ToolEnd SiteService::call(const std::vector<std::string>& arguments, const std::string& input) {
  const auto channel = launcher_.run(arguments, shells_.seconds, input);
  if (!channel) return {-1, "", channel.error().message};
  {
    const std::lock_guard lock(mutex_);
    if (over_) return {};
    channels_.insert(channel->get());
  }
  ToolEnd end = hear_tool(*channel, [](const std::string&) {});
  const std::lock_guard lock(mutex_);
  channels_.erase(channel->get());
  return end;
}

std::vector<std::string> SiteService::with_places(std::vector<std::string> arguments) const {
  for (const std::string& folder : wish_.plugin_paths)
    arguments.push_back(verb_option("plugin-path", folder));
  for (const std::string& folder : wish_.template_paths)
    arguments.push_back(verb_option("templates", folder));
  return arguments;
}

Answer SiteService::of_verb(const std::vector<std::string>& arguments, const std::string& input) {
  const ToolEnd end = call(arguments, input);
  return of_end(end, storage::parse_or_discard(end.out), command_line(arguments));
}

Answer SiteService::of_end(const ToolEnd& end, Json out, const std::string& command) {
  if (!out.is_object()) {
    out = {{"error", end.errors.empty() ? "it printed nothing" : end.errors},
           {"status", 422},
           {"lang", "en"}};
    out["command"] = command;
    return json_answer(422, out);
  }
  out["exit_status"] = end.status;
  out["command"] = command;
  if (!end.errors.empty()) out["words"] = end.errors;
  return json_answer(end.status == 2 ? 422 : 200, out);
}

Answer SiteService::entered(const std::vector<std::string>& arguments, const std::string& input) {
  Answer out = of_verb(arguments, input);
  if (news_) news_->look_now();
  return out;
}

/// Requests a page from the process that makes the pages. Status -1 if this process has ended.
ToolEnd SiteService::ask_pages(const process::Handle& partner, const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    if (over_ || !partner) return {};
    channels_.insert(partner.get());
  }
  const auto line = ask_partner(partner, name, shells_.seconds);
  const std::lock_guard lock(mutex_);
  channels_.erase(partner.get());
  const Json json = storage::parse_or_discard(line.value_or(""));
  if (!json.is_object()) return {};
  constexpr int error_status = 2;
  return {json.value("status", error_status), json.value("page", ""), json.value("error", "")};
}

/// The worklist is computed again only if its files have changed, because this takes seconds for
/// 100,000 campaigns.
std::shared_ptr<const SiteService::Shown> SiteService::shown() {
  const std::lock_guard lock(showing_);
  std::string stamp = worklist_stamp(wish_.folder, wish_.out);
  if (shown_ && shown_->stamp == stamp) return shown_;
  auto next = std::make_shared<Shown>();
  next->stamp = std::move(stamp);
  const std::vector<std::string> arguments{"status", "--actions", "--json",
                                           verb_option("site", wish_.folder.string()),
                                           wish_.out.string()};
  std::vector<std::string> all = arguments;
  all.push_back(verb_option("page", "-"));
  if (auto channel = launcher_.partner(all)) next->partner = std::move(*channel);
  ToolEnd end = ask_pages(next->partner, "all");
  if (end.status < 0) end = call(arguments);  // to get the error message
  Json out = storage::parse_or_discard(end.out);
  const bool is_whole = out.is_object() && out.contains("pages");
  if (is_whole) {
    for (auto& [name, text] : out["pages"].items())
      next->pages[name] = std::move(text.get_ref<std::string&>());
    out.erase("pages");
  }
  next->lines = of_end(end, std::move(out), command_line(arguments));
  if (is_whole) shown_ = next;
  return next;
}

Answer SiteService::worklist() {
  return wish_.out.empty() ? refused(409, "no_out") : shown()->lines;
}

Answer SiteService::metrics() {
  if (wish_.out.empty()) return refused(409, "no_out");
  const ToolEnd end =
      call({"status", "--metrics", verb_option("site", wish_.folder.string()), wish_.out.string()});
  if (end.status != 0) return refusal(503, end.errors);
  return {200, "application/openmetrics-text; version=1.0.0; charset=utf-8", end.out};
}

Answer SiteService::state(const User* user) {
  const RunNow run = news_->run();
  Json json = {
      {"schema", "nonio-live-site/1"},
      {"version", version_.load()},
      {"engine", wish_.version},
      {"edit", wish_.edit && (user == nullptr || user->role >= certificates::Role::measure)},
      {"approve", wish_.edit && (user == nullptr || user->role >= certificates::Role::approve)},
      {"site", wish_.name},
      {"out", wish_.out.string()},
      {"campaigns", campaigns_->index().size()},
      {"running", run_->is_running()},
      {"night",
       {{"state", run.state},
        {"night", run.number},
        {"date", run.date},
        {"last", run.last},
        {"last_date", run.last_date}}}};
  if (user != nullptr)
    json["user"] = {{"account", user->account},
                    {"name", user->name},
                    {"role", certificates::to_text(user->role)},
                    {"confirms", user->password.empty() ? "name" : "password"},
                    {"signs_out", wish_.sign_in}};
  if (Json now = run_->now(); !now.is_null()) json["run"] = std::move(now);
  return json_answer(200, json);
}

/// Secrets are omitted; administrators also get the users of users.toml.
Answer SiteService::settings(const User* user) const {
  std::string digest;
  const auto site = config::read_site(wish_.folder, digest);
  if (!site) return refusal(422, site.error().front().message);
  const Laboratory& lab = site->laboratory;
  const auto list = [](const std::optional<std::vector<std::string>>& all) {
    return all ? Json(*all) : Json(nullptr);  // null: all that apply
  };
  Json json = {{"schema", "nonio-live-settings/1"},
               {"laboratory",
                {{"name", lab.name},
                 {"address", lab.address},
                 {"country", lab.country},
                 {"accreditation", lab.accreditation},
                 {"authoriser", lab.authoriser},
                 {"contact", lab.contact}}},
               {"certificate",
                {{"languages", site->certificate.languages},
                 {"numbering", site->numbering.pattern},
                 {"procedure", site->certificate.procedure},
                 {"decision_rule", site->certificate.decision_rule},
                 {"two_persons", site->numbering.two_persons},
                 {"automatic", site->numbering.automatic},
                 {"signs", site->signing.has_value()},
                 {"time_stamp", site->signing ? site->signing->time_stamp : ""}}},
               {"run",
                {{"language", site->language},
                 {"analyses", list(site->run.analyses)},
                 {"outputs", list(site->run.outputs)},
                 {"seconds", site->limits.seconds},
                 {"mail", site->mail ? Json(site->mail->to) : Json::array()}}}};
  if (user != nullptr && user->role == certificates::Role::administer) {
    const auto users = certificates::read_users(wish_.folder);
    if (!users) return refused(503, "users");
    for (const User& one : *users)
      json["users"].push_back({{"account", one.account},
                               {"name", one.name},
                               {"role", certificates::to_text(one.role)},
                               {"password", !one.password.empty()}});
  }
  return json_answer(200, json);
}

namespace {

/// Links are rejected, because they may lead to any file.
bool is_plain_file_in(const fs::path& folder, const std::string& name) {
  std::error_code error;
  return name == fs::path(name).filename() && !name.starts_with('.') &&
         fs::is_regular_file(fs::symlink_status(storage::stored_in(folder / name), error)) &&
         storage::is_there(folder / name).value_or(false);
}

}  // namespace

/// Status 404 if no run has written this page.
Answer SiteService::page(const std::string& name) {
  const bool below = name.starts_with("machines/");
  const fs::path folder = below ? wish_.out / "machines" : wish_.out;
  const std::string plain = below ? name.substr(name.find('/') + 1) : name;
  if (wish_.out.empty() || !(plain.ends_with(".html") || plain == "due.ics") ||
      !is_plain_file_in(folder, plain))
    return refused(404, "no_page");
  const auto all = shown();
  if (!below) {
    const auto found = all->pages.find(name);
    return found != all->pages.end()  ? Answer{200, "application/octet-stream", found->second, {}}
           : all->lines.status != 200 ? all->lines
                                      : refused(404, "no_page");
  }
  const std::lock_guard lock(showing_);
  ToolEnd end = ask_pages(all->partner, name);
  if (end.status < 0) {
    if (shown_ == all) shown_.reset();  // the next request starts the process again
    end = call({"status", "--actions", verb_option("site", wish_.folder.string()),
                verb_option("page", name), wish_.out.string()});
  }
  if (end.status != 0 && end.status != 1) return refusal(422, end.errors);
  // Not sent as HTML, because a script in the page would run with the address of this server.
  return {200, "application/octet-stream", end.out, {}};
}

fs::path SiteService::result_file(const std::string& campaign, const std::string& file) const {
  if (wish_.out.empty() || !config::is_campaign_id(campaign)) return {};
  const fs::path folder = storage::results_folder(wish_.out, campaign);
  std::error_code error;
  const bool is_link = fs::is_symlink(fs::symlink_status(folder, error));
  return is_link || !is_plain_file_in(folder, file) ? fs::path() : folder / file;
}

Answer SiteService::result(const std::string& campaign, const std::string& file) {
  const fs::path path = result_file(campaign, file);
  if (path.empty()) return refused(404, "no_result");
  const auto bytes = storage::read_file(path);
  if (!bytes) return refusal(422, bytes.error().message);
  return {200, "application/octet-stream", *bytes, {}};
}

/// Findings of a campaign with their texts.
Answer SiteService::findings(const std::string& campaign) {
  const fs::path results = result_file(campaign, evaluation::results_name);
  if (results.empty()) return refused(404, "no_result");
  return of_verb(with_places({"show", "--findings", results.parent_path().string()}));
}

Answer SiteService::open(const std::string& campaign) {
  const auto folder = folder_of(campaign);
  if (!folder) return refused(404, "no_campaign", {{"campaign", campaign.substr(0, 200)}});
  if (desk(*folder) == nullptr) return refused(503, "ends");
  std::string path = "/c/";
  for (const char c : *folder) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned char>(c));
    path += plain ? std::string(1, c) : code;
  }
  return json_answer(
      200, {{"version", version_.load()},
            {"path", path + "/"},
            {"command", "nonio serve " + quoted_for_shell((wish_.folder / *folder).string())}});
}

}  // namespace nonio::live
