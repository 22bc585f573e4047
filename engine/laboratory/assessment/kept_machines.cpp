// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/kept_machines.h"

#include "laboratory/assessment/fits.h"
#include "platform/storage/digest.h"
#include "platform/storage/serialise.h"

namespace nonio::storage {

NONIO_MEMBERS(Number, a, b, c)
NONIO_MEMBERS(Finding, a, b, c, d, e, f)
NONIO_MEMBERS(reports::OpenValue, a, b, c, d, e, f, g, h, i, j)
NONIO_MEMBERS(reports::WorkItem, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v,
              w)
NONIO_MEMBERS(reports::IntervalProposal, a, b, c, d, e)
/// The series of the machine are not stored.
template <class Archive, class T>
requires std::same_as<std::remove_const_t<T>, reports::MachineHistory>
void members(Archive& archive, T& m) {
  archive(m.id, m.maker, m.model, m.serial, m.customer, m.place, m.control, m.due, m.why_due,
          m.file);
}
NONIO_MEMBERS(reports::MonthOfMachine, a, b, c, d, e)
NONIO_MEMBERS(reports::InstrumentUse::On, a, b, c, d, e)
NONIO_MEMBERS(reports::InstrumentUse, a, b, c, d)
NONIO_MEMBERS(assessment::Lesson, a, b, c, d)
NONIO_MEMBERS(assessment::Manner, a, b, c)
NONIO_MEMBERS(assessment::SeriesTests::Of, a, b, c)
NONIO_MEMBERS(assessment::SeriesTests, a, b, c)
NONIO_MEMBERS(assessment::IntervalFacts, a, b, c, d, e, f, g, h, i)
NONIO_MEMBERS(assessment::ComparedValue, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(assessment::Standing, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
NONIO_MEMBERS(assessment::KeptMachine::Series, a, b, c)
NONIO_MEMBERS(assessment::KeptMachine::Page, a, b, c)
NONIO_MEMBERS(assessment::KeptMachine, a, b, c, d, e, f)

}  // namespace nonio::storage

namespace nonio::assessment {
namespace fs = std::filesystem;

namespace {

using storage::Database;

constexpr const char* kept_folder = ".nonio";
constexpr const char* machines_name = "machines.sqlite";
/// Must change if a version of the program may compute other results or trends.
constexpr std::string_view machines_version = "14 " NONIO_VERSION, trends_version = "6";
constexpr std::size_t digest_size = 64;
constexpr double patience = 5.0;  // s; without the file, everything is computed again

constexpr const char* tables =
    "CREATE TABLE version(of TEXT PRIMARY KEY, is_ TEXT NOT NULL);"
    "CREATE TABLE machine(name TEXT PRIMARY KEY, found BLOB NOT NULL, trends BLOB NOT NULL) "
    "WITHOUT ROWID;CREATE TABLE night(found BLOB NOT NULL)";

std::string signed_bytes(std::string body) { return storage::sha256(body) + body; }

std::optional<std::string_view> body_of(std::string_view bytes) {
  if (bytes.size() < digest_size) return std::nullopt;
  const std::string_view body = bytes.substr(digest_size);
  if (storage::sha256(body) != bytes.substr(0, digest_size)) return std::nullopt;
  return body;
}

}  // namespace

KeptMachines::KeptMachines(fs::path out) : out_(std::move(out)) {
  std::error_code error;
  if (fs::exists(out_ / kept_folder / machines_name, error)) open();
}

void KeptMachines::open() {
  auto file = Database::open(out_ / kept_folder / machines_name, Database::Use::write, patience);
  if (!file) return;
  file_ = std::move(*file);
  if (!is_readable()) file_.reset();
}

bool KeptMachines::is_readable() {
  if (file_->first("SELECT is_ FROM version WHERE of = 'trends'") != trends_version) return false;
  has_machines_ = file_->first("SELECT is_ FROM version WHERE of = 'machines'") == machines_version;
  return static_cast<bool>(file_->take_error());
}

std::map<std::string, KeptMachine> KeptMachines::machines() {
  std::map<std::string, KeptMachine> out;
  if (!file_ || !has_machines_) return out;
  file_->each("SELECT name, found FROM machine", {}, [&](const std::vector<std::string_view>& row) {
    const auto body = body_of(row[1]);
    if (!body) return;
    KeptMachine machine;
    if (storage::unpack(*body, machine)) out.emplace(row[0], std::move(machine));
  });
  if (!file_->take_error()) file_.reset();
  return out;
}

std::map<std::uint64_t, KeptMachines::RunResult> KeptMachines::runs() {
  std::map<std::uint64_t, RunResult> out;
  if (!file_ || !has_machines_) return out;
  for (const Database::Row& row : file_->rows("SELECT found FROM night")) {
    const auto body = body_of(row[0]);
    if (!body) continue;
    std::uint64_t number = 0;
    RunResult run;
    if (storage::unpack(*body, number, run.made_from, run.asked)) out[number] = run;
  }
  if (!file_->take_error()) file_.reset();
  return out;
}

std::string KeptMachines::trends_of(const std::string& machine) {
  if (!file_) return {};
  const std::string bytes = file_->first("SELECT trends FROM machine WHERE name = ?", {machine});
  if (!file_->take_error()) file_.reset();
  return std::string(body_of(bytes).value_or(""));
}

void KeptMachines::make_anew() {
  const fs::path path = out_ / kept_folder / machines_name;
  std::error_code ignored;
  for (const char* end : {"", "-journal"}) fs::remove(path.string() + end, ignored);
  auto made = Database::open(path, Database::Use::create, patience);
  if (!made) return;
  file_ = std::move(*made);
  has_machines_ = false;
  file_->script(tables);
  file_->put("INSERT INTO version VALUES('trends', ?)", {trends_version});
}

void KeptMachines::keep(const Changes& changes) {
  if (changes.machines.empty() && changes.gone.empty() && !changes.runs) return;
  if (!file_) make_anew();
  if (!file_) return;
  if (put(changes)) return;
  file_.reset();
  make_anew();  // a file that can be read but not written would never be updated
}

Expected<void> KeptMachines::put(const Changes& changes) {
  Database::Transaction transaction(*file_);
  if (!has_machines_) {
    file_->put("UPDATE machine SET found = x''");
    file_->put("DELETE FROM night");
    file_->put("INSERT OR REPLACE INTO version VALUES('machines', ?)", {machines_version});
  }
  for (const Changes::Of& of : changes.machines) {
    file_->put("INSERT OR IGNORE INTO machine VALUES(?, x'', x'')", {of.machine});
    if (of.kept != nullptr) {
      const std::string bytes = signed_bytes(storage::pack(*of.kept));
      file_->put("UPDATE machine SET found = ? WHERE name = ?",
                 {Database::Blob{bytes}, of.machine});
    }
    if (of.trends) {
      const std::string bytes = signed_bytes(*of.trends);
      file_->put("UPDATE machine SET trends = ? WHERE name = ?",
                 {Database::Blob{bytes}, of.machine});
    }
  }
  for (const std::string& name : changes.gone)
    file_->put("DELETE FROM machine WHERE name = ?", {name});
  if (changes.runs) {
    file_->put("DELETE FROM night");
    for (const auto& [number, run] : *changes.runs) {
      const std::string bytes = signed_bytes(storage::pack(number, run.made_from, run.asked));
      file_->put("INSERT INTO night VALUES(?)", {Database::Blob{bytes}});
    }
  }
  return transaction.end();
}

std::string bytes_of(const std::vector<reports::WorkItem>& lines) { return storage::pack(lines); }

std::string bytes_of(const reports::IntervalProposal& proposal) { return storage::pack(proposal); }

}  // namespace nonio::assessment
