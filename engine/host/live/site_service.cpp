// SPDX-License-Identifier: Apache-2.0
// The page of a site: verbs of this program, each as a terminal would call it; and the workbench of
// the campaign that is open.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "host/live/campaign_service.h"
#include "host/live/desk.h"
#include "host/live/tool.h"
#include "host/storage/files.h"

namespace nonio::host::live {
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

/// A file for a moment, readable by this user alone; gone at the end.
class Temporary {
 public:
  explicit Temporary(const std::string& bytes) {
    std::string pattern = (fs::temp_directory_path() / "nonio-live-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data()) != nullptr ? pattern : "";
    std::ofstream(file(), std::ios::binary) << bytes;
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  std::string file() const { return folder_ + "/certificate"; }

 private:
  std::string folder_;
};

class SiteService : public Starting {
 public:
  SiteService(LiveWish wish, Launcher launcher, std::string shell)
      : wish_(std::move(wish)), launcher_(std::move(launcher)), shell_(std::move(shell)) {
    add_routes();
  }
  ~SiteService() override {
    close();
    if (running_.joinable()) running_.join();
  }

  Expected<void> begin() override { return {}; }
  const std::vector<Route>& routes() const override { return routes_; }
  Answer answer(const Request& request) override;
  void close() override;

 private:
  void add_routes();
  Answer post(const std::string& what, const Request& request);
  Answer morning();
  Answer page(const std::string& name);
  Answer state();
  Answer open(const std::string& campaign);
  Answer acknowledge(const Json& body);
  Answer event(const Json& body);
  Answer release(const Json& body);
  Answer verify(const std::string& certificate);
  Answer run();
  Answer of_verb(const std::vector<std::string>& arguments);
  ToolEnd call(const std::vector<std::string>& arguments);
  ToolEnd hear(const process::Handle& channel, const std::function<void(const std::string&)>& line);
  Expected<std::string> known(const std::string& campaign) const;
  std::shared_ptr<Desk> desk(const std::string& campaign);
  void run_on(process::Handle channel);

  LiveWish wish_;
  Launcher launcher_;
  std::string shell_;
  std::vector<Route> routes_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Desk>> desks_;
  std::vector<std::string> order_;  ///< of the desks, the one used last behind
  std::string open_;                ///< the campaign at the root
  Events events_;
  std::atomic<std::uint64_t> version_ = 1;
  std::set<int> channels_;  ///< of verbs at work
  std::atomic<bool> runs_ = false, over_ = false;
  std::thread running_;
};

void SiteService::add_routes() {
  routes_ = shell_routes();
  routes_.push_back({Method::get, "/c/{campaign}/", true, false, ""});
  for (const char* path : {"/api/site", "/api/site/state", "/api/site/events", "/api/drafts",
                           "/site/{page}", "/site/machines/{page}"})
    routes_.push_back({Method::get, path, false, false, ""});
  routes_.push_back({Method::post, "/api/open", false, false, of_json});
  routes_.push_back({Method::post, "/api/verify", false, false, "application/pdf"});
  for (const char* path : {"/api/ack", "/api/event", "/api/release", "/api/run"})
    routes_.push_back({Method::post, path, false, true, of_json});
  for (const char* base : {"", "/c/{campaign}"})
    for (Route& route : Desk::routes(base)) routes_.push_back(std::move(route));
}

void SiteService::close() {
  over_ = true;
  events_.close();
  const std::lock_guard lock(mutex_);
  for (const auto& [name, one] : desks_) one->close();
  // Verbs at work end; a night that is interrupted so is resumed by the next one.
  for (const int channel : channels_) ::shutdown(channel, SHUT_RDWR);
}

Expected<std::string> SiteService::known(const std::string& campaign) const {
  const auto all = campaigns_in(wish_.folder);
  if (std::find(all.begin(), all.end(), campaign) == all.end())
    return fail("there is no campaign \"" + campaign.substr(0, 200) + "\" in this site");
  return (wish_.folder / campaign).string();
}

std::shared_ptr<Desk> SiteService::desk(const std::string& campaign) {
  const std::lock_guard lock(mutex_);
  if (over_) return nullptr;
  std::erase(order_, campaign);
  if (!desks_.contains(campaign)) {
    const auto folder = known(campaign);
    if (!folder) return nullptr;
    if (order_.size() == most_desks) {
      desks_[order_.front()]->close();
      desks_.erase(order_.front());
      order_.erase(order_.begin());
    }
    desks_[campaign] = std::make_shared<Desk>(
        launcher_, *folder, (fs::path(wish_.name) / campaign).string(), wish_.edit, wish_.version);
  }
  order_.push_back(campaign);
  return desks_[campaign];
}

Answer SiteService::answer(const Request& request) {
  const std::string& path = request.route.path;
  if (request.route.open) return shell_file(request, shell_);
  if (path == "/api/site") return morning();
  if (path == "/api/site/state") return state();
  if (path == "/api/drafts") return of_verb({"release", "--list", "--json", wish_.folder.string()});
  if (path == "/site/{page}") return page(request.names.back());
  if (path == "/site/machines/{page}") return page("machines/" + request.names.back());
  if (path == "/api/site/events") {
    Answer out{200, "text/event-stream", "", {}, events_.listen(0), &events_};
    return out.stream ? out : refusal(503, "8 pages listen already");
  }
  constexpr std::string_view root = "/api/", below = "/c/{campaign}/api/";
  for (const char* own : {"open", "verify", "ack", "event", "release", "run"})
    if (path == std::string(root) + own) return post(own, request);
  const bool named = path.starts_with(below);
  std::string campaign = named ? request.names.front() : "";
  if (!named) {
    const std::lock_guard lock(mutex_);
    campaign = open_;
  }
  if (campaign.empty())
    return refusal(409, "no campaign is open; POST /api/open {\"campaign\": \"...\"}");
  const auto one = desk(campaign);
  if (one == nullptr) return refusal(404, "there is no such campaign in this site");
  const std::size_t names = named ? 2 : 1;
  return one->answer(path.substr(named ? below.size() : root.size()),
                     request.names.size() == names ? request.names.back() : "", request);
}

Answer SiteService::post(const std::string& what, const Request& request) {
  if (what == "verify") return verify(request.body);
  const Json body = Json::parse(request.body.empty() ? "{}" : request.body, nullptr, false);
  if (!body.is_object()) return refusal(400, "expected a JSON object as the body");
  try {
    if (what == "open") return open(body.at("campaign").get<std::string>());
    if (what == "ack") return acknowledge(body);
    if (what == "event") return event(body);
    if (what == "release") return release(body);
    return run();
  } catch (const Json::exception&) {
    return refusal(400, "the body of POST /api/" + what + " is not as docs/live.md says");
  }
}

ToolEnd SiteService::hear(const process::Handle& channel,
                          const std::function<void(const std::string&)>& line) {
  {
    const std::lock_guard lock(mutex_);
    if (over_) return {};
    channels_.insert(channel.get());
  }
  ToolEnd end = hear_tool(channel, line);
  const std::lock_guard lock(mutex_);
  channels_.erase(channel.get());
  return end;
}

ToolEnd SiteService::call(const std::vector<std::string>& arguments) {
  const auto channel = launcher_.run(arguments);
  if (!channel) return {-1, "", channel.error().message};
  return hear(*channel, [](const std::string&) {});
}

/// What the verb prints with --json, and the command that was called.
Answer SiteService::of_verb(const std::vector<std::string>& arguments) {
  const ToolEnd end = call(arguments);
  Json out = Json::parse(end.out, nullptr, false);
  if (!out.is_object()) {
    out = {{"error", end.errors.empty() ? "it printed nothing" : end.errors}, {"status", 422}};
    out["command"] = command_line(arguments);
    return answered(422, out);
  }
  out["exit_status"] = end.status;
  out["command"] = command_line(arguments);
  if (!end.errors.empty()) out["words"] = end.errors;
  return answered(end.status == 2 ? 422 : 200, out);
}

Answer SiteService::morning() {
  if (wish_.out.empty())
    return refusal(409, "the output folder of the nights is not known; start with --out OUT");
  return of_verb({"morning", "--json", wish_.out.string()});
}

Answer SiteService::state() {
  Json json = {{"schema", "nonio-live-site/1"},
               {"version", version_.load()},
               {"engine", wish_.version},
               {"edit", wish_.edit},
               {"site", wish_.name},
               {"out", wish_.out.string()},
               {"campaigns", campaigns_in(wish_.folder)},
               {"running", runs_.load()}};
  const std::lock_guard lock(mutex_);
  json["open"] = open_;
  return answered(200, json);
}

/// A page of the morning by its name: only those that lie there.
Answer SiteService::page(const std::string& name) {
  const fs::path folder = name.starts_with("machines/") ? wish_.out / "machines" : wish_.out;
  const std::string plain = fs::path(name).filename().string();
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    if (it->path().extension() != ".html" || it->path().filename() != plain) continue;
    const auto bytes = storage::read_file(it->path());
    if (!bytes) return refusal(422, bytes.error().message);
    // To be kept or shown by the page itself: its own script would run with this address.
    return {200, "application/octet-stream", *bytes, {}};
  }
  return refusal(404, "the morning has no page of that name");
}

Answer SiteService::open(const std::string& campaign) {
  const auto folder = known(campaign);
  if (!folder) return refusal(404, folder.error().message);
  if (desk(campaign) == nullptr) return refusal(503, "nonio live ends");
  std::string path = "/c/";
  for (const char c : campaign) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned char>(c));
    path += plain ? std::string(1, c) : code;
  }
  const std::lock_guard lock(mutex_);
  open_ = campaign;
  return answered(200, {{"version", ++version_},
                        {"path", path + "/"},
                        {"command", "nonio live " + quoted_for_shell(*folder)}});
}

Answer SiteService::acknowledge(const Json& body) {
  std::vector<std::string> arguments{"ack", "--json"};
  for (const char* name :
       {"finding", "machine", "axis", "quantity", "until", "value", "U", "by", "why", "date"})
    if (body.contains(name)) arguments.push_back(option(name, body.at(name).get<std::string>()));
  arguments.push_back(wish_.folder.string());
  return of_verb(arguments);
}

Answer SiteService::event(const Json& body) {
  std::vector<std::string> arguments{"event", "--json"};
  for (const char* name : {"machine", "axis", "kind", "text", "date", "by"})
    if (body.contains(name)) arguments.push_back(option(name, body.at(name).get<std::string>()));
  arguments.push_back(wish_.folder.string());
  return of_verb(arguments);
}

Answer SiteService::release(const Json& body) {
  const auto folder = known(body.at("campaign").get<std::string>());
  if (!folder) return refusal(404, folder.error().message);
  std::vector<std::string> arguments{"release", "--json",
                                     option("by", body.at("by").get<std::string>())};
  if (body.contains("as")) arguments.push_back(option("as", body.at("as").get<std::string>()));
  const Json reasons = body.value("reasons", Json::object());
  for (const auto& [finding, why] : reasons.items())
    arguments.push_back(option("reason", finding + "=" + why.get<std::string>()));
  arguments.push_back(*folder);
  return of_verb(arguments);
}

Answer SiteService::verify(const std::string& certificate) {
  const Temporary file(certificate);
  return of_verb({"verify", "--json", option("site", wish_.folder.string()), file.file()});
}

/// What a night would do now: only what has changed is done again.
Answer SiteService::run() {
  if (wish_.out.empty()) return refusal(409, "start with --out OUT: where results go is not known");
  if (runs_.exchange(true)) return refusal(409, "a run is at work");
  const std::vector<std::string> arguments{"run", option("out", wish_.out.string()),
                                           wish_.folder.string()};
  auto channel = launcher_.run(arguments);
  if (!channel) {
    runs_ = false;
    return refusal(503, channel.error().message);
  }
  const std::lock_guard lock(mutex_);
  if (running_.joinable()) running_.join();
  running_ = std::thread([this, from = channel->release()] { run_on(process::Handle(from)); });
  return answered(202, {{"version", version_.load()}, {"command", command_line(arguments)}});
}

void SiteService::run_on(process::Handle channel) {
  const auto tell = [&](const char* type, Json data) {
    events_.publish({++version_, type, "run", storage::dump_line(data)});
  };
  const ToolEnd end = hear(channel, [&](const std::string& line) {
    tell("progress", {{"run", line}});
  });
  runs_ = false;
  tell("done", {{"run", "done"}, {"exit_status", end.status}, {"says", end.out}});
}

}  // namespace

std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, std::string shell) {
  return std::make_unique<SiteService>(wish, std::move(launcher), std::move(shell));
}

}  // namespace nonio::host::live
