// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/kept_machines.h"

#include "laboratory/assessment/bytes.h"
#include "platform/storage/digest.h"

namespace nonio {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Number>
void fields(Io& io, T& n) { io(n.name, n.value, n.quantity); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Finding>
void fields(Io& io, T& f) { io(f.id, f.attention, f.evidence, f.texts, f.measurement, f.advice); }

}  // namespace nonio

namespace nonio::reports {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, OpenValue>
void fields(Io& io, T& v) {
  io(v.axis, v.quantity, v.campaign, v.measurement, v.value, v.u, v.limit, v.unit, v.undecided);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MorningLine>
void fields(Io& io, T& l) {
  io(l.kind, l.state, l.id, l.machine, l.axis, l.quantity, l.campaign, l.customer, l.value, l.u,
     l.limit, l.unit, l.finding, l.since, l.link, l.by, l.until, l.why, l.sure, l.also, l.campaigns,
     l.measurement);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, IntervalProposal>
void fields(Io& io, T& p) { io(p.months, p.method, p.axis, p.quantity, p.why); }

/// Of one without series.
template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MachineHistory>
void fields(Io& io, T& m) {
  io(m.id, m.maker, m.model, m.serial, m.customer, m.place, m.control, m.due, m.why_due, m.file);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MonthOfMachine>
void fields(Io& io, T& m) { io(m.machine, m.month, m.gravest, m.measured, m.event); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, InstrumentUse::On>
void fields(Io& io, T& on) { io(on.campaign, on.date, on.machine, on.number, on.link); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, InstrumentUse>
void fields(Io& io, T& use) { io(use.name, use.certificate, use.valid_until, use.results); }

}  // namespace nonio::reports

namespace nonio::statistics {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Slope>
void fields(Io& io, T& s) { io(s.b, s.u); }

}  // namespace nonio::statistics

namespace nonio::assessment {
namespace fs = std::filesystem;

namespace {

using storage::Database;

constexpr const char* kept_folder = ".nonio";
constexpr const char* machines_name = "machines.sqlite";
/// Another program may find out something else, and come to another trend of the same series.
constexpr std::string_view machines_version = "7 " NONIO_VERSION, trends_version = "3";
constexpr std::size_t digest_size = 64;
constexpr double patience = 5.0;  // s; without the file a run takes longer

constexpr const char* tables =
    "CREATE TABLE version(of TEXT PRIMARY KEY, is_ TEXT NOT NULL);"
    "CREATE TABLE machine(name TEXT PRIMARY KEY, found BLOB NOT NULL, trends BLOB NOT NULL) "
    "WITHOUT ROWID;"
    "CREATE TABLE night(found BLOB NOT NULL)";

std::string signed_bytes(std::string body) { return storage::sha256(body) + body; }

/// The bytes behind their digest; none if they are others.
std::optional<std::string_view> body_of(std::string_view bytes) {
  if (bytes.size() < digest_size) return std::nullopt;
  const std::string_view body = bytes.substr(digest_size);
  if (storage::sha256(body) != bytes.substr(0, digest_size)) return std::nullopt;
  return body;
}

}  // namespace

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Lesson>
void fields(Io& io, T& l) { io(l.quantity, l.points, l.ratios, l.slope); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Manner>
void fields(Io& io, T& m) { io(m.excess, m.spread, m.drift_below); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, SeriesTests::Of>
void fields(Io& io, T& t) { io(t.p, t.declared, t.shows_instrument); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, SeriesTests>
void fields(Io& io, T& t) { io(t.night, t.has_model, t.changes); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, IntervalFacts>
void fields(Io& io, T& f) {
  io(f.maker, f.model, f.days, f.months, f.tested, f.found, f.chart, f.refusal, f.out_now);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, ComparedValue>
void fields(Io& io, T& v) {
  io(v.axis, v.quantity, v.unit, v.value, v.u, v.conditions, v.travel, v.rotary);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Standing>
void fields(Io& io, T& s) {
  io(s.name, s.alone, s.shown, s.compared, s.lines, s.months, s.instruments, s.has_results,
     s.judged, s.conforms, s.attention, s.reversal, s.interval, s.until);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine::Series>
void fields(Io& io, T& s) { io(s.lesson, s.manner, s.tests); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine::Page>
void fields(Io& io, T& p) { io(p.made_from, p.size, p.changed); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine>
void fields(Io& io, T& m) { io(m.rows, m.series, m.stood, m.date, m.standing, m.page); }

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
    ByteReader r(*body);
    KeptMachine machine;
    r(machine);
    if (r.well() && r.at_end()) out.emplace(row[0], std::move(machine));
  });
  if (!file_->take_error()) file_.reset();
  return out;
}

std::map<std::uint64_t, KeptMachines::Night> KeptMachines::nights() {
  std::map<std::uint64_t, Night> out;
  if (!file_ || !has_machines_) return out;
  for (const Database::Row& row : file_->rows("SELECT found FROM night")) {
    const auto body = body_of(row[0]);
    if (!body) continue;
    ByteReader r(*body);
    const auto number = r.get<std::uint64_t>();
    r(out[number].made_from, out[number].asked);
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
  if (changes.machines.empty() && changes.gone.empty() && !changes.nights) return;
  if (!file_) make_anew();  // it is not there, or not to be read
  if (!file_) return;
  if (put(changes)) return;
  file_.reset();
  make_anew();  // what can be read and not written would stay as it is for ever
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
      ByteWriter w;
      w(*of.kept);
      const std::string bytes = signed_bytes(w.take());
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
  if (changes.nights) {
    file_->put("DELETE FROM night");
    for (const auto& [number, night] : *changes.nights) {
      ByteWriter w;
      w(number, night.made_from, night.asked);
      const std::string bytes = signed_bytes(w.take());
      file_->put("INSERT INTO night VALUES(?)", {Database::Blob{bytes}});
    }
  }
  return transaction.end();
}

std::string bytes_of(const std::vector<reports::MorningLine>& lines) {
  ByteWriter w;
  w(lines);
  return w.take();
}

std::string bytes_of(const reports::IntervalProposal& proposal) {
  ByteWriter w;
  w(proposal);
  return w.take();
}

}  // namespace nonio::assessment
