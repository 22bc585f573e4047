// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/register.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "database.h"
#include "nonio/host/digest.h"
#include "nonio/host/files.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

constexpr const char* schema = R"(
CREATE TABLE counters(
  sequence TEXT PRIMARY KEY,  -- the pattern with its year: each has its own numbers
  last INTEGER NOT NULL
) WITHOUT ROWID;
CREATE TABLE certificates(
  id INTEGER PRIMARY KEY,
  number TEXT NOT NULL UNIQUE,
  campaign TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('drawn', 'issued', 'withdrawn')),
  date TEXT NOT NULL,  -- of issue; while drawn: of the day on which it was drawn
  issued INTEGER UNIQUE,  -- order of issue
  replaces INTEGER REFERENCES certificates(id),
  reason TEXT NOT NULL,  -- why it was withdrawn, or is not issued yet
  output TEXT, templates TEXT, readings TEXT,
  results BLOB
);
CREATE INDEX of_campaign ON certificates(campaign);
CREATE UNIQUE INDEX one_draft ON certificates(campaign) WHERE state = 'drawn';
CREATE TABLE inputs(
  certificate INTEGER NOT NULL REFERENCES certificates(id),
  place INTEGER NOT NULL,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  PRIMARY KEY(certificate, place)
) WITHOUT ROWID;
CREATE TABLE files(
  certificate INTEGER NOT NULL REFERENCES certificates(id),
  place INTEGER NOT NULL,
  output TEXT NOT NULL,
  name TEXT NOT NULL,
  no_time_stamp TEXT NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY(certificate, place)
);
)";
constexpr std::int64_t application = 0x4e6f6e69;  // marks the file as one of these

std::int64_t integer(const std::string& text) { return std::strtoll(text.c_str(), nullptr, 10); }

/// Of a register that was made just now, or by this version.
Expected<void> make_tables(Database& database) {
  const auto is_marked = [&] {
    return integer(database.first("PRAGMA application_id")) == application;
  };
  const auto is_made = [&] { return is_marked() && database.first("PRAGMA user_version") == "1"; };
  const bool made = is_made();
  if (auto well = database.take_error(); !well || made) return well;
  Database::Transaction transaction(database);
  if (is_made()) return transaction.end();  // somebody else was faster
  if (database.first("SELECT count(*) FROM sqlite_schema") != "0" && !database.failed())
    return fail(is_marked() ? "was written by a newer version of Nonio"
                            : "is no register of certificates");
  database.script(schema);
  database.script("PRAGMA user_version = 1; PRAGMA application_id = " +
                  std::to_string(application));
  return transaction.end();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// The place for the number in a pattern: "{number:4}".
struct Place {
  std::size_t begin = std::string::npos, size = 0, digits = 1;
};

Place place_of(const std::string& pattern) {
  constexpr std::string_view plain = "{number}", open = "{number:";
  Place place{pattern.find(plain), plain.size()};
  if (place.begin != std::string::npos) return place;
  const std::size_t at = pattern.find(open);
  const std::size_t digit = at + open.size();
  if (at == std::string::npos || digit + 1 >= pattern.size() || pattern[digit] < '1' ||
      pattern[digit] > '9' || pattern[digit + 1] != '}')
    return place;
  return {at, open.size() + 2, static_cast<std::size_t>(pattern[digit] - '0')};
}

/// One counter each, however many digits it prints.
std::string sequence_of(const std::string& pattern, const std::string& year) {
  const Place place = place_of(pattern);
  std::string sequence = pattern;
  if (place.begin != std::string::npos) sequence.replace(place.begin, place.size, "{number}");
  return replaced(sequence, "{year}", year);
}

/// What is other in `now` than it was, in the order of `now`; then what is gone.
std::vector<std::string> differences(const Inputs& before, const Inputs& now) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& input) {
    const std::string prefix = input_name("");
    names.push_back(input.starts_with(prefix) ? input.substr(prefix.size()) : input);
  };
  const auto lacks = [](const Inputs& all, const Inputs::value_type& one, bool by_name) {
    return std::none_of(all.begin(), all.end(), [&](const auto& other) {
      return other.first == one.first && (by_name || other.second == one.second);
    });
  };
  for (const auto& one : now)
    if (lacks(before, one, false)) add(one.first);
  for (const auto& one : before)
    if (lacks(now, one, true)) add(one.first);
  return names;
}

}  // namespace

Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number) {
  constexpr std::size_t longest = 60;
  const auto refuse = [&](const std::string& what) {
    return fail("the pattern \"" + pattern + "\" " + what);
  };
  const Place place = place_of(pattern);
  if (place.begin == std::string::npos)
    return refuse(
        "has no place for the number; wanted {number} or {number:4} once, and {year} if the "
        "numbers are to begin anew with each year");
  std::string digits = std::to_string(number);
  digits.insert(0, place.digits > digits.size() ? place.digits - digits.size() : 0, '0');
  std::string text = pattern;
  text.replace(place.begin, place.size, digits);
  text = replaced(text, "{year}", year);
  if (text.find_first_of("{}") != std::string::npos)
    return refuse("has another place than {year} and one {number}");
  const bool plain =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!plain || !is_artifact_name(text) || text.front() == ' ' || text.back() == ' ' ||
      text.size() > longest)
    return refuse("gives \"" + text +
                  "\"; wanted at most 60 letters, digits and signs of ASCII without / and \\, no "
                  "dot at the beginning, no blank at the ends: files are named by it");
  return text;
}

Expected<fs::path> register_path(const fs::path& site, const Numbering& numbering) {
  auto path = path_inside(site, numbering.register_file);
  if (!path)
    return fail("[certificate] register = \"" + numbering.register_file +
                "\" in site.toml is not the path of a file inside the site");
  return path;
}

Register::Register(std::unique_ptr<Database> database, std::string pattern)
    : database_(std::move(database)), pattern_(std::move(pattern)) {}
Register::Register(Register&&) noexcept = default;
Register& Register::operator=(Register&&) noexcept = default;
Register::~Register() = default;

Expected<Register> Register::open(const fs::path& site, const Numbering& numbering) {
  const auto path = register_path(site, numbering);
  if (!path) return fail(path.error());
  std::error_code error;
  fs::create_directories(path->parent_path(), error);
  auto database = Database::open(*path, true);
  if (!database) return fail("the register of certificates: " + database.error().message);
  auto place = std::make_unique<Database>(std::move(*database));
  if (auto made = make_tables(*place); !made)
    return fail("the register of certificates " + path->string() + ": " + made.error().message);
  return Register(std::move(place), numbering.pattern);
}

Expected<std::vector<RegisterEntry>> Register::entries(const fs::path& site,
                                                       const Numbering& numbering) {
  std::vector<RegisterEntry> entries;
  const auto path = register_path(site, numbering);
  if (!path) return fail(path.error());
  if (std::error_code error; !fs::exists(*path, error)) return entries;
  auto opened = open(site, numbering);
  if (!opened) return fail(opened.error());
  Database& database = *opened->database_;
  for (Database::Row& row : database.rows(R"(
      SELECT c.number, c.campaign, c.date, old.number, c.reason, c.issued,
        CASE WHEN c.state = 'issued' AND new.id IS NOT NULL THEN 'amended' ELSE c.state END,
        new.number
      FROM certificates c LEFT JOIN certificates old ON old.id = c.replaces
        LEFT JOIN certificates new ON new.replaces = c.id AND new.state <> 'drawn'
      ORDER BY c.id)"))
    entries.push_back({std::move(row[0]), std::move(row[1]), std::move(row[6]), std::move(row[2]),
                       std::move(row[3]), std::move(row[7]), std::move(row[4]),
                       static_cast<std::uint64_t>(integer(row[5]))});
  if (auto well = database.take_error(); !well) return fail(well.error());
  return entries;
}

Inputs Register::inputs_of(std::int64_t id) {
  Inputs inputs;
  for (Database::Row& row : database_->rows(
           "SELECT name, sha256 FROM inputs WHERE certificate = ? ORDER BY place", {id}))
    inputs.emplace_back(std::move(row[0]), std::move(row[1]));
  return inputs;
}

std::vector<IssuedFile> Register::files_of(std::int64_t id) {
  std::vector<IssuedFile> files;
  for (Database::Row& row :
       database_->rows("SELECT output, name, bytes, no_time_stamp FROM files WHERE certificate = ? "
                       "ORDER BY place",
                       {id}))
    files.push_back({std::move(row[0]), std::move(row[1]), std::move(row[2]), std::move(row[3])});
  return files;
}

void Register::note_replaced(std::int64_t id, Issue& issue) {
  issue.replaces_readings =
      database_->first("SELECT readings FROM certificates WHERE id = ?", {id});
  for (const IssuedFile& file : files_of(id))
    if (issue.replaces_file.empty() || file.name.ends_with(".xml")) {
      issue.replaces_file = file.name;
      issue.replaces_sha256 = sha256(file.bytes);
    }
}

Certificate Register::load(std::int64_t id) {
  Certificate certificate;
  auto rows = database_->rows(
      "SELECT c.number, c.date, c.readings, c.output, c.templates, c.results, old.id, old.number, "
      "old.date FROM certificates c LEFT JOIN certificates old ON old.id = c.replaces "
      "WHERE c.id = ?",
      {id});
  if (rows.empty()) return certificate;
  Database::Row& row = rows.front();
  Issue& issue = certificate.issue;
  issue = {std::move(row[0]), std::move(row[1]), std::move(row[7]), std::move(row[8]), {},
           std::move(row[2])};
  if (!issue.replaces.empty()) {
    issue.changes = differences(inputs_of(integer(row[6])), inputs_of(id));
    note_replaced(integer(row[6]), issue);
  }
  certificate.output = std::move(row[3]);
  certificate.templates_sha256 = std::move(row[4]);
  certificate.results = std::move(row[5]);
  certificate.files = files_of(id);
  certificate.issued = true;
  return certificate;
}

namespace {

/// The entry that a campaign was issued last.
constexpr const char* last_of_campaign =
    "SELECT id, state, number, date FROM certificates WHERE campaign = ? AND issued IS NOT NULL "
    "ORDER BY issued DESC LIMIT 1";

}  // namespace

std::optional<Certificate> Register::last(const std::string& campaign, const Inputs& data) {
  const auto rows = database_->rows(last_of_campaign, {campaign});
  if (rows.empty() || rows.front()[1] != "issued") return std::nullopt;
  const std::int64_t id = integer(rows.front()[0]);
  if (inputs_of(id) != data) return std::nullopt;
  return load(id);
}

Expected<std::optional<Certificate>> Register::find(const std::string& campaign,
                                                    const Inputs& data) {
  auto found = last(campaign, data);
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return found;
}

Expected<std::string> Register::next_number(const std::string& year) {
  const std::string sequence = sequence_of(pattern_, year);
  for (;;) {
    const std::int64_t number =
        integer(database_->first("INSERT INTO counters VALUES(?, 1) ON CONFLICT(sequence) "
                                 "DO UPDATE SET last = last + 1 RETURNING last",
                                 {sequence}));
    auto text = number_text(pattern_, year, static_cast<std::uint64_t>(number));
    // With another pattern before it may have been used.
    if (!text || database_->failed() ||
        database_->first("SELECT count(*) FROM certificates WHERE number = ?", {*text}) == "0")
      return text;
  }
}

Expected<Certificate> Register::draw(const std::string& campaign, const Inputs& data,
                                     const std::string& today) {
  Database& db = *database_;
  Database::Transaction transaction(db);
  if (auto issued = last(campaign, data)) {
    if (auto ended = transaction.end(); !ended) return fail(ended.error());
    return std::move(*issued);
  }
  Certificate drawn;
  const std::string unfinished = "the run of " + today + " ended before it was issued";
  drawn.issue.date = today;
  drawn.issue.number = db.first(
      "UPDATE certificates SET date = ?, reason = ? WHERE campaign = ? AND "
      "state = 'drawn' RETURNING number",
      {today, unfinished, campaign});
  if (drawn.issue.number.empty()) {
    auto number = next_number(today.substr(0, 4));
    if (!number) return fail(number.error());
    drawn.issue.number = std::move(*number);
    db.rows(
        "INSERT INTO certificates(number, campaign, state, date, reason) "
        "VALUES(?, ?, 'drawn', ?, ?)",
        {drawn.issue.number, campaign, today, unfinished});
  }
  if (const auto old = db.rows(last_of_campaign, {campaign}); !old.empty()) {
    drawn.issue.replaces = old.front()[2];
    drawn.issue.replaces_date = old.front()[3];
    drawn.issue.changes = differences(inputs_of(integer(old.front()[0])), data);
    note_replaced(integer(old.front()[0]), drawn.issue);
  }
  if (auto ended = transaction.end(); !ended) return fail(ended.error());
  return drawn;
}

Expected<Certificate> Register::issue(const Certificate& certificate, const std::string& campaign,
                                      const Inputs& data) {
  Database& db = *database_;
  const Issue& issue = certificate.issue;
  Database::Transaction transaction(db);
  const auto found = db.rows("SELECT id, state FROM certificates WHERE number = ? AND campaign = ?",
                             {issue.number, campaign});
  if (found.empty())
    return fail(db.failed() ? transaction.end().error().message
                            : "the register does not know the number " + issue.number);
  const std::int64_t id = integer(found.front()[0]);
  if (found.front()[1] == "issued" && inputs_of(id) == data) {
    Certificate first = load(id);
    if (auto ended = transaction.end(); !ended) return fail(ended.error());
    return first;
  }
  if (found.front()[1] != "drawn")
    return fail("another run has issued " + issue.number +
                " meanwhile, for other data of this campaign");
  db.rows(
      "UPDATE certificates SET state = 'issued', date = ?, reason = '', output = ?, templates = ?, "
      "readings = ?, results = ?, replaces = (SELECT id FROM certificates WHERE number = ?), "
      "issued = (SELECT 1 + coalesce(max(issued), 0) FROM certificates) WHERE id = ?",
      {issue.date, certificate.output, certificate.templates_sha256, issue.readings_sha256,
       Database::Blob{certificate.results}, issue.replaces, id});
  std::int64_t place = 0;
  for (const auto& [name, digest] : data)
    db.rows("INSERT INTO inputs VALUES(?, ?, ?, ?)", {id, place++, name, digest});
  for (const IssuedFile& f : certificate.files)
    db.rows("INSERT INTO files VALUES(?, ?, ?, ?, ?, ?)",
            {id, place++, f.output, f.name, f.no_time_stamp, Database::Blob{f.bytes}});
  if (auto ended = transaction.end(); !ended) return fail(ended.error());
  Certificate done = certificate;
  done.issued = true;
  return done;
}

Expected<void> Register::note_failure(const std::string& campaign, const std::string& why) {
  Database::Transaction transaction(*database_);
  database_->rows("UPDATE certificates SET reason = ? WHERE campaign = ? AND state = 'drawn'",
                  {why, campaign});
  return transaction.end();
}

Expected<void> Register::withdraw(const std::string& number, const std::string& why) {
  Database& db = *database_;
  Database::Transaction transaction(db);
  const auto found = db.rows(
      "SELECT c.id, c.state, new.number FROM certificates c LEFT JOIN certificates new "
      "ON new.replaces = c.id AND new.state <> 'drawn' WHERE c.number = ?",
      {number});
  if (auto well = db.take_error(); !well) return well;
  if (found.empty()) return fail("no number " + number + " was ever drawn");
  const auto& entry = found.front();
  if (entry[1] == "drawn") return fail(number + " was never issued: there is nothing to withdraw");
  if (entry[1] == "withdrawn") return fail(number + " is withdrawn already");
  if (!entry[2].empty())
    return fail(number + " was replaced by " + entry[2] + ": that is the one to withdraw");
  db.rows("UPDATE certificates SET state = 'withdrawn', reason = ? WHERE id = ?",
          {why, integer(entry[0])});
  return transaction.end();
}

Expected<std::vector<IssuedFile>> Register::files(const std::string& number) {
  auto files =
      files_of(integer(database_->first("SELECT id FROM certificates WHERE number = ?", {number})));
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return files;
}

}  // namespace nonio::host
