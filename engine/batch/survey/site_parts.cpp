// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/site_parts.h"

#include <algorithm>
#include <array>
#include <set>

#include "batch/state/run_state.h"
#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr const char* copies_folder = "site";
constexpr const char* inventory_name = "site.json";
constexpr const char* inventory_schema = "nonio-site/1";
constexpr std::array entered = {config::site_name, config::events_name, config::acknowledged_name,
                                config::forgotten_name};
constexpr std::array part_folders = {config::machines_folder, config::templates_folder,
                                     config::causes_folder};

std::string folder_of(const std::string& path) { return path.substr(0, path.find('/')); }

std::string_view without_end(std::string_view text) {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

/// Returns a description if the file is empty or truncated, which no editing explains; otherwise
/// empty.
std::string lost_bytes(std::string_view before, std::string_view now) {
  before = without_end(before), now = without_end(now);
  if (before.empty() || now.size() >= before.size()) return {};
  if (now.empty()) return "is empty";
  if (before.starts_with(now))
    return "was cut: it ends after " + std::to_string(now.size()) + " of " +
           std::to_string(before.size()) + " bytes";
  return {};
}

bool is_record(const std::string& path) {
  return path.starts_with(std::string(config::machines_folder) + "/") && path.ends_with(".toml");
}
std::string asset_of(const std::string& path) { return fs::path(path).stem().string(); }

/// Whether the file may replace its copy. An invalid machine record may not, because the copy
/// identifies the machine of a lost record.
bool is_good(const std::string& path, const std::string& bytes) {
  return !is_record(path) || config::parse_machine(bytes, path, asset_of(path)).has_value();
}

Expected<void> remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) return fail("cannot remove " + path.string() + ": " + error.message());
  return {};
}

}  // namespace

Expected<SiteParts> SiteParts::compare(const fs::path& site, const fs::path& out) {
  SiteParts parts;
  parts.site_ = site, parts.out_ = out / state_folder;
  if (auto read = parts.read_inventory(); !read) return fail(read.error());
  if (auto looked = parts.look_at_all(); !looked) return fail(looked.error());
  // A log with an error confirms no removal; the run reports the error when it reads the log.
  if (const auto logs = config::read_site_logs(site)) parts.leave_out_removed(logs->forgotten);
  parts.note_lost();
  return parts;
}

Expected<void> SiteParts::read_inventory() {
  NONIO_TRY(const auto there, storage::is_there(out_ / inventory_name));
  if (!there) return read_copies();
  NONIO_TRY(const auto text, storage::read_file(out_ / inventory_name));
  const storage::Json json = storage::parse_or_discard(text);
  try {
    if (json.at("schema") != inventory_schema) throw std::runtime_error("another schema");
    date_ = json.at("date").get<std::string>();
    run_ = json.at("night").get<std::uint64_t>();
    for (const auto& [path, part] : json.at("files").items()) {
      // Files with these names are read, written and removed, so the names must not lead out of the
      // site.
      if (!config::is_site_part(path) || fs::path(path).lexically_normal() != path)
        throw std::runtime_error("no path below the site");
      parts_[path] = {part.at("sha256").get<std::string>(), part.value("last_seen", date_), {}};
    }
  } catch (const std::exception& e) {
    parts_.clear();
    damaged_ = (out_ / inventory_name).string() + " is damaged";
    return read_copies();
  }
  return {};
}

/// Makes the inventory from the copies, because it is missing or damaged.
Expected<void> SiteParts::read_copies() {
  NONIO_TRY(const auto there, storage::is_there(out_ / copies_folder));
  if (!there) return {};
  NONIO_TRY(const auto copies, config::template_paths(out_ / copies_folder));
  if (damaged_.empty()) damaged_ = (out_ / inventory_name).string() + " is missing";
  for (const auto& [path, file] : copies) {
    NONIO_TRY(const auto digest, storage::sha256_of_file(file));
    parts_[path].sha256 = digest;
  }
  return {};
}

Expected<void> SiteParts::look_at_all() {
  std::set<std::string> paths(entered.begin(), entered.end());
  for (const auto& [path, part] : parts_) paths.insert(path);
  for (const char* folder : part_folders) {
    NONIO_TRY(const auto there, storage::is_there(site_ / folder));
    std::error_code error;
    if (!there || !fs::is_directory(site_ / folder, error)) continue;
    NONIO_TRY(const auto files, config::template_paths(site_ / folder));
    for (const auto& [name, file] : files)
      if (const std::string path = std::string(folder) + "/" + name;
          folder != config::machines_folder || (is_record(path) && name.find('/') == name.npos))
        paths.insert(path);
  }
  for (const std::string& path : paths) look(path);
  return {};
}

void SiteParts::look(const std::string& path) {
  const auto known = parts_.find(path);
  const bool is_known = known != parts_.end();
  const auto there = storage::is_there(site_ / path);
  if (there && !*there) {
    if (is_known) known->second.why = "is missing";
    return;
  }
  auto now = there ? storage::read_file(site_ / path) : fail(there.error());
  if (!now) {
    if (is_known) known->second.why = "cannot be read: " + now.error().message;
    return;
  }
  const std::string digest = storage::sha256(*now);
  if (is_known && known->second.sha256 == digest) {
    known->second.last_seen.clear();
    const auto copy = storage::read_file(out_ / copies_folder / path);
    if (!copy || *copy != *now) renewed_[path] = std::move(*now);
    return;
  }
  if (is_known) {
    const auto before = storage::read_file(out_ / copies_folder / path);
    if (before) known->second.why = lost_bytes(*before, *now);
    if (!known->second.why.empty()) return;
    known->second.last_seen.clear();
  }
  if (is_good(path, *now)) renewed_[path] = std::move(*now);
}

/// An entry of forgotten.toml that is older than the last valid state of the file refers to an
/// earlier loss.
void SiteParts::leave_out_removed(const std::vector<config::Forgotten>& forgotten) {
  for (const auto& one : parts_) {
    const std::string& path = one.first;
    if (one.second.why.empty()) continue;
    const bool removed = std::any_of(forgotten.begin(), forgotten.end(), [&](const auto& f) {
      return f.date >= one.second.last_seen &&
             (f.campaign == path || path.starts_with(f.campaign + "/"));
    });
    if (removed) removed_.push_back(path);
  }
}

void SiteParts::note_lost() {
  const std::set<std::string> removed(removed_.begin(), removed_.end());
  std::map<std::string, std::size_t> whole;
  for (const char* folder : part_folders) {
    std::size_t missing = 0;
    const bool all = std::all_of(parts_.begin(), parts_.end(), [&](const auto& p) {
      if (folder_of(p.first) != folder || removed.contains(p.first)) return true;
      ++missing;
      return p.second.why == "is missing";
    });
    if (all && missing > 1) whole[folder] = missing;
  }
  const auto meant = [](const std::string& path) {
    return "; restore it, or if it was removed on purpose, record that (nonio machine remove "
           "SITE " +
           path + " --by NAME --why TEXT)";
  };
  for (const auto& [folder, count] : whole)
    lost_.push_back({folder, folder, run_,
                     "none of its " + std::to_string(count) +
                         " files exists any more; their last contents are in " +
                         (out_ / copies_folder / folder).string() + meant(folder)});
  for (const auto& [path, part] : parts_)
    if (!part.why.empty() && !removed.contains(path) && !whole.contains(folder_of(path)))
      lost_.push_back({path, path, run_, why_of(path) + meant(path)});
  if (!damaged_.empty())
    lost_.push_back({std::string(state_folder) + "/" + inventory_name, "", run_,
                     damaged_ + "; this run makes the inventory of the site anew"});
}

/// Returns the error with the date of the last valid state, a new name of the file if it was
/// renamed, and the path of the copy.
std::string SiteParts::why_of(const std::string& path) const {
  const Part& part = parts_.at(path);
  std::string why = part.why;
  if (why == "is missing")
    for (const auto& [other, bytes] : renewed_)
      if (storage::sha256(bytes) == part.sha256) why = "is missing; " + other + " has its contents";
  return why + (part.last_seen.empty() ? "" : "; the run of " + part.last_seen + " has read it") +
         "; its last contents are in " + (out_ / copies_folder / path).string();
}

std::string SiteParts::refusal() const {
  std::string out;
  for (const Vanished& v : lost_)
    if (v.id == config::site_name || folder_of(v.id) == config::templates_folder)
      out += (out.empty() ? "" : "\n") + v.id + " " + v.why;
  return out;
}

void SiteParts::complete(config::MachineRecords& records) const {
  const std::set<std::string> removed(removed_.begin(), removed_.end());
  std::map<std::string, config::RecordFile*> by_asset;
  for (config::RecordFile& r : records) by_asset[r.asset] = &r;
  std::vector<config::RecordFile> missing;
  for (const auto& [path, part] : parts_) {
    if (!is_record(path) || removed.contains(path)) continue;
    const auto found = by_asset.find(asset_of(path));
    const bool is_wrong = found != by_asset.end() && !found->second->record;
    if (part.why.empty() && !is_wrong) continue;
    if (found == by_asset.end()) missing.push_back({asset_of(path), {}, "missing", {}, {}, {}});
    config::RecordFile& file = found == by_asset.end() ? missing.back() : *found->second;
    if (!part.why.empty())
      file.record = tl::unexpected(std::vector<Error>{Error{why_of(path), path}});
    if (const auto copy = storage::read_file(out_ / copies_folder / path))
      if (const auto record = config::parse_machine(*copy, path, file.asset))
        file.maker = record->maker, file.serial = record->serial;
  }
  records.insert(records.end(), std::make_move_iterator(missing.begin()),
                 std::make_move_iterator(missing.end()));
  std::sort(records.begin(), records.end(),
            [](const auto& a, const auto& b) { return a.asset < b.asset; });
}

Expected<void> SiteParts::keep(const evaluation::RunLabel& run) const {
  // The inventory is written before the copies, because the next run would report copies without an
  // inventory as a loss.
  NONIO_TRY(const auto listed, storage::is_there(out_ / inventory_name));
  if (!listed)
    if (auto begun = put_inventory(run, parts_); !begun) return begun;
  std::map<fs::path, std::vector<Artifact>> copies;
  for (const auto& [path, bytes] : renewed_)
    copies[out_ / copies_folder / fs::path(path).parent_path()].push_back(
        {fs::path(path).filename().string(), bytes});
  for (const auto& [folder, files] : copies)
    if (auto written = storage::publish(folder, files); !written) return written;
  std::map<std::string, Part> parts = parts_;
  for (const std::string& path : removed_) {
    parts.erase(path);
    if (auto gone = remove_file(out_ / copies_folder / path); !gone) return gone;
  }
  for (const auto& [path, bytes] : renewed_) parts[path] = {storage::sha256(bytes), {}, {}};
  return put_inventory(run, parts);
}

Expected<void> SiteParts::put_inventory(const evaluation::RunLabel& run,
                                        const std::map<std::string, Part>& parts) const {
  storage::Json json = {{"schema", inventory_schema}, {"night", run.number}, {"date", run.date}};
  json["files"] = storage::Json::object();
  for (const auto& [path, part] : parts) {
    json["files"][path] = {{"sha256", part.sha256}};
    if (!part.why.empty()) json["files"][path]["last_seen"] = part.last_seen;
  }
  return storage::publish(out_, {{inventory_name, storage::dump(json)}});
}

}  // namespace nonio::batch
