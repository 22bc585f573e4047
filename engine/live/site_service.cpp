// SPDX-License-Identifier: Apache-2.0
// The page of a site: verbs of this program, each as a terminal would call it; and the workbench of
// each campaign that is open.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "campaign/config/manifest.h"
#include "campaign/evaluation/record.h"
#include "live/campaign_service.h"
#include "live/desk.h"
#include "live/site_campaigns.h"
#include "live/site_news.h"
#include "live/site_run.h"
#include "live/tool.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"
#include "platform/storage/scratch_folder.h"

namespace nonio::live {
namespace fs = std::filesystem;
using storage::Json;

namespace {

constexpr const char* of_json = "application/json";
constexpr std::size_t most_desks = 4;

/// "--by=B. Sample": a value that begins with "-" stays a value.
std::string option(const std::string& name, const std::string& value) {
  return "--" + name + "=" + value;
}

std::string command_line(const std::vector<std::string>& arguments) {
  std::string out = "nonio";
  for (const std::string& one : arguments) out += " " + quoted_for_shell(one);
  return out;
}

Answer answered(int status, const Json& json) {
  return {status, of_json, storage::dump_line(json)};
}

class SiteService : public Starting {
 public:
  SiteService(LiveWish wish, Launcher launcher, Shells shells)
      : wish_(std::move(wish)), launcher_(std::move(launcher)), shells_(std::move(shells)) {
    add_routes();
  }
  ~SiteService() override { close(); }

  Expected<void> begin() override {
    campaigns_ = std::make_unique<SiteCampaigns>(
        wish_.folder, wish_.out,
        [this](std::vector<std::string> arguments) {
          for (const std::string& folder : wish_.plugin_paths)
            arguments.push_back(option("plugin-path", folder));
          return call(arguments);
        },
        [this] { publish("campaigns"); });
    run_ = std::make_unique<SiteRun>(launcher_, wish_.out, [this] {
      if (!run_->is_running()) look_at_campaign();
      publish("run");
    });
    news_ = std::make_unique<SiteNews>(wish_.folder, wish_.out,
                                       [this](const std::string& what) { tell(what.c_str()); });
    return {};
  }
  const std::vector<Route>& routes() const override { return routes_; }
  const Sentences& sentences() const override { return shells_.sentences; }
  Answer answer(const Request& request) override;
  void close() override;

 private:
  void add_routes();
  Answer get(const std::string& path, const Request& request);
  Answer post(const std::string& what, const Request& request);
  Answer morning();
  Answer page(const std::string& name);
  Answer result(const std::string& campaign, const std::string& file);
  Answer state();
  Answer events(const Request& request);
  Answer open(const std::string& campaign);
  Answer acknowledge(const Json& body);
  Answer event(const Json& body);
  Answer release(const Json& body);
  Answer verify(const Request& request);
  Answer run(const Json& body);
  Answer of_verb(const std::vector<std::string>& arguments);
  Answer entered(const std::vector<std::string>& arguments);
  ToolEnd call(const std::vector<std::string>& arguments);
  std::vector<std::string> with_places(std::vector<std::string> arguments) const;
  std::optional<std::string> folder_of(const std::string& campaign) const;
  bool is_campaign(const std::string& folder) const;
  std::string id_of(const std::string& folder) const;
  std::shared_ptr<Desk> desk(const std::string& campaign);
  void tell(const char* what);
  void publish(const char* what);
  void look_at_campaign();

  LiveWish wish_;
  Launcher launcher_;
  Shells shells_;
  std::vector<Route> routes_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Desk>> desks_;
  std::vector<std::string> order_;  ///< of the desks, the one used last behind
  std::string run_folder_;          ///< of the campaign that was run last; empty: of all
  Events events_;
  std::atomic<std::uint64_t> version_ = 1;
  std::set<int> channels_;  ///< of verbs at work
  std::atomic<bool> over_ = false;
  std::unique_ptr<SiteCampaigns> campaigns_;
  std::unique_ptr<SiteRun> run_;
  std::unique_ptr<SiteNews> news_;  ///< its thread uses all of the above
};

void SiteService::add_routes() {
  routes_ = shell_routes();
  routes_.push_back({Method::get, "/c/{campaign}/", true, false, ""});
  for (const char* path :
       {"/api/site", "/api/site/state", "/api/site/events", "/api/drafts", "/api/ack", "/api/event",
        "/site/{page}", "/site/machines/{page}", "/site/results/{campaign}/{file}"})
    routes_.push_back({Method::get, path, false, false, ""});
  routes_.push_back({Method::post, "/api/open", false, false, of_json});
  routes_.push_back({Method::post, "/api/verify", false, false,
                     "application/pdf application/xml text/xml application/json",
                     most_certificate});
  for (const char* path : {"/api/ack", "/api/event", "/api/release", "/api/run", "/api/run/cancel"})
    routes_.push_back({Method::post, path, false, true, of_json});
  for (Route& route : SiteCampaigns::routes()) routes_.push_back(std::move(route));
  for (Route& route : Desk::routes("/c/{campaign}")) routes_.push_back(std::move(route));
}

void SiteService::close() {
  over_ = true;
  if (run_) run_->close();
  events_.close();
  const std::lock_guard lock(mutex_);
  for (const auto& [name, one] : desks_) one->close();
  for (const int channel : channels_) ::shutdown(channel, SHUT_RDWR);
}

/// The one that was run last.
void SiteService::look_at_campaign() {
  std::string folder;
  {
    const std::lock_guard lock(mutex_);
    folder = run_folder_;
  }
  if (!folder.empty()) campaigns_->index().look_at(folder);
  campaigns_->index().look_soon();
}

void SiteService::tell(const char* what) {
  campaigns_->index().look_soon();
  publish(what);
}

void SiteService::publish(const char* what) {
  const std::uint64_t version = ++version_;
  events_.publish({version, what, "", storage::dump_line({{"version", version}})});
}

/// Below the site, of a campaign that is named by its folder or by the id of its results.
std::optional<std::string> SiteService::folder_of(const std::string& campaign) const {
  if (is_campaign(campaign)) return campaign;
  if (wish_.out.empty() || !config::is_campaign_id(campaign)) return std::nullopt;
  const auto record = evaluation::read_record(storage::results_folder(wish_.out, campaign));
  if (record && is_campaign(record->folder)) return record->folder;
  return std::nullopt;
}

/// Whether a folder below the site, and not above or beyond a link, has a manifest.
bool SiteService::is_campaign(const std::string& folder) const {
  if (campaigns_->index().has(folder)) return true;
  const auto path = storage::path_inside(wish_.folder, folder);
  if (folder.empty() || !path || fs::path(folder).lexically_normal() != folder) return false;
  std::error_code error;
  return fs::is_regular_file(*path / config::manifest_name, error);
}

/// The id that its manifest gives; empty if it gives none.
std::string SiteService::id_of(const std::string& folder) const {
  const auto text = storage::read_small_file(wish_.folder / folder / config::manifest_name);
  return text ? config::extract_id(*text) : "";
}

std::shared_ptr<Desk> SiteService::desk(const std::string& campaign) {
  const std::lock_guard lock(mutex_);
  if (over_) return nullptr;
  std::erase(order_, campaign);
  if (!desks_.contains(campaign)) {
    if (!is_campaign(campaign)) return nullptr;
    if (order_.size() == most_desks) {
      desks_[order_.front()]->close();
      desks_.erase(order_.front());
      order_.erase(order_.begin());
    }
    desks_[campaign] = std::make_shared<Desk>(launcher_, wish_.folder / campaign,
                                              (fs::path(wish_.name) / campaign).string(),
                                              wish_.edit, wish_.version);
  }
  order_.push_back(campaign);
  return desks_[campaign];
}

Answer SiteService::answer(const Request& request) {
  const std::string& path = request.route.path;
  if (request.route.open) return shell_file(request, path == "/" ? shells_.site : shells_.campaign);
  constexpr std::string_view root = "/api/", below = "/c/{campaign}/api/";
  if (path.starts_with(below)) {
    const auto one = desk(request.names.front());
    if (one == nullptr) return refused(404, "no_campaign", {{"campaign", request.names.front()}});
    return one->answer(path.substr(below.size()),
                       request.names.size() == 2 ? request.names.back() : "", request);
  }
  if (const std::string what = path.substr(root.size());
      what == "campaigns" || what == "machines" || what == "records" || what == "preview") {
    Answer out = campaigns_->answer(what, request);
    if (request.route.writes && out.status == 200) tell("campaigns");
    return out;
  }
  if (request.route.method == Method::get) return get(path, request);
  return post(path.substr(root.size()), request);
}

Answer SiteService::get(const std::string& path, const Request& request) {
  if (path == "/api/site") return morning();
  if (path == "/api/site/state") return state();
  if (path == "/api/site/events") return events(request);
  if (path == "/api/drafts")
    return of_verb({"certificate", "approve", "--list", "--json", wish_.folder.string()});
  if (path == "/api/ack") return of_verb({"machine", "ack", "--json", wish_.folder.string()});
  if (path == "/api/event") return of_verb({"machine", "event", "--json", wish_.folder.string()});
  if (path == "/site/{page}") return page(request.names.back());
  if (path == "/site/machines/{page}") return page("machines/" + request.names.back());
  return result(request.names.front(), request.names.back());
}

Answer SiteService::post(const std::string& what, const Request& request) {
  if (what == "verify") return verify(request);
  const Json body = Json::parse(request.body.empty() ? "{}" : request.body, nullptr, false);
  if (!body.is_object()) return refused(400, "no_object");
  try {
    if (what == "open") return open(body.at("campaign").get<std::string>());
    if (what == "ack") return acknowledge(body);
    if (what == "event") return event(body);
    if (what == "release") return release(body);
    if (what == "run") return run(body);
    if (!run_->cancel()) return refused(409, "no_run");
    return answered(202, {{"version", version_.load()}});
  } catch (const Json::exception&) {
    return refused(400, "body_form", {{"path", "/api/" + what}});
  }
}

Answer SiteService::events(const Request& request) {
  std::uint64_t since = 0;
  if (const auto text = request.query("since")) {
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), since);
    if (error != std::errc() || end != text->data() + text->size()) return refused(400, "since");
  }
  Answer out{200, "text/event-stream", "", {}, {}, events_.listen(since), &events_};
  return out.stream ? out : refused(503, "streams");
}

ToolEnd SiteService::call(const std::vector<std::string>& arguments) {
  const auto channel = launcher_.run(arguments);
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

/// Plugins and templates as this server has them.
std::vector<std::string> SiteService::with_places(std::vector<std::string> arguments) const {
  for (const std::string& folder : wish_.plugin_paths)
    arguments.push_back(option("plugin-path", folder));
  for (const std::string& folder : wish_.template_paths)
    arguments.push_back(option("templates", folder));
  return arguments;
}

/// What the verb prints with --json, and the command that was called.
Answer SiteService::of_verb(const std::vector<std::string>& arguments) {
  const ToolEnd end = call(arguments);
  Json out = Json::parse(end.out, nullptr, false);
  if (!out.is_object()) {
    out = {{"error", end.errors.empty() ? "it printed nothing" : end.errors},
           {"status", 422},
           {"lang", "en"}};
    out["command"] = command_line(arguments);
    return answered(422, out);
  }
  out["exit_status"] = end.status;
  out["command"] = command_line(arguments);
  if (!end.errors.empty()) out["words"] = end.errors;
  return answered(end.status == 2 ? 422 : 200, out);
}

/// The same of what other pages should see at once.
Answer SiteService::entered(const std::vector<std::string>& arguments) {
  Answer out = of_verb(arguments);
  if (news_) news_->look_now();
  return out;
}

Answer SiteService::morning() {
  if (wish_.out.empty()) return refused(409, "no_out");
  return of_verb(
      {"status", "--actions", "--json", option("site", wish_.folder.string()), wish_.out.string()});
}

Answer SiteService::state() {
  const RunNow run = news_->run();
  Json json = {{"schema", "nonio-live-site/1"},
               {"version", version_.load()},
               {"engine", wish_.version},
               {"edit", wish_.edit},
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
  if (Json now = run_->now(); !now.is_null()) json["run"] = std::move(now);
  return answered(200, json);
}

/// Of a folder only its plain files, by name.
bool is_plain_file_in(const fs::path& folder, const std::string& name) {
  if (storage::in_pack(folder))
    return (storage::is_artifact_name(name) || name == evaluation::results_name) &&
           storage::is_there(folder / name).value_or(false);
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    std::error_code ignored;
    if (it->path().filename() == name)
      return fs::is_regular_file(it->symlink_status(ignored)) && !name.starts_with('.');
  }
  return false;
}

/// A page of the site by its name, as it would be now: only those that the run has written.
Answer SiteService::page(const std::string& name) {
  const bool below = name.starts_with("machines/");
  const fs::path folder = below ? wish_.out / "machines" : wish_.out;
  const std::string plain = below ? name.substr(name.find('/') + 1) : name;
  if (wish_.out.empty() || !(plain.ends_with(".html") || plain == "due.ics") ||
      !is_plain_file_in(folder, plain))
    return refused(404, "no_page");
  const ToolEnd end = call({"status", "--actions", option("site", wish_.folder.string()),
                            option("page", name), wish_.out.string()});
  if (end.status != 0) return refusal(422, end.errors);
  // To be kept or shown by the page itself: its own script would run with this address.
  return {200, "application/octet-stream", end.out, {}};
}

/// A file of the results of a campaign, to be kept.
Answer SiteService::result(const std::string& campaign, const std::string& file) {
  const fs::path folder = wish_.out.empty() || !config::is_campaign_id(campaign)
                              ? fs::path()
                              : storage::results_folder(wish_.out, campaign);
  if (folder.empty() || !is_plain_file_in(folder, file)) return refused(404, "no_result");
  const auto bytes = storage::read_file(folder / file);
  if (!bytes) return refusal(422, bytes.error().message);
  return {200, "application/octet-stream", *bytes, {}};
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
  return answered(
      200, {{"version", version_.load()},
            {"path", path + "/"},
            {"command", "nonio serve " + quoted_for_shell((wish_.folder / *folder).string())}});
}

/// The members that a body has, as options.
void add_options(std::vector<std::string>& arguments, const Json& body,
                 std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (body.contains(name)) arguments.push_back(option(name, body.at(name).get<std::string>()));
}

Answer SiteService::acknowledge(const Json& body) {
  std::vector<std::string> arguments{"machine", "ack", "--json"};
  if (body.value("withdraw", false)) arguments.emplace_back("--withdraw");
  add_options(
      arguments, body,
      {"finding", "machine", "axis", "quantity", "until", "value", "U", "by", "why", "date"});
  // Without what it is about the verb would list.
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

Answer SiteService::release(const Json& body) {
  const auto folder = folder_of(body.at("campaign").get<std::string>());
  if (!folder)
    return refused(404, "no_campaign", {{"campaign", body["campaign"].get<std::string>()}});
  std::vector<std::string> arguments{"certificate", "approve", "--json",
                                     option("by", body.at("by").get<std::string>())};
  add_options(arguments, body, {"as"});
  const Json reasons = body.value("reasons", Json::object());
  for (const auto& [finding, why] : reasons.items())
    arguments.push_back(option("reason", finding + "=" + why.get<std::string>()));
  arguments.push_back((wish_.folder / *folder).string());
  Answer out = entered(with_places(std::move(arguments)));
  campaigns_->index().look_at(*folder);
  return out;
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
      with_places({"certificate", "verify", "--json", option("site", wish_.folder.string()),
                   (folder.path() / name).string()}));
}

/// One campaign of the previous run again; or what a run would do now, of all that has changed.
Answer SiteService::run(const Json& body) {
  if (wish_.out.empty()) return refused(409, "no_out");
  std::vector<std::string> arguments{"run", option("out", wish_.out.string())};
  std::string id, of_one;
  if (body.contains("campaign")) {
    const auto folder = folder_of(body["campaign"].get<std::string>());
    if (!folder)
      return refused(404, "no_campaign", {{"campaign", body["campaign"].get<std::string>()}});
    id = id_of(*folder);
    of_one = *folder;
    // The first run of a site is of all its campaigns.
    if (news_->run().last != 0) arguments.push_back(option("only", *folder));
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
  return answered(202, {{"version", version_.load()}, {"command", command}});
}

}  // namespace

std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, Shells shells) {
  return std::make_unique<SiteService>(wish, std::move(launcher), std::move(shells));
}

}  // namespace nonio::live
