// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "certificates/users.h"
#include "live/audit_log.h"
#include "live/campaign_service.h"
#include "live/desk.h"
#include "live/session.h"
#include "live/sign_in.h"
#include "live/site_campaigns.h"
#include "live/site_news.h"
#include "live/tool.h"

namespace nonio::live {

struct ResultsNow {
  std::string status;                 ///< empty without results
  std::string sha256;                 ///< digest of results.json
  std::vector<std::string> findings;  ///< findings of severity warning
};
ResultsNow results_now(const std::filesystem::path& out, const std::string& id);

/// A `nonio run` that was started from a page: one at a time, for one campaign or for all changed
/// campaigns. Its state is JSON: progress (`state`, `stage`, `done`, `to_do`), messages and, at the
/// end, the differences of the results.
class SiteRun {
 public:
  /// `changed` is called when `now()` has changed.
  SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed);
  SiteRun(const SiteRun&) = delete;
  SiteRun& operator=(const SiteRun&) = delete;
  ~SiteRun();

  /// Starts a run of the campaign `id`, or of all changed campaigns if `id` is empty. Returns false
  /// if a run is in progress.
  Expected<bool> begin(const std::vector<std::string>& arguments, const std::string& command,
                       const std::string& id);
  /// Returns false if no run is in progress.
  bool cancel();
  bool is_running() const;
  /// Returns the state of the last run, or null.
  storage::Json now() const;
  void close();

 private:
  void follow(process::Handle channel);
  void take(const std::string& line);
  void end(const ToolEnd& end);

  Launcher& launcher_;
  std::filesystem::path out_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  storage::Json now_;
  std::string id_, last_words_;
  ResultsNow before_;
  bool running_ = false, cancelled_ = false, over_ = false;
  int channel_ = -1;
  std::thread thread_;
};

/// Example: "--by=B. Sample". With "=", a value that begins with "-" remains a value.
inline std::string verb_option(const std::string& name, const std::string& value) {
  return "--" + name + "=" + value;
}

inline std::string command_line(const std::vector<std::string>& arguments) {
  std::string out = "nonio";
  for (const std::string& one : arguments) out += " " + quoted_for_shell(one);
  return out;
}

/// The service of a site: runs commands of this program like a terminal and contains the workbench
/// of each open campaign.
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
            arguments.push_back(verb_option("plugin-path", folder));
          return call(arguments);
        },
        [this] { publish("campaigns"); }, [this] { return events_.listeners() > 0; });
    run_ = std::make_unique<SiteRun>(launcher_, wish_.out, [this] {
      if (!run_->is_running()) look_at_campaign();
      publish("run");
    });
    news_ = std::make_unique<SiteNews>(wish_.folder, wish_.out,
                                       [this](const std::string& what) { tell(what); });
    return {};
  }
  const std::vector<Route>& routes() const override { return routes_; }
  const Sentences& sentences() const override { return shells_.sentences; }
  bool signs_in() const override { return wish_.sign_in; }
  std::optional<Answer> before_body(const Head& head, const Route& route) override;
  Answer answer(const Request& request) override;
  void close() override;

 private:
  void add_routes();
  using User = certificates::User;
  Answer answer_to(const Request& request, const User* user);
  Answer recorded(const Request& request, const User* user, bool may);
  tl::expected<User, Answer> user_of(const Head& head);
  Answer begin_session(const Request& request);
  Answer end_session(const Request& request, const User& user);
  Answer get(const std::string& path, const Request& request, const User* user);
  Answer post(const std::string& what, const Request& request, const User* user);
  Answer worklist();
  /// Worklist and pages of all machines at one state of the site. `partner` is the channel to the
  /// process that makes the pages of single machines at this state.
  struct Shown {
    std::string stamp;
    process::Handle partner{};
    Answer lines{};
    std::map<std::string, std::string> pages{};
  };
  std::shared_ptr<const Shown> shown();
  ToolEnd ask_pages(const process::Handle& partner, const std::string& name);
  Answer metrics();
  Answer page(const std::string& name);
  Answer result(const std::string& campaign, const std::string& file);
  std::filesystem::path result_file(const std::string& campaign, const std::string& file) const;
  Answer mail(const storage::Json& body);
  Answer state(const User* user);
  Answer settings(const User* user) const;
  Answer events(const Request& request);
  Answer findings(const std::string& campaign);
  Answer open(const std::string& campaign);
  Answer acknowledge(const storage::Json& body);
  Answer event(const storage::Json& body);
  Answer release(const storage::Json& body, const User* user);
  Answer verify(const Request& request);
  Answer run(const storage::Json& body);
  Answer of_verb(const std::vector<std::string>& arguments, const std::string& input = {});
  static Answer of_end(const ToolEnd& end, storage::Json out, const std::string& command);
  Answer entered(const std::vector<std::string>& arguments, const std::string& input = {});
  ToolEnd call(const std::vector<std::string>& arguments, const std::string& input = {});
  std::vector<std::string> with_places(std::vector<std::string> arguments) const;
  std::optional<std::string> folder_of(const std::string& campaign) const;
  bool is_campaign(const std::string& folder) const;
  std::string id_of(const std::string& folder) const;
  std::shared_ptr<Desk> desk(const std::string& campaign);
  void tell(const std::string& what);
  void publish(const std::string& what);
  void look_at_campaign();

  LiveWish wish_;
  AuditLog audit_{wish_.folder};
  SignIn sign_in_;
  Launcher launcher_;
  Shells shells_;
  std::vector<Route> routes_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Desk>> desks_;
  std::vector<std::string> order_;  ///< keys of the desks, most recently used last
  std::string run_folder_;
  Events events_;
  std::atomic<std::uint64_t> version_ = 1;
  std::set<int> channels_;
  std::atomic<bool> over_ = false;
  std::mutex showing_;
  std::shared_ptr<const Shown> shown_;
  std::unique_ptr<SiteCampaigns> campaigns_;
  std::unique_ptr<SiteRun> run_;
  std::unique_ptr<SiteNews> news_;  ///< declared last, because its thread uses all other members
};

}  // namespace nonio::live
