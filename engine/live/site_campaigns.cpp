// SPDX-License-Identifier: Apache-2.0
#include "live/site_campaigns.h"

#include <algorithm>
#include <charconv>

#include "laboratory/assessment/describe.h"
#include "live/campaign_form.h"
#include "live/session.h"
#include "platform/storage/files.h"
#include "platform/storage/scratch_folder.h"

namespace nonio::live {
namespace fs = std::filesystem;
using storage::Json;

namespace {

constexpr const char* of_file = "application/octet-stream";
constexpr std::size_t most_dropped = 32 << 20;
constexpr std::size_t most_lines = 200;  // limit per page

Json to_json(const ListedCampaign& c) {
  Json json = {{"folder", c.folder}, {"id", c.id}, {"state", c.state}};
  for (const auto& [name, text] : {std::pair{"day", &c.day},
                                   {"customer", &c.customer},
                                   {"place", &c.place},
                                   {"machine", &c.machine},
                                   {"model", &c.model},
                                   {"verdict", &c.verdict},
                                   {"certificate", &c.certificate},
                                   {"message", &c.message}})
    if (!text->empty()) json[name] = *text;
  json["draft"] = c.draft;
  json["changed"] = c.changed;
  json["files"] = c.files;
  return json;
}

std::size_t number_of(const Request& request, const char* name, std::size_t otherwise) {
  const auto text = request.query(name);
  if (!text) return otherwise;
  std::size_t number = 0;
  const auto read = std::from_chars(text->data(), text->data() + text->size(), number);
  return read.ec == std::errc() && read.ptr == text->data() + text->size() ? number : otherwise;
}

}  // namespace

SiteCampaigns::SiteCampaigns(fs::path site, fs::path out, Call call, std::function<void()> changed,
                             std::function<bool()> is_watched)
    : site_(std::move(site)),
      out_(std::move(out)),
      call_(std::move(call)),
      index_(
          site_, out_,
          [this, changed = std::move(changed)] {
            lists();
            changed();
          },
          std::move(is_watched)) {}

std::vector<Route> SiteCampaigns::routes() {
  return {{Method::get, "/api/campaigns"},
          {Method::get, "/api/machines"},
          {Method::get, "/api/instruments"},
          {Method::get, "/api/records"},
          {Method::post, "/api/preview", false, false, of_file, most_dropped},
          {Method::post, "/api/campaigns", false, true, of_file, most_dropped}};
}

Answer SiteCampaigns::answer(const std::string& what, const Request& request) {
  index_.look_if_old();
  if (request.route.method == Method::post)
    return what == "preview" ? preview(request) : create(request);
  return what == "campaigns"     ? list(request)
         : what == "machines"    ? machines(request)
         : what == "instruments" ? lists()->instruments
                                 : lists()->records;
}

Answer SiteCampaigns::list(const Request& request) const {
  CampaignQuery query;
  query.search = request.query("search").value_or("");
  query.folder = request.query("folder").value_or("");
  query.state = request.query("state").value_or("");
  query.page = number_of(request, "page", 0);
  query.size = std::clamp<std::size_t>(number_of(request, "size", query.size), 1, most_lines);
  const CampaignPage page = index_.find(query);
  Json all = Json::array();
  for (const ListedCampaign& c : page.campaigns) all.push_back(to_json(c));
  return json_answer(200, {{"schema", "nonio-live-campaigns/1"},
                           {"found", page.found},
                           {"all", page.all},
                           {"complete", page.complete},
                           {"page", query.page},
                           {"size", query.size},
                           {"campaigns", std::move(all)}});
}

/// The lists are made again only after a change, because this takes half a second for 100,000
/// campaigns.
std::shared_ptr<const CampaignLists> SiteCampaigns::lists() {
  const std::lock_guard lock(listing_);
  if (!lists_ || lists_->version != index_.version() || lists_->stamp != stamp_of_records(site_))
    lists_ = std::make_shared<const CampaignLists>(campaign_lists(index_, site_));
  return lists_;
}

Answer SiteCampaigns::machines(const Request& request) {
  const auto all = lists();
  const auto words = words_of(request.query("search").value_or(""));
  std::vector<const std::pair<const std::string, CampaignLists::Machine>*> found;
  for (const auto& one : all->machines)
    if (has_all(one.second.words, words)) found.push_back(&one);
  const std::size_t size =
      std::clamp<std::size_t>(number_of(request, "size", most_lines), 1, most_lines);
  const std::size_t from = begin_of_page(number_of(request, "page", 0), size, found.size());
  Json shown = Json::array();
  for (std::size_t i = from; i < std::min(from + size, found.size()); ++i) {
    Json json = found[i]->second.json;
    json["campaigns"] = found[i]->second.campaigns;
    const std::string page = assessment::page_of_machine(found[i]->first);
    std::error_code error;
    if (!out_.empty() && fs::is_regular_file(out_ / "machines" / page, error))
      json["page"] = "machines/" + page;
    shown.push_back(std::move(json));
  }
  return json_answer(200, {{"schema", "nonio-live-machines/1"},
                           {"found", found.size()},
                           {"all", all->machines.size()},
                           {"page", from / size},
                           {"size", size},
                           {"machines", std::move(shown)}});
}

namespace {

struct Taken {
  DroppedFile dropped;
  std::vector<std::string> options;
  storage::ScratchFolder folder{"live"};
  std::string path() const { return (folder.path() / dropped.name).string(); }
};

/// Stores the file of the request in `taken`. Returns the rejection of an invalid request.
std::optional<Answer> take(const Request& request, decltype(file_options)& options_of,
                           Taken& taken) {
  auto file = dropped_file(request.body);
  if (!file) return file.error();
  taken.dropped = *std::move(file);
  auto options = options_of(taken.dropped.form);
  if (!options) return options.error();
  taken.options = *std::move(options);
  if (taken.folder.path().empty()) return refused(503, "no_scratch");
  if (const auto kept =
          storage::publish(taken.folder.path(), {{taken.dropped.name, taken.dropped.bytes}});
      !kept)
    return refusal(503, kept.error().message);
  return std::nullopt;
}

}  // namespace

Answer SiteCampaigns::preview(const Request& request) {
  Taken taken;
  if (auto refusal = take(request, file_options, taken)) return *std::move(refusal);
  std::vector<std::string> arguments{"check", "--json"};
  arguments.insert(arguments.end(), taken.options.begin(), taken.options.end());
  arguments.push_back(taken.path());
  const ToolEnd end = call_(std::move(arguments));
  const Json out = storage::parse_or_discard(end.out);
  return out.is_object() ? json_answer(200, out) : refusal(422, end.errors);
}

/// Makes a new folder with this name, or with a number appended if it exists. Making the folder
/// reserves it, so that a simultaneous request gets the next number.
tl::expected<std::string, Answer> SiteCampaigns::take_folder(const std::string& id) {
  constexpr int most = 1000;
  for (int n = 1; n <= most; ++n) {
    const std::string name = n == 1 ? id : id + "-" + std::to_string(n);
    std::error_code error;
    if (fs::create_directory(site_ / name, error)) return name;
    std::error_code ignored;
    if (error && !fs::exists(fs::symlink_status(site_ / name, ignored)))
      return tl::unexpected(refusal(503, (site_ / name).string() + ": " + error.message()));
  }
  return tl::unexpected(refused(409, "folder_taken", {{"campaign", id}}));
}

/// If the command fails, the new folder is removed.
Answer SiteCampaigns::create(const Request& request) {
  Taken taken;
  if (auto refusal = take(request, campaign_options, taken)) return *std::move(refusal);
  const Json& form = taken.dropped.form;
  const auto name = take_folder(proposed_id(form));
  if (!name) return name.error();
  std::vector<std::string> arguments{"new", "campaign", (site_ / *name).string(), "--json"};
  arguments.insert(arguments.end(), taken.options.begin(), taken.options.end());
  std::string command = "nonio";
  for (const std::string& one : arguments)
    if (one != "--json") command += " " + quoted_for_shell(one);
  const std::string axis = form.value("axis", "");
  command += " " + quoted_for_shell("--file=" + axis + "=" + taken.dropped.name);
  arguments.push_back("--file=" + axis + "=" + taken.path());
  const ToolEnd end = call_(std::move(arguments));
  if (end.status != 0) {
    std::error_code ignored;
    fs::remove(site_ / *name, ignored);
    return refusal(422, end.errors);
  }
  index_.look_at(*name);
  return json_answer(200, {{"campaign", *name}, {"command", command}});
}

}  // namespace nonio::live
