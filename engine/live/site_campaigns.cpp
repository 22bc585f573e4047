// SPDX-License-Identifier: Apache-2.0
#include "live/site_campaigns.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "campaign/config/machines.h"
#include "campaign/reading/plausibility/traceability.h"
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
  json["findings"] = c.findings;
  return json;
}

std::size_t number_of(const Request& request, const char* name, std::size_t otherwise) {
  const auto text = request.query(name);
  if (!text) return otherwise;
  std::size_t number = 0;
  const auto read = std::from_chars(text->data(), text->data() + text->size(), number);
  return read.ec == std::errc() && read.ptr == text->data() + text->size() ? number : otherwise;
}

/// Returns the values whose keys begin with one of these prefixes, as an object.
Json values_with(const ListedCampaign& c, std::initializer_list<const char*> beginnings) {
  Json out = Json::object();
  for (const auto& value : c.values)
    if (std::any_of(beginnings.begin(), beginnings.end(),
                    [&](const char* beginning) { return value.first.starts_with(beginning); }))
      out[value.first] = value.second;
  return out;
}

std::string value_of(const ListedCampaign& c, const std::string& key) {
  const auto found = c.values.find(key);
  return found == c.values.end() ? std::string() : found->second;
}

std::string joined(std::initializer_list<std::string> texts) {
  std::string out;
  for (const std::string& one : texts)
    if (!one.empty()) out += (out.empty() ? "" : " ") + one;
  return out;
}

std::string instrument_of(const ListedCampaign& c) {
  return joined({value_of(c, "instrument.maker"), value_of(c, "instrument.model"),
                 value_of(c, "instrument.serial")});
}

}  // namespace

SiteCampaigns::SiteCampaigns(fs::path site, fs::path out, Call call, std::function<void()> changed,
                             std::function<bool()> is_watched)
    : site_(std::move(site)),
      out_(std::move(out)),
      call_(std::move(call)),
      index_(site_, out_, std::move(changed), std::move(is_watched)) {}

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
         : what == "machines"    ? machines()
         : what == "instruments" ? instruments()
                                 : records();
}

Answer SiteCampaigns::list(const Request& request) const {
  constexpr std::size_t most = 200;
  CampaignQuery query;
  query.search = request.query("search").value_or("");
  query.folder = request.query("folder").value_or("");
  query.state = request.query("state").value_or("");
  query.page = number_of(request, "page", 0);
  query.size = std::clamp<std::size_t>(number_of(request, "size", query.size), 1, most);
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

/// Lists the machines by name, each with its newest campaign.
Answer SiteCampaigns::machines() const {
  struct Machine {
    Json json;
    std::size_t campaigns = 0;
  };
  std::map<std::string, Machine> found;
  index_.each([&](const ListedCampaign& c) {
    if (c.machine.empty()) return;
    Machine& m = found[c.machine];
    if (m.campaigns++ > 0) return;
    m.json = {{"machine", c.machine},   {"maker", value_of(c, "machine.maker")},
              {"model", c.model},       {"serial", value_of(c, "machine.serial")},
              {"customer", c.customer}, {"day", c.day},
              {"state", c.state},       {"verdict", c.verdict}};
  });
  Json all = Json::array();
  for (auto& [name, m] : found) {
    m.json["campaigns"] = m.campaigns;
    const std::string page = assessment::page_of_machine(name);
    std::error_code error;
    if (!out_.empty() && fs::is_regular_file(out_ / "machines" / page, error))
      m.json["page"] = "machines/" + page;
    all.push_back(std::move(m.json));
  }
  return json_answer(200, {{"schema", "nonio-live-machines/1"}, {"machines", std::move(all)}});
}

/// Lists the instruments by name, each with its newest calibration and at most 20 of the newest
/// campaigns that used it.
Answer SiteCampaigns::instruments() const {
  struct Instrument {
    Json json;
    std::size_t campaigns = 0;
  };
  constexpr std::size_t most = 20;
  std::map<std::string, Instrument> found;
  index_.each([&](const ListedCampaign& c) {
    const std::string name = instrument_of(c);
    if (name.empty()) return;
    Instrument& i = found[name];
    const std::string calibrated = value_of(c, "instrument.calibrated");
    if (i.campaigns == 0)
      i.json = {{"name", name}, {"calibrated", ""}, {"campaigns", Json::array()}};
    if (calibrated > i.json["calibrated"].get<std::string>()) {
      i.json["calibrated"] = calibrated;
      i.json["certificate"] = value_of(c, "instrument.certificate");
      i.json["until"] = reading::last_valid_day(calibrated, value_of(c, "instrument.valid_until"));
    }
    if (i.campaigns++ < most)
      i.json["campaigns"].push_back(
          {{"folder", c.folder}, {"id", c.id}, {"day", c.day}, {"machine", c.machine}});
  });
  Json all = Json::array();
  for (auto& [name, i] : found) {
    i.json["number"] = i.campaigns;
    all.push_back(std::move(i.json));
  }
  return json_answer(200,
                     {{"schema", "nonio-live-instruments/1"}, {"instruments", std::move(all)}});
}

/// Lists each customer, machine, instrument and stated table with the values of its newest
/// campaign, and machines that have only a record.
Answer SiteCampaigns::records() const {
  Json customers = Json::array(), machines = Json::array(), instruments = Json::array(),
       columns = Json::array();
  std::set<std::string> seen;
  const auto is_new = [&](const std::string& kind, const std::string& name) {
    return !name.empty() && seen.insert(kind + name).second;
  };
  index_.each([&](const ListedCampaign& c) {
    const std::string instrument = instrument_of(c);
    if (is_new("customer ", c.customer))
      customers.push_back({{"name", c.customer}, {"values", values_with(c, {"campaign."})}});
    if (is_new("machine ", c.machine))
      machines.push_back(
          {{"name", c.machine}, {"values", values_with(c, {"campaign.", "machine."})}});
    if (is_new("instrument ", instrument))
      instruments.push_back({{"name", instrument},
                             {"values", values_with(c, {"instrument.", "environment.",
                                                        "certificate.", "campaign.operator"})}});
    std::string names;
    for (const std::string& one : c.columns) names += one + "\n";
    if (is_new("columns ", names)) columns.push_back(c.columns);
  });
  if (const auto records = config::read_machines(site_))
    for (const config::RecordFile& file : *records) {
      if (!file.record || !is_new("machine ", file.asset)) continue;
      const config::MachineRecord& r = *file.record;
      machines.push_back({{"name", r.asset},
                          {"values",
                           {{"machine.asset", r.asset},
                            {"machine.maker", r.maker},
                            {"machine.model", r.model},
                            {"machine.serial", r.serial},
                            {"machine.control", r.control}}}});
    }
  return json_answer(200, {{"schema", "nonio-live-records/1"},
                           {"customers", std::move(customers)},
                           {"machines", std::move(machines)},
                           {"instruments", std::move(instruments)},
                           {"columns", std::move(columns)}});
}

namespace {

/// A file that was dropped on the page with its form, as a copy that is removed at the end.
struct Taken {
  DroppedFile dropped;
  std::vector<std::string> options;
  storage::ScratchFolder folder{"live"};
  std::string path() const { return (folder.path() / dropped.name).string(); }
};

/// Puts the request's file into `taken`; returns an answer if it is refused.
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

/// Runs `nonio check FILE --json` on the copy.
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

/// Makes a new empty folder of the site with this name, or the name with a number if it exists.
/// Making the folder reserves it, so that a simultaneous request gets the next number.
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

/// Runs `nonio new campaign`. If it refuses the campaign, nothing remains of it.
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
    fs::remove(site_ / *name, ignored);  // removes the folder only if it is empty
    return refusal(422, end.errors);
  }
  index_.look_at(*name);
  return json_answer(200, {{"campaign", *name}, {"command", command}});
}

}  // namespace nonio::live
