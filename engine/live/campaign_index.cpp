// SPDX-License-Identifier: Apache-2.0
#include "live/campaign_index.h"

#include <simdjson.h>
#include <sys/stat.h>

#include <algorithm>

#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/evaluation/record.h"
#include "certificates/register.h"
#include "laboratory/store/identity.h"
#include "live/campaign_service.h"
#include "live/site_news.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/packed_results.h"

namespace nonio::live {
namespace fs = std::filesystem;

namespace {

std::string small(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return out;
}

std::string in_unit(double si, Quantity q) {
  std::string text;
  append_shortest(text, printed(si, q));
  return text;
}

void put(std::map<std::string, std::string>& to, const std::string& key, const std::string& text) {
  if (!text.empty()) to[key] = text;
}

void put(std::map<std::string, std::string>& to, const std::string& key,
         const std::optional<double>& value, double per_si) {
  if (!value) return;
  std::string text;
  append_shortest(text, rounded_to_places(*value * per_si, 9));
  to[key] = text;
}

void put_axis(std::map<std::string, std::string>& to, const Axis& axis) {
  const std::string at = "machine.axes." + axis.name + ".";
  const Quantity position = position_of(axis.rotary), deviation = deviation_of(axis.rotary);
  if (axis.travel) {
    to[at + "from"] = in_unit(axis.travel->first, position);
    to[at + "to"] = in_unit(axis.travel->second, position);
  }
  put(to, at + "expansion_um_per_m_K", axis.expansion, 1e6);
  for (const auto& [name, limit] : axis.tolerance)
    to[at + "tolerance." + name] = in_unit(limit, deviation);
}

std::map<std::string, std::string> values_of(const Campaign& c) {
  constexpr double um = 1e6, mm = 1e3;
  std::map<std::string, std::string> to;
  put(to, "campaign.customer", c.customer);
  put(to, "campaign.customer_address", c.customer_address);
  put(to, "campaign.site", c.site);
  put(to, "campaign.operator", c.operator_name);
  put(to, "machine.asset", c.machine.asset);
  put(to, "machine.maker", c.machine.maker);
  put(to, "machine.model", c.machine.model);
  put(to, "machine.serial", c.machine.serial);
  put(to, "machine.control", c.machine.control);
  for (const Axis& axis : c.machine.axes) put_axis(to, axis);
  const Instrument& i = c.instrument;
  put(to, "instrument.maker", i.maker);
  put(to, "instrument.model", i.model);
  put(to, "instrument.serial", i.serial);
  put(to, "instrument.calibrated", i.calibrated);
  put(to, "instrument.certificate", i.certificate);
  put(to, "instrument.valid_until", i.valid_until);
  put(to, "instrument.U_fixed_um", i.U_fixed, um);
  put(to, "instrument.U_per_m_um", i.U_per_length, um);
  const Environment& e = c.environment;
  put(to, "environment.misalignment_mm", e.misalignment, mm);
  put(to, "environment.temperature_range_K", e.temperature_range, 1.0);
  put(to, "environment.temperature_difference_K", e.temperature_difference, 1.0);
  put(to, "environment.expansion_range_um_per_m_K", e.expansion_range, um);
  put(to, "environment.drift_um", e.drift, um);
  put(to, "certificate.conditions", c.certificate.conditions);
  return to;
}

int severity(std::string_view decision) {
  return decision.empty() ? 0 : decision == "conforms" ? 1 : decision == "does not conform" ? 3 : 2;
}

/// Returns the worst decision in results.json. Measurements before an adjustment are ignored if
/// there are measurements after it.
std::string verdict_of(const std::string& results, const Campaign* campaign) {
  bool has_after = false;
  std::vector<std::string> before;
  if (campaign != nullptr)
    for (const Measurement& m : campaign->measurements) {
      has_after = has_after || m.adjustment == "after";
      if (m.adjustment == "before") before.push_back(m.id);
    }
  std::string worst;
  simdjson::ondemand::parser parser;
  const simdjson::padded_string text(results);
  simdjson::ondemand::document document;
  simdjson::ondemand::array all;
  if (parser.iterate(text).get(document) != simdjson::SUCCESS ||
      document["conformity"].get_array().get(all) != simdjson::SUCCESS)
    return worst;
  for (auto one : all) {
    std::string_view measurement, decision;
    if (one["measurement"].get_string().get(measurement) != simdjson::SUCCESS) measurement = {};
    if (one["decision"].get_string().get(decision) != simdjson::SUCCESS) continue;
    if (has_after && std::find(before.begin(), before.end(), measurement) != before.end()) continue;
    if (severity(decision) > severity(worst)) worst = decision;
  }
  return worst;
}

void take_manifest(const std::string& text, ListedCampaign& c,
                   std::optional<config::Manifest>& out) {
  auto read = config::parse_without_methods(text, config::manifest_name);
  if (!read) {
    c.id = config::extract_id(text);
    c.message = read.error().front().message;
    return;
  }
  const Campaign& campaign = read->campaign;
  const Machine& m = campaign.machine;
  c.id = campaign.id;
  c.day = campaign.date;
  c.customer = campaign.customer;
  c.place = campaign.site;
  c.machine = store::machine_of({m.asset, m.maker, m.model, m.serial});
  c.model = m.model;
  c.values = values_of(campaign);
  for (const auto& [plugin, options] : read->options)
    if (const auto found = options.find("columns"); found != options.end())
      if (const auto* list = std::get_if<std::vector<std::string>>(&found->second.value))
        c.columns = *list;
  out = std::move(*read);
}

/// Returns false if the results are those of another folder with the same id.
bool take_record(const fs::path& site, const fs::path& results, const std::string& manifest_sha256,
                 const Campaign* campaign, ListedCampaign& c) {
  const auto record = evaluation::read_record(results);
  if (!record) return true;
  std::error_code error;
  if (record->folder != c.folder &&
      fs::exists(site / record->folder / config::manifest_name, error)) {
    c.state = "failed";
    c.message = "expected an id of its own, found \"" + c.id + "\", the id of " + record->folder;
    return false;
  }
  if (const char* word = evaluation::to_text(record->status); *word != '\0') c.state = word;
  c.certificate = record->certificate;
  c.draft = record->draft;
  for (const evaluation::RecordedFile& file : record->files) c.files.push_back(file.name);
  if (!record->errors.empty()) c.message = record->errors.front().message;
  for (const auto& [name, digest] : record->inputs)
    if (name == config::manifest_name) c.changed = digest != manifest_sha256;
  if (const auto text = storage::read_file(results / evaluation::results_name))
    c.verdict = verdict_of(*text, campaign);
  return true;
}

/// The register knows since when a certificate is not in force, and of which campaign it is if its
/// successor is withheld.
void take_certificate(const std::map<std::string, std::string>& in_force, ListedCampaign& c) {
  const auto found = in_force.find(c.id);
  const std::string number = found == in_force.end() ? std::string() : found->second;
  if (!c.certificate.empty() && c.certificate != number) {
    std::erase_if(c.files, [](const std::string& file) { return file.starts_with("certificate"); });
    if (c.message.empty()) c.message = "certificate " + c.certificate + " is not in force";
  }
  c.certificate = number;
}

bool fits(const ListedCampaign& c, const std::string& state) {
  return state.empty() || c.state == state || c.verdict == state || (state == "draft" && c.draft) ||
         (state == "certificate" && !c.certificate.empty());
}

}  // namespace

std::string file_stamp(const fs::path& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return "-;";
  return std::to_string(s.st_size) + " " + std::to_string(s.st_mtim.tv_sec) + "." +
         std::to_string(s.st_mtim.tv_nsec) + " " + std::to_string(s.st_ino) + ";";
}

std::vector<std::string> words_of(const std::string& search) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : small(search) + " ")
    if (c != ' ')
      word += c;
    else if (!word.empty())
      words.push_back(std::exchange(word, {}));
  return words;
}

bool has_all(const std::string& text, const std::vector<std::string>& words) {
  return std::all_of(words.begin(), words.end(),
                     [&](const std::string& word) { return text.find(word) != std::string::npos; });
}

std::size_t begin_of_page(std::size_t page, std::size_t size, std::size_t all) {
  const std::size_t last = all == 0 ? 0 : (all - 1) / size;
  return std::min(page, last) * size;
}

bool CampaignIndex::IsNewer::operator()(const ListedCampaign* a, const ListedCampaign* b) const {
  return a->day != b->day ? a->day > b->day
         : a->id != b->id ? a->id < b->id
                          : a->folder < b->folder;
}

CampaignIndex::CampaignIndex(fs::path site, fs::path out, std::function<void()> changed,
                             std::function<bool()> is_watched, std::chrono::duration<double> pause)
    : site_(std::move(site)),
      out_(std::move(out)),
      changed_(std::move(changed)),
      is_watched_(std::move(is_watched)),
      pause_(pause) {
  thread_ = std::thread([this] { run(); });
}

CampaignIndex::~CampaignIndex() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool CampaignIndex::is_over() const {
  const std::lock_guard lock(mutex_);
  return over_;
}

std::string CampaignIndex::stamp_of(const std::string& folder, const std::string& id) const {
  std::string stamp = file_stamp(site_ / folder / config::manifest_name);
  if (out_.empty() || !config::is_campaign_id(id)) return stamp;
  return stamp + file_stamp(storage::stored_in(storage::results_folder(out_, id) /
                                               evaluation::record_name));
}

/// Reads aliases of machines and the register again after a change, and then all campaigns that
/// depend on them.
void CampaignIndex::look_at_site() {
  std::string stamp = file_stamp(site_ / config::site_name);
  const fs::path file = register_of(site_);
  if (!file.empty()) stamp += file_stamp(file) + file_stamp(file.string() + "-wal");
  std::shared_ptr<const SiteFacts> before;
  {
    const std::lock_guard lock(mutex_);
    before = facts_;
  }
  if (before->stamp == stamp) return;
  auto now = std::make_shared<SiteFacts>();
  now->stamp = std::move(stamp);
  std::string digest;
  if (const auto site = config::read_site(site_, digest)) {
    for (const config::Alias& alias : site->aliases) now->asset_of_alias[alias.name] = alias.asset;
    const auto entries = certificates::Register::entries(site_, site->numbering);
    now->has_register = entries && !entries->empty();
    if (entries)
      for (const certificates::RegisterEntry& e : *entries)
        if (e.in_force()) now->certificate_in_force[e.campaign] = e.number;
  }
  const std::lock_guard lock(mutex_);
  for (auto& entry : seen_) {
    Seen& seen = entry.second;
    const auto of = [&](const SiteFacts& facts) {
      const auto found = facts.certificate_in_force.find(seen.campaign.id);
      return found == facts.certificate_in_force.end() ? std::string() : found->second;
    };
    if (now->asset_of_alias != before->asset_of_alias || of(*now) != of(*before) ||
        now->has_register != before->has_register)
      seen.stamp = "-";
  }
  facts_ = std::move(now);
}

CampaignIndex::Seen CampaignIndex::read(const std::string& folder) const {
  Seen seen;
  std::shared_ptr<const SiteFacts> facts;
  {
    const std::lock_guard lock(mutex_);
    facts = facts_;
  }
  ListedCampaign& c = seen.campaign;
  c.folder = folder;
  c.state = "new";
  std::optional<config::Manifest> manifest;
  const auto text = storage::read_small_file(site_ / folder / config::manifest_name);
  if (text)
    take_manifest(*text, c, manifest);
  else
    c.message = text.error().message;
  seen.stamp = stamp_of(folder, c.id);
  bool is_own = true;
  if (!out_.empty() && text && config::is_campaign_id(c.id))
    is_own = take_record(site_, storage::results_folder(out_, c.id), storage::sha256(*text),
                         manifest ? &manifest->campaign : nullptr, c);
  if (const auto alias = facts->asset_of_alias.find(c.machine);
      alias != facts->asset_of_alias.end())
    c.machine = alias->second;
  if (facts->has_register && is_own) take_certificate(facts->certificate_in_force, c);
  const auto value = [&](const char* key) {
    const auto found = c.values.find(key);
    return found == c.values.end() ? std::string() : found->second;
  };
  c.words = small(c.folder + " " + c.id + " " + c.day + " " + c.customer + " " + c.place + " " +
                  c.machine + " " + c.model + " " + value("machine.serial") + " " + c.certificate);
  return seen;
}

void CampaignIndex::look_at(const std::string& folder) {
  Seen fresh = read(folder);
  const std::lock_guard lock(mutex_);
  Seen& seen = seen_[folder];
  order_.erase(&seen.campaign);
  seen = std::move(fresh);
  order_.insert(&seen.campaign);
  ++version_;
}

void CampaignIndex::look_soon() {
  {
    const std::lock_guard lock(mutex_);
    soon_ = true;
  }
  wake_.notify_all();
}

void CampaignIndex::look_if_old() {
  {
    const std::lock_guard lock(mutex_);
    if (std::chrono::steady_clock::now() - last_look_ < pause_) return;
    soon_ = true;
  }
  wake_.notify_all();
}

bool CampaignIndex::look_at_all() {
  bool is_new = false;
  look_at_site();
  const auto folders = campaigns_in(site_);
  for (const std::string& folder : folders) {
    if (is_over()) return false;
    std::string stamp, id;
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = seen_.find(folder); known != seen_.end())
        stamp = known->second.stamp, id = known->second.campaign.id;
    }
    if (!stamp.empty() && stamp == stamp_of(folder, id)) continue;
    look_at(folder);
    is_new = true;
  }
  const std::lock_guard lock(mutex_);
  const std::size_t gone = std::erase_if(seen_, [&](const auto& one) {
    if (std::binary_search(folders.begin(), folders.end(), one.first)) return false;
    order_.erase(&one.second.campaign);
    return true;
  });
  version_ += gone;
  is_new = is_new || gone > 0 || !complete_;
  complete_ = true;
  return is_new;
}

void CampaignIndex::run() {
  using Clock = std::chrono::steady_clock;
  constexpr double share = 20.0;  // smallest ratio of the pause to the duration of a check
  std::chrono::duration<double> pause = pause_;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, pause, [&] { return over_ || soon_; });
      if (over_) return;
      if (!soon_ && !is_watched_()) continue;
      soon_ = false;
    }
    const auto began = Clock::now();
    if (look_at_all()) changed_();
    const std::lock_guard lock(mutex_);
    last_look_ = Clock::now();
    pause = std::max(pause_, share * std::chrono::duration<double>(last_look_ - began));
  }
}

CampaignPage CampaignIndex::find(const CampaignQuery& query) const {
  const auto words = words_of(query.search);
  const std::lock_guard lock(mutex_);
  std::vector<const ListedCampaign*> found;
  for (const ListedCampaign* one : order_) {
    const ListedCampaign& c = *one;
    const bool is_wanted = query.folder.empty() || c.folder == query.folder;
    if (is_wanted && has_all(c.words, words) && fits(c, query.state)) found.push_back(one);
  }
  CampaignPage page{found.size(), seen_.size(), complete_, {}};
  const std::size_t size = std::max<std::size_t>(query.size, 1);
  const std::size_t from = begin_of_page(query.page, size, found.size());
  const std::size_t to = std::min(from + size, found.size());
  for (std::size_t i = from; i < to; ++i) page.campaigns.push_back(*found[i]);
  return page;
}

void CampaignIndex::each(const std::function<void(const ListedCampaign&)>& take) const {
  const std::lock_guard lock(mutex_);
  for (const ListedCampaign* one : order_) take(*one);
}

std::uint64_t CampaignIndex::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

bool CampaignIndex::has(const std::string& folder) const {
  const std::lock_guard lock(mutex_);
  return seen_.contains(folder);
}

std::size_t CampaignIndex::size() const {
  const std::lock_guard lock(mutex_);
  return seen_.size();
}

}  // namespace nonio::live
