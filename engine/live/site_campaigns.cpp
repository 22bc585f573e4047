// SPDX-License-Identifier: Apache-2.0
#include "live/site_campaigns.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include "campaign/config/keys.h"
#include "campaign/config/manifest.h"
#include "certificates/users.h"
#include "laboratory/assessment/describe.h"
#include "live/audit_log.h"
#include "live/session.h"
#include "nonio/sdk/text.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

namespace fs = std::filesystem;

namespace {

/// A request with a file: one line of JSON, then the bytes of the file.
struct DroppedFile {
  storage::Json form;
  std::string name, bytes;
};
using storage::Json;

enum class Form { text, day, number };

struct Field {
  const char* key;
  Form form = Form::text;
  const char* option = nullptr;
};

constexpr Field fields[] = {{"campaign.date", Form::day, "date"},
                            {"campaign.customer", Form::text, "customer"},
                            {"campaign.customer_address"},
                            {"campaign.site"},
                            {"campaign.operator", Form::text, "operator"},
                            {"machine.asset", Form::text, "asset"},
                            {"machine.maker", Form::text, "maker"},
                            {"machine.model", Form::text, "machine"},
                            {"machine.serial", Form::text, "serial"},
                            {"machine.control", Form::text, "control"},
                            {"instrument.model", Form::text, "instrument"},
                            {"instrument.maker"},
                            {"instrument.serial"},
                            {"instrument.calibrated", Form::day},
                            {"instrument.certificate"},
                            {"instrument.U_fixed_um", Form::number},
                            {"instrument.U_per_m_um", Form::number},
                            {"environment.misalignment_mm", Form::number},
                            {"environment.temperature_range_K", Form::number},
                            {"environment.temperature_difference_K", Form::number},
                            {"environment.expansion_range_um_per_m_K", Form::number},
                            {"environment.drift_um", Form::number},
                            {"certificate.conditions"}};

constexpr std::size_t longest_value_of_form = 500, longest_file_name = 120;

bool is_one_line(const std::string& text) {
  return text.size() <= longest_value_of_form && is_utf8(text) &&
         std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

bool is_number(std::string& text) {
  std::replace(text.begin(), text.end(), ',', '.');
  if (text.starts_with('+')) text.erase(0, 1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return false;
  std::array<char, 32> as_written_in_toml{};
  const auto written = std::to_chars(as_written_in_toml.begin(), as_written_in_toml.end(), value);
  text.assign(as_written_in_toml.begin(), written.ptr);
  return true;
}

bool is_taken_name(std::string name) {
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  constexpr std::string_view own[] = {config::manifest_name, "model-history.jsonl",
                                      "machine-record.json", certificates::users_name, audit_name};
  const auto is_name = [&](std::string_view one) { return one == name; };
  if (std::any_of(std::begin(own), std::end(own), is_name) ||
      std::any_of(std::begin(config::reserved_names), std::end(config::reserved_names), is_name))
    return true;
  const std::string stem = name.substr(0, name.find('.'));
  const bool numbered = stem.size() == 4 && (stem.starts_with("com") || stem.starts_with("lpt")) &&
                        stem[3] >= '0' && stem[3] <= '9';
  return numbered || stem == "con" || stem == "prn" || stem == "aux" || stem == "nul";
}

bool is_date(const std::string& text) {
  const std::string_view form = "0000-00-00";
  return std::equal(text.begin(), text.end(), form.begin(), form.end(),
                    [](char c, char f) { return f == '0' ? c >= '0' && c <= '9' : c == f; });
}

bool has_form(Form form, std::string& text) {
  switch (form) {
    case Form::day:
      return is_date(text);
    case Form::number:
      return is_number(text);
    case Form::text:
      break;
  }
  return is_one_line(text);
}

std::string text_of(const Json& json, const std::string& name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

const Json& values_of(const Json& form) {
  static const Json none = Json::object();
  const auto found = form.find("values");
  return found != form.end() && found->is_object() ? *found : none;
}

bool is_axis(const std::string& name) {
  return !name.empty() && name.size() <= 4 && name[0] >= 'A' && name[0] <= 'Z' &&
         std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

class FormOptions {
 public:
  explicit FormOptions(const Json& form)
      : form_(form), values_(values_of(form)), axis_(text_of(form, "axis")) {}

  tl::expected<std::vector<std::string>, Answer> all() {
    if (!is_axis(axis_)) refuse("axis");
    if (text_of(values_, "campaign.date").empty()) refuse("campaign.date");
    for (const Field& field : fields) {
      std::string text = text_of(values_, field.key);
      if (text.empty()) continue;
      if (!has_form(field.form, text)) refuse(field.key);
      out_.push_back(field.option != nullptr ? "--" + std::string(field.option) + "=" + text
                                             : "--set=" + std::string(field.key) + "=" + text);
    }
    put_axis();
    return result();
  }

  tl::expected<std::vector<std::string>, Answer> columns() {
    const auto found = form_.find("columns");
    constexpr std::size_t most = 100;
    if (found == form_.end()) return result();
    if (!found->is_array() || found->size() > most) refuse("columns");
    for (const Json& one : *found) {
      if (!one.is_string() || !is_one_line(one.get<std::string>())) {
        refuse("columns");
        break;
      }
      out_.push_back("--column=" + one.get<std::string>());
    }
    return result();
  }

 private:
  void refuse(const std::string& key) {
    if (wrong_) return;
    wrong_ = refused(422, "form_value");
    wrong_->body = storage::dump_line({{"key", key}});
  }
  tl::expected<std::vector<std::string>, Answer> result() {
    if (wrong_) return tl::unexpected(*wrong_);
    return std::move(out_);
  }
  std::string number(const std::string& key) {
    std::string text = text_of(values_, key);
    if (!text.empty() && !is_number(text)) refuse(key);
    return text;
  }
  void put_axis() {
    // The letters A to C denote rotary axes, as on the command line.
    const bool rotary = !axis_.empty() && axis_[0] >= 'A' && axis_[0] <= 'C';
    const std::string table = "--set=machine.axes." + axis_ + ".";
    const std::string from = number("axis.from"), to = number("axis.to");
    if (from.empty() != to.empty()) refuse(from.empty() ? "axis.from" : "axis.to");
    if (!from.empty()) out_.push_back("--axis=" + axis_ + "=" + from + ":" + to);
    std::string limits;
    for (const std::string name : {"A", "B", "E", "R"})
      if (const std::string limit = number("axis.tolerance." + name); !limit.empty())
        limits += (limits.empty() ? " " : ", ") + name + " = " + limit;
    if (!limits.empty())
      out_.push_back(table + (rotary ? "tolerance_arcsec={" : "tolerance_um={") + limits + " }");
    const std::string expansion = number("axis.expansion_um_per_m_K");
    if (!expansion.empty() && !rotary) out_.push_back(table + "expansion_um_per_m_K=" + expansion);
    if (text_of(values_, "axis.compensation") != "none") return;
    out_.push_back(table + "active_table=none");
    out_.push_back(table + (rotary ? "active_backlash_deg=none" : "active_backlash_mm=none"));
  }

  const Json &form_, &values_;
  std::string axis_;
  std::vector<std::string> out_{};
  std::optional<Answer> wrong_{};
};

/// An error is the rejection: invalid JSON, an empty file, or a file name that a campaign must not
/// contain.
tl::expected<DroppedFile, Answer> dropped_file(const std::string& body) {
  const std::size_t end = body.find('\n');
  DroppedFile out;
  if (end != body.npos) out.form = storage::parse_once(std::string_view(body).substr(0, end));
  if (!out.form.is_object()) return tl::unexpected(refused(400, "no_object"));
  out.name = text_of(out.form, "name");
  constexpr std::string_view not_on_windows = "\\/:*?\"<>|";
  const bool plain = storage::is_artifact_name(out.name) && is_one_line(out.name) &&
                     out.name.size() <= longest_file_name && !is_taken_name(out.name) &&
                     out.name.find_first_of(not_on_windows) == out.name.npos &&
                     out.name.back() != '.' && out.name.back() != ' ';
  if (!plain) return tl::unexpected(refused(422, "file_name"));
  out.bytes = body.substr(end + 1);
  if (out.bytes.empty()) return tl::unexpected(refused(422, "file_empty"));
  return out;
}

/// Returns --column=... for the member `columns`, and --axis if the member `axis` is valid.
tl::expected<std::vector<std::string>, Answer> file_options(const Json& form) {
  auto out = FormOptions(form).columns();
  const std::string axis = text_of(form, "axis");
  if (out && is_axis(axis)) out->push_back("--axis=" + axis);
  return out;
}

/// Returns the options of `nonio new campaign`. An error is the rejection of an invalid value.
tl::expected<std::vector<std::string>, Answer> campaign_options(const Json& form) {
  auto out = FormOptions(form).all();
  const auto columns = FormOptions(form).columns();
  if (!columns) return columns;
  if (out) out->insert(out->end(), columns->begin(), columns->end());
  return out;
}

/// Returns an id from date, machine and axis, which differs from the names of folders of the site.
std::string proposed_id(const Json& form) {
  const Json& values = values_of(form);
  std::string machine = text_of(values, "machine.asset");
  for (const char* key : {"machine.serial", "machine.model", "machine.maker"})
    if (machine.empty()) machine = text_of(values, key);
  std::string out;
  constexpr std::size_t most = 80;
  for (const char c :
       text_of(values, "campaign.date") + "-" + machine + "-" + text_of(form, "axis")) {
    const char low = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    const bool may = (low >= 'a' && low <= 'z') || (low >= '0' && low <= '9');
    if (may)
      out += low;
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  out.resize(std::min(out.size(), most));
  while (!out.empty() && out.back() == '-') out.pop_back();
  // The prefix avoids names of folders of the site, such as "machines", and device names of
  // Windows, such as "con".
  return out.empty() || out[0] < '0' || out[0] > '9' ? "campaign-" + out : out;
}

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
