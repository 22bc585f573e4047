// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/store.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <tuple>

#include "campaign/config/manifest.h"
#include "laboratory/store/earlier.h"
#include "laboratory/store/place.h"
#include "laboratory/store/rows.h"
#include "laboratory/store/schema.h"
#include "platform/storage/database.h"
#include "platform/storage/files.h"

namespace nonio::store {
namespace fs = std::filesystem;
using storage::Database;

namespace {

constexpr const char* known_folder = ".nonio";
constexpr const char* known_name = "history";

/// Position of an evaluation in the order of the store.
struct Place {
  std::uint64_t night = 0;
  std::string campaign;
  std::size_t in_chain = 0;  ///< of its campaign
  auto key() const { return std::tie(night, campaign, in_chain); }
};
bool operator<(const Place& a, const Place& b) { return a.key() < b.key(); }

Before before_of(std::int64_t number, const Known& known) {
  return {number, known.entry.campaign_sha256, known.since.version};
}

std::int64_t last_number(Database& database) {
  const std::string last = database.first("SELECT MAX(evaluation) FROM evaluation");
  return last.empty() ? 0 : std::stoll(last);
}

class Filling {
 public:
  Filling(const fs::path& out, Database& database, const std::function<void()>& alive,
          Updated& updated)
      : out_(out), database_(database), alive_(alive), updated_(updated) {}

  /// Everything, into empty tables.
  Expected<void> all() {
    auto places = all_places();
    if (!places) return fail(places.error());
    std::int64_t number = 0;
    std::map<std::string, Before> last;  // of campaigns with more than one evaluation
    for (const Place& place : *places) {
      alive_();
      const auto history =
          history_of(storage::results_folder(out_, place.campaign), place.campaign);
      if (!history || place.in_chain >= history->evaluations.size()) {
        leave_out(place.campaign,
                  history ? "its files changed meanwhile" : history.error().message);
        continue;
      }
      const Known& known = history->evaluations[place.in_chain];
      const auto before = last.find(place.campaign);
      insert(database_, ++number, known, before == last.end() ? Before{} : before->second);
      insert(database_, place.campaign, history->certificates);
      if (history->evaluations.size() > 1) last[place.campaign] = before_of(number, known);
      if (database_.failed()) return database_.take_error();
    }
    updated_.evaluations = static_cast<std::uint64_t>(number);
    return {};
  }

  /// What is new of these campaigns. False: the store does not fit what is there.
  Expected<bool> some(const std::vector<std::string>& campaigns) {
    const Place last = last_place();
    std::map<Place, std::pair<Known, Before>> added;
    for (const std::string& campaign : campaigns) {
      alive_();
      auto history = history_of(storage::results_folder(out_, campaign), campaign);
      if (!history) {
        leave_out(campaign, history.error().message);
        continue;
      }
      const auto rows = database_.rows(
          "SELECT evaluation, evaluation_sha256, campaign_sha256, version FROM evaluation WHERE "
          "campaign = ? ORDER BY evaluation",
          {campaign});
      if (database_.failed()) return fail(database_.take_error().error());
      if (!fits(rows, history->evaluations)) return false;
      std::uint64_t night = 0;
      for (std::size_t i = 0; i < history->evaluations.size(); ++i) {
        night = std::max(night, history->evaluations[i].since.night.number);
        if (i < rows.size()) continue;
        Before before;
        if (i == rows.size() && i > 0)
          before = {std::stoll(rows.back()[0]), rows.back()[2], rows.back()[3]};
        const Place place{night, campaign, i};
        if (place < last) return false;
        added.emplace(place, std::pair(std::move(history->evaluations[i]), std::move(before)));
      }
      insert(database_, campaign, history->certificates);
    }
    return add(std::move(added));
  }

 private:
  static bool fits(const std::vector<Database::Row>& rows, const std::vector<Known>& known) {
    if (rows.size() > known.size()) return false;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i][1] != known[i].since.sha256) return false;
    return true;
  }

  Place last_place() {
    const auto rows =
        database_.rows("SELECT night, campaign FROM evaluation ORDER BY evaluation DESC LIMIT 1");
    return rows.empty() ? Place{} : Place{std::stoull(rows[0][0]), rows[0][1], 0};
  }

  Expected<bool> add(std::map<Place, std::pair<Known, Before>> added) {
    std::int64_t number = last_number(database_) + 1;
    std::map<std::string, Before> last;
    for (auto& [place, what] : added) {
      auto& [known, before] = what;
      if (const auto mine = last.find(place.campaign); mine != last.end()) before = mine->second;
      insert(database_, number, known, before);
      last[place.campaign] = before_of(number, known);
      ++number;
      ++updated_.evaluations;
      alive_();
    }
    if (database_.failed()) return fail(database_.take_error().error());
    return true;
  }

  Expected<std::vector<Place>> all_places() {
    std::vector<Place> places;
    // A chain keeps its order, even if the count of the runs was set back.
    const auto listed = storage::each_results_folder(out_, [&](const fs::path& folder) {
      alive_();
      const std::string campaign = folder.filename().string();
      if (!config::is_campaign_id(campaign)) return;
      const auto record = storage::is_there(folder / evaluation::results_name);
      if (record && !*record) return;
      const auto nights = nights_of(folder);
      if (!nights) return leave_out(campaign, nights.error().message);
      std::uint64_t night = 0;
      for (std::size_t i = 0; i < nights->size(); ++i) {
        night = std::max(night, (*nights)[i]);
        places.push_back({night, campaign, i});
      }
    });
    if (!listed) return fail(listed.error());
    std::sort(places.begin(), places.end());
    return places;
  }

  void leave_out(const std::string& campaign, const std::string& why) {
    std::string line = campaign + ": " + why;
    if (updated_.left_out.empty() || updated_.left_out.back() != line)
      updated_.left_out.push_back(std::move(line));
  }

  const fs::path& out_;
  Database& database_;
  const std::function<void()>& alive_;
  Updated& updated_;
};

Expected<Database> open(const fs::path& out) {
  auto database = Database::open(out / store_name, Database::Use::create);
  if (!database) return database;
  database->rows("PRAGMA cache_size = -65536");  // 64 MB
  if (auto well = database->take_error(); !well) return fail(well.error());
  return database;
}

/// An index is worth nothing where it cannot be read: it is made anew. Another process that has it
/// open is none of that.
Expected<Database> open_or_replace(const fs::path& out, const StorePlace& place) {
  if (place.server) return Database::open(*place.server);
  auto database = open(out);
  if (database) {
    version_of(*database);
    const auto well = database->take_error();
    if (well) return database;
    if (storage::is_locked(well.error())) return fail(well.error());
  } else if (storage::is_locked(database.error())) {
    return database;
  }
  const fs::path path = out / store_name;
  std::error_code error;
  for (const char* suffix : {"-journal", ""})
    if (!fs::remove(fs::path(path.string() + suffix), error) && error)
      return fail("cannot remove " + path.string() + suffix + ": " + error.message());
  return open(out);
}

Expected<void> check_version(std::optional<std::int64_t> version, const std::string& name) {
  if (!version || *version <= schema_version) return {};
  return fail(name + " is of version " + std::to_string(*version) + ", this program writes " +
              std::to_string(schema_version) +
              ": use the newer program, or remove it; it is made again");
}

/// An earlier file would become outdated without notice.
Expected<void> leave_to_server(const fs::path& out, std::int64_t evaluations) {
  std::error_code error;
  const fs::path path = out / store_name;
  if (!fs::remove(path, error) && error)
    return fail("cannot remove " + path.string() + ", which is no longer kept: " + error.message());
  return note_evaluations(out, evaluations);
}

/// In one transaction: all of it or nothing.
Expected<Updated> write(const fs::path& out, bool all, const std::vector<std::string>& campaigns,
                        const Told& told, const std::function<void()>& alive) {
  const auto place = place_of(out);
  if (!place) return fail(place.error());
  auto opened = open_or_replace(out, *place);
  if (!opened) return fail(opened.error());
  Database& database = *opened;
  Updated updated;
  Database::Transaction transaction(database);
  const auto version = version_of(database);
  if (database.failed()) return fail(database.take_error().error());
  if (auto fit = check_version(version, name_of(*place, out)); !fit) return fail(fit.error());
  if (place->server)
    if (auto ours = take_schema(database, out); !ours) return fail(ours.error());
  bool again = all || version != schema_version;
  // A server whose backup was restored, or whose standby took over, has lost the last runs.
  if (!again && place->server) again = last_number(database) != place->evaluations;
  Filling filling(out, database, alive, updated);
  if (!again) {
    const auto added = filling.some(campaigns);
    if (!added) return fail(added.error());
    again = !*added;
  }
  if (again) {
    updated = {0, true, {}};
    make_tables(database);
    if (auto filled = filling.all(); !filled) return fail(filled.error());
  }
  replace_logs(database, told.logs, told.aliases, told.of_records, told.due);
  const std::int64_t last = last_number(database);
  if (auto ended = transaction.end(); !ended) return fail(ended.error());
  if (place->server)
    if (auto noted = leave_to_server(out, last); !noted) return fail(noted.error());
  return updated;
}

}  // namespace

Expected<Updated> update(const fs::path& out, bool behind, std::vector<std::string> campaigns,
                         const Told& told, const std::function<void()>& alive) {
  std::sort(campaigns.begin(), campaigns.end());
  campaigns.erase(std::unique(campaigns.begin(), campaigns.end()), campaigns.end());
  return write(out, behind, campaigns, told, alive);
}

Expected<Updated> rebuild(const fs::path& out, const Told& told,
                          const std::function<void()>& alive) {
  return write(out, true, {}, told, alive);
}

Expected<std::optional<std::uint64_t>> known_night(const fs::path& out) {
  const fs::path path = out / known_folder / known_name;
  const auto there = storage::is_there(path);
  if (!there) return fail(there.error());
  if (!*there) return std::nullopt;
  const auto text = storage::read_small_file(path);
  if (!text) return fail(text.error());
  std::uint64_t night = 0;
  const char* const end = text->data() + text->size();
  const auto [at, error] = std::from_chars(text->data(), end, night);
  if (error != std::errc() || std::string_view(at, end) != "\n") return std::nullopt;
  return night;
}

Expected<void> forget_known_night(const fs::path& out) {
  // Written over and not removed: there are shares on which nothing can be removed.
  return storage::publish(out / known_folder, {{known_name, "none\n"}});
}

Expected<void> note_known_night(const fs::path& out, std::uint64_t night) {
  return storage::publish(out / known_folder, {{known_name, std::to_string(night) + "\n"}});
}

}  // namespace nonio::store
