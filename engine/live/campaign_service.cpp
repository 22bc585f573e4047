// SPDX-License-Identifier: Apache-2.0
#include "live/campaign_service.h"

#include <algorithm>

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "certificates/users.h"
#include "live/desk.h"
#include "nonio/workbench/page.h"
#include "platform/storage/files.h"
#include "platform/storage/late_library.h"

namespace nonio::live {

namespace fs = std::filesystem;

namespace {

constexpr const char* api = "/api/";

class CampaignService : public Starting {
 public:
  CampaignService(LiveWish wish, Launcher launcher, Shells shells)
      : wish_(std::move(wish)),
        launcher_(std::move(launcher)),
        shells_(std::move(shells)),
        routes_(shell_routes()) {
    for (Route& route : Desk::routes("")) routes_.push_back(std::move(route));
  }

  Expected<void> begin() override {
    desk_ = std::make_unique<Desk>(launcher_, wish_.folder, wish_.name, wish_.edit, wish_.version);
    return {};
  }
  const std::vector<Route>& routes() const override { return routes_; }
  Answer answer(const Request& request) override {
    if (request.route.open) return shell_file(request, shells_.campaign);
    const std::string what = request.route.path.substr(std::string(api).size());
    return desk_->answer(what, request.names.empty() ? "" : request.names.back(), request);
  }
  const Sentences& sentences() const override { return shells_.sentences; }
  void close() override {
    if (desk_) desk_->close();
  }

 private:
  LiveWish wish_;
  Launcher launcher_;
  Shells shells_;
  std::vector<Route> routes_;
  std::unique_ptr<Desk> desk_;
};

/// Texts are in the language of the site, or in English if they are not translated.
Expected<Shells> shells_of(const LiveWish& wish) {
  const fs::path site = config::site_of(wish.folder);
  std::string digest;
  const auto settings = config::read_site(site, digest);
  if (!settings) return fail(settings.error().front());
  NONIO_TRY(const auto folders, config::with_site_templates(wish.template_folders, site));
  std::vector<std::string> below;
  for (const std::string& language : {std::string("en"), settings->language})
    below.push_back("words/" + language + "/workbench");
  NONIO_TRY(const auto templates, config::read_templates(folders, {}, below));
  const bool is_there = templates.tables.contains(below.back());
  const std::string language = is_there ? settings->language : "en";
  NONIO_TRY(auto campaign, workbench::shell_html(templates, language, workbench::Shell::campaign));
  NONIO_TRY(auto of_site, workbench::shell_html(templates, language, workbench::Shell::site));
  return Shells{std::move(campaign), std::move(of_site),
                Sentences(workbench::words(templates, language)), settings->limits.seconds};
}

/// Whether users sign in at this server. False without users.toml or with a proxy. An error if
/// users.toml cannot be read or contains no password.
Expected<bool> requires_sign_in(const LiveWish& wish) {
  if (!certificates::has_users(wish.folder) && wish.user_header.empty()) return false;
  NONIO_TRY(const auto users, certificates::read_users(wish.folder));
  if (!wish.user_header.empty()) return false;
  if (std::none_of(users.begin(), users.end(),
                   [](const certificates::User& user) { return !user.password.empty(); }))
    return fail(
        Error{"no user has a password: expected a line of nonio serve SITE --hash-password, "
              "or --user-header of a proxy",
              certificates::users_name});
  return true;
}

}  // namespace

std::vector<std::string> campaigns_in(const fs::path& site) {
  constexpr int deepest = 4;
  std::vector<std::string> out;
  std::error_code failed;
  for (fs::recursive_directory_iterator
           it(site, fs::directory_options::skip_permission_denied, failed),
       end;
       !failed && it != end; it.increment(failed)) {
    if (it.depth() >= deepest) it.disable_recursion_pending();
    if (it->path().filename() == config::manifest_name)
      out.push_back(fs::relative(it->path().parent_path(), site, failed).string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

Expected<std::unique_ptr<Starting>> service_of(const LiveWish& wish) {
  std::error_code error;
  const bool is_campaign = fs::exists(wish.folder / config::manifest_name, error);
  if (!is_campaign && !fs::exists(wish.folder / config::site_name, error) &&
      campaigns_in(wish.folder).empty())
    return fail("there is no " + std::string(config::manifest_name) + " in " + wish.name +
                " or in a folder below it, and no " + config::site_name +
                ": it is neither a campaign nor a site");
  if (!wish.user_header.empty() && is_campaign)
    return fail("--user-header is for a site, and this is a campaign");
  LiveWish settled = wish;
  if (!is_campaign) {
    NONIO_TRY(settled.sign_in, requires_sign_in(wish));
    if (settled.sign_in && !wish.token_file.empty())
      return fail(
          "--token-file: people sign in at this site (users.toml), so that no token is used");
  }
  NONIO_TRY(auto shells, shells_of(wish));
  NONIO_TRY(auto launcher, Launcher::start({wish.folder, wish.plugin_folders, wish.template_folders,
                                            wish.own_plugins, wish.version}));
  if (!is_campaign) return site_service(settled, std::move(launcher), std::move(shells));
  return std::make_unique<CampaignService>(wish, std::move(launcher), std::move(shells));
}

Expected<void> serve(const LiveWish& wish) {
  const auto server = storage::exported_as<Serve>("libnonio_live_server.so", "nonio_serve");
  return server ? (**server)(wish) : fail(server.error());
}

}  // namespace nonio::live
