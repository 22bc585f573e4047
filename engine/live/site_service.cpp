// SPDX-License-Identifier: Apache-2.0
#include "live/site_service.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>

#include "campaign/config/manifest.h"
#include "campaign/evaluation/record.h"
#include "nonio/sdk/text.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"

namespace nonio::live {

namespace fs = std::filesystem;
using certificates::Role;
using storage::Json;

namespace {

constexpr const char* of_json = "application/json";
constexpr std::size_t most_desks = 4, most_unsaved = 32;

Role needed(const Route& route) {
  if (route.path == "/api/audit") return Role::administer;
  if (route.path == "/api/release" || route.path == "/api/mail") return Role::approve;
  // Changes of the model are visible to everyone who views the campaign.
  if (route.method == Method::post && route.path.starts_with("/c/")) return Role::measure;
  return route.writes ? Role::measure : Role::view;
}

}  // namespace

void SiteService::add_routes() {
  routes_ = shell_routes();
  routes_.push_back({Method::get, "/c/{campaign}/", true, false, ""});
  for (const char* path :
       {"/api/site", "/api/site/state", "/api/settings", "/api/site/events", "/api/drafts",
        "/api/ack", "/api/event", "/api/audit", "/api/findings", "/metrics", "/site/{page}",
        "/site/machines/{page}", "/site/results/{campaign}/{file}"})
    routes_.push_back({Method::get, path, false, false, ""});
  routes_.push_back({Method::post, "/api/open", false, false, of_json});
  routes_.push_back({Method::post, "/api/verify", false, false,
                     "application/pdf application/xml text/xml application/json",
                     most_certificate});
  for (const char* path :
       {"/api/ack", "/api/event", "/api/release", "/api/mail", "/api/run", "/api/run/cancel"})
    routes_.push_back({Method::post, path, false, true, of_json});
  if (wish_.sign_in) {
    constexpr std::size_t most_of_sign_in = 4096;
    routes_.push_back({Method::post, "/api/sign-in", true, false, of_json, most_of_sign_in});
    routes_.push_back({Method::post, "/api/sign-out", false, false, of_json});
  }
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

/// Reads the campaign that was run last at once, and all others soon.
void SiteService::look_at_campaign() {
  std::string folder;
  {
    const std::lock_guard lock(mutex_);
    folder = run_folder_;
  }
  if (!folder.empty()) campaigns_->index().look_at(folder);
  campaigns_->index().look_soon();
}

void SiteService::tell(const std::string& what) {
  campaigns_->index().look_soon();
  if (what == "drafts") {  // the worklist counts them
    const std::lock_guard lock(showing_);
    shown_.reset();
    publish("worklist");
  }
  if (what == "worklist" && !wish_.out.empty()) shown();  // no page waits for the result
  publish(what);
}

void SiteService::publish(const std::string& what) {
  const std::uint64_t version = ++version_;
  events_.publish({version, what, "", storage::dump_line({{"version", version}})});
}

/// `campaign` is a folder or the id of results. Returns the folder relative to the site, if any.
std::optional<std::string> SiteService::folder_of(const std::string& campaign) const {
  if (is_campaign(campaign)) return campaign;
  if (wish_.out.empty() || !config::is_campaign_id(campaign)) return std::nullopt;
  const auto record = evaluation::read_record(storage::results_folder(wish_.out, campaign));
  if (record && is_campaign(record->folder)) return record->folder;
  return std::nullopt;
}

/// Whether the folder is inside the site, also after links are resolved, contains no "..", and has
/// a manifest.
bool SiteService::is_campaign(const std::string& folder) const {
  if (folder.empty() || folder.ends_with('/') || !is_utf8(folder)) return false;
  if (campaigns_->index().has(folder)) return true;
  const auto path = storage::path_inside(wish_.folder, folder);
  if (!path || fs::path(folder).lexically_normal() != folder) return false;
  std::error_code error;
  return fs::is_regular_file(*path / config::manifest_name, error);
}

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
    const auto idle = std::find_if(order_.begin(), order_.end(), [this](const std::string& one) {
      return !desks_[one]->has_unsaved();
    });
    if (order_.size() >= most_desks && idle != order_.end()) {
      desks_[*idle]->close();
      desks_.erase(*idle);
      order_.erase(idle);
    }
    if (order_.size() >= most_unsaved) return nullptr;
    desks_[campaign] = std::make_shared<Desk>(launcher_, wish_.folder / campaign,
                                              (fs::path(wish_.name) / campaign).string(),
                                              wish_.edit, wish_.version);
  }
  order_.push_back(campaign);
  return desks_[campaign];
}

/// Returns the user of the proxy or of the session. users.toml is read each time, so that changes
/// apply at once.
tl::expected<certificates::User, Answer> SiteService::user_of(const Head& head) {
  const auto users = certificates::read_users(wish_.folder);
  if (!users) return tl::unexpected(refused(503, "users"));
  if (wish_.sign_in) {
    auto user = sign_in_.user_of(head, *users);
    if (!user) return tl::unexpected(refused(403, "signed_out"));
    return *std::move(user);
  }
  const auto accounts = head.all(wish_.user_header);
  auto user =
      accounts.size() == 1 ? certificates::user_with(*users, accounts.front()) : std::nullopt;
  if (!user) return tl::unexpected(refused(403, "no_user"));
  return *std::move(user);
}

std::optional<Answer> SiteService::before_body(const Head& head, const Route& route) {
  if (route.open || (wish_.user_header.empty() && !wish_.sign_in)) return std::nullopt;
  const auto user = user_of(head);
  return user ? std::nullopt : std::optional(user.error());
}

Answer SiteService::answer(const Request& request) {
  const std::string& path = request.route.path;
  if (path == "/api/sign-in") return begin_session(request);
  if (request.route.open) return shell_file(request, path == "/" ? shells_.site : shells_.campaign);
  if (wish_.user_header.empty() && !wish_.sign_in) {
    // users.toml was added after the start, so requests without a user are rejected
    if (certificates::has_users(wish_.folder)) return refused(503, "users_new");
    return request.route.writes ? recorded(request, nullptr, true) : answer_to(request, nullptr);
  }
  const auto user = user_of(request.head);
  if (!user) return user.error();
  if (path == "/api/sign-out") return end_session(request, *user);
  const bool may = user->role >= needed(request.route);
  if (request.route.writes || !may) return recorded(request, &*user, may);
  Request of_user = request;
  of_user.may_write = user->role >= Role::measure;
  Answer out = answer_to(of_user, &*user);
  if (out.stream) out.may_go_on = [this, head = request.head] { return user_of(head).has_value(); };
  return out;
}

/// Records the request in the audit log and carries it out if `may`. A request that cannot be
/// recorded is rejected. Without users, the entry has no account.
Answer SiteService::recorded(const Request& request, const User* user, bool may) {
  const std::string& path = request.route.path;
  Json entry = {{"request", request.head.target.substr(0, request.head.target.find('?'))}};
  if (user != nullptr) entry.update({{"account", user->account}, {"name", user->name}});
  const Json body = storage::parse_once(request.body);
  const auto add = [&entry](const Json& from, std::initializer_list<const char*> names) {
    constexpr std::size_t longest = 500;
    for (const char* name : names)
      if (from.is_object() && from.contains(name) && storage::dump(from[name]).size() <= longest)
        entry[name] = from[name];
      else if (from.is_object() && from.contains(name))
        entry[name] = "(longer than 500 bytes)";
  };
  add(body, {"machine", "finding", "why", "text", "reasons", "file", "to"});
  if (path != "/api/ack" && path != "/api/event") add(body, {"campaign"});
  // The request is recorded before it is carried out.
  entry["state"] = may ? "begins" : "refused";
  if (!audit_.write(entry)) return refused(503, "audit");
  if (!may) return refused(403, "role", {{"role", certificates::to_text(user->role)}});
  Answer out = answer_to(request, user);
  const Json said = storage::parse_or_discard(out.body);
  const std::string result = said.is_object() && said.contains("state") && said["state"].is_string()
                                 ? said["state"].get<std::string>()
                                 : "";
  entry["state"] = out.status < 300 && result != "lacking" ? "done" : "failed";
  if (!result.empty()) entry["result"] = result;
  if (!out.said.name.empty()) entry["error"] = out.said.name;
  if (said.is_object())
    for (const char* name : {"campaign", "number", "error"})
      if (said.contains(name) && said[name].is_string()) entry[name] = said[name];
  if (!audit_.write(entry)) return refused(503, "audit");
  return out;
}

Answer SiteService::answer_to(const Request& request, const User* user) {
  const std::string& path = request.route.path;
  constexpr std::string_view root = "/api/", below = "/c/{campaign}/api/";
  if (path.starts_with(below)) {
    const auto one = desk(request.names.front());
    if (one == nullptr) return refused(404, "no_campaign", {{"campaign", request.names.front()}});
    return one->answer(path.substr(below.size()),
                       request.names.size() == 2 ? request.names.back() : "", request);
  }
  if (const std::string what = path.substr(root.size());
      what == "campaigns" || what == "machines" || what == "instruments" || what == "records" ||
      what == "preview") {
    Answer out = campaigns_->answer(what, request);
    if (request.route.writes && out.status == 200) tell("campaigns");
    return out;
  }
  if (request.route.method == Method::get) return get(path, request, user);
  return post(path.substr(root.size()), request, user);
}

Answer SiteService::get(const std::string& path, const Request& request, const User* user) {
  if (path == "/api/site") return worklist();
  if (path == "/metrics") return metrics();
  if (path == "/api/site/state") return state(user);
  if (path == "/api/settings") return settings(user);
  if (path == "/api/audit") {
    const auto text = audit_.text();
    return text ? Answer{200, "application/octet-stream", *text, {}}
                : refusal(422, text.error().message);
  }
  if (path == "/api/site/events") return events(request);
  if (path == "/api/drafts")
    return of_verb({"certificate", "approve", "--list", "--json", wish_.folder.string()});
  if (path == "/api/findings") return findings(request.query("campaign").value_or(""));
  if (path == "/api/ack") return of_verb({"machine", "ack", "--json", wish_.folder.string()});
  if (path == "/api/event") return of_verb({"machine", "event", "--json", wish_.folder.string()});
  if (path == "/site/{page}") return page(request.names.back());
  if (path == "/site/machines/{page}") return page("machines/" + request.names.back());
  return result(request.names.front(), request.names.back());
}

Answer SiteService::post(const std::string& what, const Request& request, const User* user) {
  if (what == "verify") return verify(request);
  Json body = storage::parse_once(request.body.empty() ? "{}" : request.body);
  if (!body.is_object()) return refused(400, "no_object");
  // Users make entries and approve under their own name.
  const bool is_entry = what == "ack" || what == "event";
  if (user != nullptr && (is_entry || what == "release")) body["by"] = user->name;
  try {
    // Who has the token can state any name.
    if (user == nullptr && is_entry && !body.value("by", "").empty())
      body["by"] = shells_.sentences({"entry.not_authenticated", {{"name", body["by"]}}});
    if (what == "open") return open(body.at("campaign").get<std::string>());
    if (what == "ack") return acknowledge(body);
    if (what == "event") return event(body);
    if (what == "release") return release(body, user);
    if (what == "mail") return mail(body);
    if (what == "run") return run(body);
    if (!run_->cancel()) return refused(409, "no_run");
    return json_answer(202, {{"version", version_.load()}});
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

std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, Shells shells) {
  return std::make_unique<SiteService>(wish, std::move(launcher), std::move(shells));
}

ResultsNow results_now(const std::filesystem::path& out, const std::string& id) {
  if (id.empty()) return {};
  const auto record = evaluation::read_record(storage::results_folder(out, id));
  if (!record) return {};
  ResultsNow now{.status = evaluation::to_text(record->status), .sha256 = {}, .findings = {}};
  for (const evaluation::RecordedFile& file : record->files)
    if (file.name == evaluation::results_name) now.sha256 = file.sha256;
  for (const evaluation::KnownFinding& f : record->findings)
    if (f.attention)
      now.findings.push_back((f.measurement.empty() ? "" : f.measurement + ": ") + f.heading());
  return now;
}

namespace {

/// Ends only a run that hangs, because each campaign has its own limit.
constexpr double longest_run_s = 24.0 * 3600.0;

Json only_in(const std::vector<std::string>& all, const std::vector<std::string>& other) {
  Json out = Json::array();
  for (const std::string& one : all)
    if (std::find(other.begin(), other.end(), one) == other.end()) out.push_back(one);
  return out;
}

}  // namespace

SiteRun::SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed)
    : launcher_(launcher), out_(std::move(out)), changed_(std::move(changed)) {}

SiteRun::~SiteRun() {
  close();
  if (thread_.joinable()) thread_.join();
}

Expected<bool> SiteRun::begin(const std::vector<std::string>& arguments, const std::string& command,
                              const std::string& id) {
  std::unique_lock lock(mutex_);
  if (running_ || over_) return false;
  NONIO_TRY(auto channel, launcher_.run(arguments, longest_run_s));
  if (thread_.joinable()) thread_.join();
  running_ = true;
  cancelled_ = false;
  id_ = id;
  before_ = results_now(out_, id);
  channel_ = channel.get();
  last_words_.clear();
  now_ = {{"state", "running"}, {"campaign", id}, {"command", command},
          {"stage", "begin"},   {"done", 0},      {"to_do", 0}};
  thread_ = std::thread([this, from = channel.release()] { follow(process::Handle(from)); });
  return true;
}

bool SiteRun::cancel() {
  const std::lock_guard lock(mutex_);
  if (!running_) return false;
  cancelled_ = true;
  const int fd = ::dup(channel_);
  if (fd < 0) return false;
  stop_tool(process::Handle(fd));
  return true;
}

bool SiteRun::is_running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

Json SiteRun::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void SiteRun::close() {
  const std::lock_guard lock(mutex_);
  over_ = true;
  // The next run resumes an interrupted run.
  if (channel_ >= 0) ::shutdown(channel_, SHUT_RDWR);
}

void SiteRun::take(const std::string& line) {
  const Json event = storage::parse_or_discard(line);
  {
    const std::lock_guard lock(mutex_);
    if (!event.is_object() || !event.contains("event")) {
      last_words_ = line;
      return;
    }
    const std::string what = event.value("event", "");
    if (what == "stage") now_["stage"] = event.value("name", "");
    if (what == "planned") now_["to_do"] = event.value("to_do", 0);
    if (what == "campaign") {
      now_["done"] = event.value("done", 0);
      if (event.contains("message")) now_["message"] = event["message"];
    }
    if (what == "end") now_["counts"] = event;
  }
  changed_();
}

void SiteRun::end(const ToolEnd& end) {
  constexpr int interrupted = 130, refused = 2;
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    channel_ = -1;
    now_["exit_status"] = end.status;
    const bool stopped = end.status == interrupted || end.status < 0;
    now_["state"] = stopped ? "cancelled" : end.status == refused ? "refused" : "done";
    if (end.status == refused || (stopped && !cancelled_)) now_["message"] = last_words_;
    if (!id_.empty() && !stopped && end.status != refused) {
      const ResultsNow after = results_now(out_, id_);
      now_["status"] = after.status;
      now_["was"] = before_.status;
      now_["same_results"] = !after.sha256.empty() && after.sha256 == before_.sha256;
      now_["new_findings"] = only_in(after.findings, before_.findings);
      now_["gone_findings"] = only_in(before_.findings, after.findings);
    }
  }
  changed_();
}

void SiteRun::follow(process::Handle channel) {
  const ToolEnd end_of_tool = hear_tool(channel, [this](const std::string& line) { take(line); });
  end(end_of_tool);
}

}  // namespace nonio::live
