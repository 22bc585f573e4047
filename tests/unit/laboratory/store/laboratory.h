// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "campaign/evaluation/status.h"
#include "laboratory/store/earlier.h"
#include "laboratory/store/place.h"
#include "laboratory/store/schema.h"
#include "laboratory/store/store.h"
#include "platform/storage/database.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

/// An output folder as runs leave it, made without a run.
namespace nonio::test {
namespace fs = std::filesystem;
namespace history = store;
namespace evaluation = evaluation;

/// results.json of one campaign, as far as the history reads it.
struct Made {
  std::string id, day = "2026-01-05", asset = "S-1", purpose{}, serial = "0417";
  double scale = 1.25, b_mean = -5.0;
  std::string certificate{};
  std::string status = "ok";
  std::string A = "7.5", decision = "conforms";
  std::string analyses{}, followed{};  ///< JSON, put behind those that all have
  bool manifest_read = false;  ///< of a campaign that failed: its machine and date are known
  std::string json() const {
    const auto number = [](double x) { return std::to_string(x); };
    if (status == "failed")
      return "{\n \"schema\": \"nonio-results/1\",\n \"campaign\": {\"id\": \"" + id + "\"" +
             (manifest_read
                  ? ", \"date\": \"" + day + "\", \"machine\": {\"asset\": \"" + asset + "\"}"
                  : "") +
             "},\n \"status\": \"failed\",\n \"errors\": [{\"message\": \"no readings\"}],\n "
             "\"analyses\": []\n}\n";
    return "{\n \"schema\": \"nonio-results/1\",\n \"campaign\": {\"id\": \"" + id +
           "\", \"date\": \"" + day + "\", " +
           (purpose.empty() ? "" : "\"purpose\": \"" + purpose + "\", ") +
           "\"machine\": {\"maker\": \"M\", \"model\": \"V\", \"serial\": \"" + serial +
           "\", \"asset\": \"" + asset +
           "\"}, \"instrument\": {\"maker\": \"O\", \"serial\": \"L-1\", \"certificate\": "
           "\"C-7\", \"calibrated\": \"2026-01-01\"}},\n \"status\": \"" +
           status +
           "\",\n \"errors\": [],\n \"analyses\": [{\"plugin\": \"iso230-2\", \"version\": \"1\", "
           "\"measurement\": \"X\", \"values\": {\"A\": {\"value\": " +
           A + ", \"unit\": \"um\", \"U\": 1.9, \"k\": 2.0, \"tolerance\": 10.0, \"decision\": \"" +
           decision +
           "\"}}, \"budget\": "
           "{\"results\": {\"A\": {\"u\": {\"device\": 0.3, \"expansion\": 0.4, \"drift\": "
           "0.5}}}}, \"findings\": [{\"id\": \"reversal.constant\", \"severity\": "
           "\"attention\"}]}" +
           analyses +
           "],\n \"followed\": [{\"measurement\": \"X\", \"axis\": \"X\", "
           "\"quantity\": \"scale\", \"unit\": \"um/m\", \"value\": " +
           number(scale) +
           ", \"u\": 0.1, \"state\": \"as-found\", \"common\": [{\"source\": \"instrument O L-1 "
           "C-7 2026-01-01\", \"u\": 0.3}, {\"source\": \"expansion of axis X\", \"u\": -0.4}], "
           "\"conditions\": {\"from\": 0.0, \"to\": 800.0}, \"not_stated\": [\"a.b\", \"c.d\"]}, "
           "{\"measurement\": \"X\", \"axis\": \"X\", \"quantity\": \"B_mean\", \"unit\": \"um\", "
           "\"value\": " +
           number(b_mean) + ", \"u\": 0.2, \"state\": \"as-found\"}" + followed +
           "],\n \"followed_covariance\": [{\"first\": 0, "
           "\"count\": 2, \"upper\": [0.01, -0.001, 0.04]}]" +
           (certificate.empty() ? ""
                                : ",\n \"certificate\": {\"plugin\": \"certificate\", \"number\": "
                                  "\"" +
                                      certificate + "\", \"date\": \"2026-02-01\"}") +
           "\n}\n";
  }
};

/// The server of these tests; none: they keep the store in SQLite files.
#ifdef NONIO_TEST_POSTGRESQL
inline constexpr bool on_server = true;
#else
inline constexpr bool on_server = false;
#endif

class Output {
 public:
  explicit Output(const std::string& name)
      : root_(fs::temp_directory_path() /
              ("nonio-history-" + name + "-" + std::to_string(::getpid()))) {
    fs::remove_all(root_);
    fs::create_directories(root_ / ".nonio");
    if (!on_server) return;
    const char* url = std::getenv("NONIO_TEST_DATABASE");
    if (url == nullptr) throw std::runtime_error("there is no NONIO_TEST_DATABASE");
    schema_ = name + "_" + std::to_string(::getpid());
    if (!store::note_place(root_, storage::Server{url, schema_, {}}))
      throw std::runtime_error("cannot note the place of the store");
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output() {
    if (on_server) lose_store();
    fs::remove_all(root_);
  }
  /// As if there had never been one.
  void lose_store() const {
    if (on_server) {
      const auto place = store::place_of(root_);
      auto database = storage::Database::open(*place->server);
      database->script("DROP SCHEMA IF EXISTS \"" + schema_ + "\" CASCADE");
    } else {
      fs::remove(root_ / store::store_name);
    }
  }
  /// As messages name the store.
  std::string store_words() const {
    return on_server ? "schema " + schema_ : (root_ / store::store_name).string();
  }
  const fs::path& root() const { return root_; }

  static void write(const fs::path& path, const std::string& bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
  }

  /// As a worker of run `run` stores it. `readings`: digest of the file. False: refused.
  bool store(const Made& made, std::uint64_t run, const std::string& readings,
             const std::string& version = "1.0", bool retry = false) {
    const fs::path folder = root_ / made.id;
    evaluation::Record record;
    record.folder = made.id;
    record.run = run;
    record.date = "2026-03-0" + std::to_string(run % 10);
    record.status = evaluation::status_named(made.status).value();
    record.retry = retry;
    record.certificate = made.certificate;
    record.inputs = {{"site.toml", "s"},
                     {"version", version},
                     {"campaign.toml", "m" + made.id},
                     {"file x.csv", readings}};
    const std::string results = made.json();
    const auto carried = store::carry_over(folder, record, results, made.id);
    if (!carried) {
      why_ = carried.error().message;
      return false;
    }
    record.indexed = carried->indexed;
    const auto last = evaluation::read_record(folder);
    if (retry && last && last->status != evaluation::Status::failed) {
      fs::remove_all(folder / "last-good");
      fs::create_directories(folder / "last-good");
      for (const char* name : {"results.json", "run.json", "earlier.json"})
        if (fs::exists(folder / name)) fs::rename(folder / name, folder / "last-good" / name);
    }
    if (!retry) fs::remove_all(folder / "last-good");
    record.files.push_back({"results.json", results.size(), storage::sha256(results)});
    if (!carried->earlier.empty()) write(folder / "earlier.json", carried->earlier);
    write(folder / "results.json", results);
    write(folder / "run.json", evaluation::to_json(record));
    return true;
  }
  const std::string& why() const { return why_; }

 private:
  fs::path root_;
  std::string why_, schema_;
};

inline Expected<storage::Database> open_to_look(const fs::path& out) {
  const auto place = store::place_of(out);
  if (!place) return fail(place.error());
  if (place->server) return storage::Database::open(*place->server);
  return storage::Database::open(out / store::store_name, storage::Database::Use::write);
}

/// All rows of all tables and of the view, in order.
inline std::string rows_of(const fs::path& out) {
  auto database = open_to_look(out);
  if (!database) return "no store: " + database.error().message;
  std::string all;
  for (const std::string of :
       {"store ORDER BY name", "machine ORDER BY machine",
        "campaign ORDER BY campaign, campaign_sha256", "evaluation ORDER BY evaluation",
        "result ORDER BY evaluation, item", "common_part ORDER BY evaluation, item, part",
        "covariance ORDER BY evaluation, first_item", "finding ORDER BY evaluation, item",
        "certificate ORDER BY number", "machine_alias ORDER BY alias", "event ORDER BY item",
        "acknowledgement ORDER BY item", "forgotten ORDER BY item", "due_rule ORDER BY machine",
        "point ORDER BY evaluation, item"}) {
    all += of + "\n";
    for (const auto& row : database->rows(("SELECT * FROM " + of).c_str())) {
      for (const std::string& cell : row) all += cell + '|';
      all += '\n';
    }
  }
  if (auto well = database->take_error(); !well) all += "ERROR " + well.error().message;
  return all;
}

inline std::string ask(const fs::path& out, const char* sql) {
  auto database = open_to_look(out);
  if (!database) return database.error().message;
  std::string all;
  for (const auto& row : database->rows(sql)) {
    for (const std::string& cell : row) all += (&cell == &row.front() ? "" : "|") + cell;
    all += ';';
  }
  if (auto well = database->take_error(); !well) return well.error().message;
  return all;
}

inline void nothing() {}

}  // namespace nonio::test
