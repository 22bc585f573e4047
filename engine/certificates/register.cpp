// SPDX-License-Identifier: Apache-2.0
#include "certificates/register.h"

#include <algorithm>
#include <utility>

#include "campaign/config/number_pattern.h"
#include "campaign/evaluation/results_json.h"
#include "certificates/journal.h"
#include "certificates/register_place.h"
#include "certificates/register_tables.h"
#include "nonio/sign/verify.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

/// Returns the inputs that differ in `now`, in the order of `now`, followed by removed ones.
std::vector<FileChange> differences(const reading::Inputs& before, const reading::Inputs& now) {
  std::vector<FileChange> names;
  const auto add = [&](const std::string& input) {
    const std::string prefix = reading::input_name("");
    names.push_back({input.starts_with(prefix) ? input.substr(prefix.size()) : input});
  };
  const auto lacks = [](const reading::Inputs& all, const reading::Inputs::value_type& one,
                        bool by_name) {
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

Expected<fs::path> register_path(const fs::path& site, const config::Numbering& numbering) {
  auto path = storage::path_inside(site, numbering.register_file);
  if (!path)
    return fail(
        "[certificate] register = \"" + numbering.register_file +
        "\" in site.toml is not the path of a file inside the site: " + path.error().message);
  return path;
}

Register::Register(std::unique_ptr<storage::Database> database, const RegisterPlace& place,
                   std::string pattern)
    : database_(std::move(database)),
      place_(std::make_unique<RegisterPlace>(place)),
      pattern_(std::move(pattern)) {}
Register::Register(Register&&) noexcept = default;
Register::~Register() = default;

Expected<Register> Register::open(const fs::path& site, const config::Numbering& numbering,
                                  double patience) {
  NONIO_TRY(const auto place, register_place(site, numbering));
  NONIO_TRY(auto database, open_register(place, storage::Database::Use::create, patience));
  return Register(std::make_unique<storage::Database>(std::move(database)), place,
                  numbering.pattern);
}

Expected<Register> Register::open_to_audit(const fs::path& site,
                                           const config::Numbering& numbering) {
  NONIO_TRY(const auto place, register_place(site, numbering));
  NONIO_TRY(auto database, open_register(place, storage::Database::Use::create,
                                         storage::Database::usual_patience, true));
  return Register(std::make_unique<storage::Database>(std::move(database)), place,
                  numbering.pattern);
}

Expected<Register> Register::open_to_read(const fs::path& site,
                                          const config::Numbering& numbering) {
  NONIO_TRY(const auto place, register_place(site, numbering));
  // Opened for writing, so that an unfinished transaction of a killed process is rolled back.
  auto database =
      open_register(place, storage::Database::Use::write, storage::Database::usual_patience);
  if (!database) return fail(database.error());
  return Register(std::make_unique<storage::Database>(std::move(*database)), place,
                  numbering.pattern);
}

Expected<void> Register::end(storage::Database::Transaction& transaction) {
  if (auto ended = transaction.end(); !ended) return ended;
  return note_state(*database_, *place_);
}

std::string Register::id() {
  return is_of_this_version(*database_) ? database_->first("SELECT id FROM site") : "";
}

Expected<std::map<std::string, std::string>> Register::issued_digests() {
  std::map<std::string, std::string> numbers;
  if (is_of_this_version(*database_)) {
    for (const storage::Database::Row& row :
         database_->rows("SELECT number, says FROM journal WHERE what = 'issued'")) {
      const storage::Json says = storage::parse_or_discard(row[1]);
      if (!says.is_object() || !says.contains("files")) continue;
      for (const storage::Json& file : says["files"]) numbers[file.value("sha256", "")] = row[0];
    }
  } else {  // a register of version 1 has no journal
    for (const storage::Database::Row& row :
         database_->rows("SELECT c.number, f.bytes FROM files f JOIN certificates c ON c.id = "
                         "f.certificate"))
      numbers[storage::sha256(row[1])] = row[0];
  }
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return numbers;
}

namespace {

/// Returns nullopt if the register does not exist, because reading must not create it.
Expected<std::optional<Register>> open_if_there(const fs::path& site,
                                                const config::Numbering& numbering,
                                                double patience) {
  NONIO_TRY(const auto place, register_place(site, numbering));
  NONIO_TRY(const auto there, has_register(place, patience));
  if (!there) return std::nullopt;
  NONIO_TRY(auto opened, Register::open(site, numbering, patience));
  return opened;
}

}  // namespace

Expected<std::vector<RegisterEntry>> Register::entries(const fs::path& site,
                                                       const config::Numbering& numbering,
                                                       double patience) {
  NONIO_TRY(auto opened, open_if_there(site, numbering, patience));
  if (!opened) return std::vector<RegisterEntry>{};
  return opened->all();
}

Expected<std::vector<WaitingDraft>> Register::drafts(const fs::path& site,
                                                     const config::Numbering& numbering,
                                                     double patience) {
  NONIO_TRY(auto opened, open_if_there(site, numbering, patience));
  if (!opened) return std::vector<WaitingDraft>{};
  return opened->all_drafts();
}

Expected<std::vector<RegisterEntry>> Register::all() {
  std::vector<RegisterEntry> entries;
  for (storage::Database::Row& row : database_->rows(R"(
      SELECT c.number, c.campaign, c.date, old.number, c.reason, c.issued,
        CASE WHEN c.state = 'issued' AND new.id IS NOT NULL THEN 'amended' ELSE c.state END,
        new.number
      FROM certificates c LEFT JOIN certificates old ON old.id = c.replaces
        LEFT JOIN certificates new ON new.replaces = c.id AND new.state <> 'drawn'
      ORDER BY c.id)"))
    entries.push_back({std::move(row[0]), std::move(row[1]), std::move(row[6]), std::move(row[2]),
                       std::move(row[3]), std::move(row[7]), std::move(row[4]),
                       static_cast<std::uint64_t>(integer(row[5]))});
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return entries;
}

Expected<void> Register::note_persons(std::vector<RegisterEntry>& entries) {
  std::map<std::string, RegisterEntry*> by_number;
  for (RegisterEntry& e : entries) by_number[e.number] = &e;
  const auto text = [](const storage::Json& json, const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string()
               ? json[key].get<std::string>()
               : "";
  };
  for (const Journal::Entry& noted : Journal(*database_).all()) {
    const auto found = by_number.find(noted.number);
    const bool issued = noted.what == "issued", withdrawn = noted.what == "withdrawn";
    if (found == by_number.end() || !(issued || withdrawn)) continue;
    const storage::Json says = storage::parse_or_discard(noted.says);
    RegisterEntry& e = *found->second;
    (issued ? e.released_account : e.withdrawn_account) = text(says, "account");
    if (issued && says.is_object() && says.contains("signer")) {
      e.signer = text(says["signer"], "subject");
      e.signer_sha256 = text(says["signer"], "sha256");
    }
    if (withdrawn) e.withdrawn_by = text(says, "by");
    if (const storage::Json& released =
            says.is_object() && says.contains("released") ? says["released"] : says;
        issued && released.is_object() && released.contains("released"))
      e.released_by = text(released["released"], "by"),
      e.released_user = text(released["released"], "user");
  }
  return database_->take_error();
}

reading::Inputs Register::inputs_of(std::int64_t id) {
  reading::Inputs inputs;
  for (storage::Database::Row& row : database_->rows(
           "SELECT name, sha256 FROM inputs WHERE certificate = ? ORDER BY place", {id}))
    inputs.emplace_back(std::move(row[0]), std::move(row[1]));
  return inputs;
}

namespace {

Expected<storage::Json> issued_as_noted(storage::Database& database, const std::string& number) {
  const auto entry = Journal(database).last_of("issued", number);
  if (auto well = database.take_error(); !well) return fail(well.error());
  storage::Json says = entry ? storage::parse_or_discard(entry->says) : storage::Json();
  if (!says.is_object())
    return fail("the register's journal does not state what " + number + " is");
  return says;
}

Expected<void> check_digests(const storage::Json& says, const std::string& number,
                             const std::vector<evaluation::IssuedFile>& files) {
  const storage::Json& noted = says.contains("files") ? says["files"] : storage::Json::array();
  for (std::size_t i = 0; i < std::max(noted.size(), files.size()); ++i)
    if (i >= noted.size() || i >= files.size() ||
        noted[i].value("sha256", "") != storage::sha256(files[i].bytes))
      return fail("the register's copy of " +
                  (i < files.size() ? files[i].name : noted[i].value("name", "a file")) + " of " +
                  number + " is not what was issued: restore the register from a backup");
  return {};
}

}  // namespace

Expected<std::vector<evaluation::IssuedFile>> Register::files_of(std::int64_t id) {
  std::vector<evaluation::IssuedFile> files;
  for (storage::Database::Row& row :
       database_->rows("SELECT output, name, bytes, no_time_stamp FROM files WHERE certificate = ? "
                       "ORDER BY place",
                       {id}))
    files.push_back({std::move(row[0]), std::move(row[1]), std::move(row[2]), std::move(row[3])});
  if (!is_of_this_version(*database_)) return files;  // a register of version 1 has no journal
  const std::string number = database_->first("SELECT number FROM certificates WHERE id = ?", {id});
  if (files.empty() && number.empty()) return files;
  NONIO_TRY(const auto says, issued_as_noted(*database_, number));
  if (auto same = check_digests(says, number, files); !same) return fail(same.error());
  return files;
}

Expected<void> Register::note_replaced(std::int64_t id, Issue& issue) {
  issue.replaces_readings =
      database_->first("SELECT readings FROM certificates WHERE id = ?", {id});
  NONIO_TRY(const auto files, files_of(id));
  for (const evaluation::IssuedFile& file : files)
    if (issue.replaces_file.empty() || file.name.ends_with(".xml")) {
      issue.replaces_file = file.name;
      issue.replaces_sha256 = storage::sha256(file.bytes);
    }
  return {};
}

Expected<evaluation::Certificate> Register::load(std::int64_t id) {
  evaluation::Certificate certificate;
  auto rows = database_->rows(
      "SELECT c.number, c.date, c.readings, c.output, c.templates, c.results, old.id, old.number, "
      "old.date FROM certificates c LEFT JOIN certificates old ON old.id = c.replaces "
      "WHERE c.id = ?",
      {id});
  if (rows.empty()) return certificate;
  storage::Database::Row& row = rows.front();
  Issue& issue = certificate.issue;
  issue.number = std::move(row[0]);
  issue.date = std::move(row[1]);
  issue.replaces = std::move(row[7]);
  issue.replaces_date = std::move(row[8]);
  issue.readings_sha256 = std::move(row[2]);
  if (!issue.replaces.empty()) {
    issue.changes = differences(inputs_of(integer(row[6])), inputs_of(id));
    if (auto noted = note_replaced(integer(row[6]), issue); !noted) return fail(noted.error());
  }
  // Everything else that the certificate prints is contained in its attached results.
  const storage::Json results = storage::parse_or_discard(row[5]);
  if (results.is_object() && results.contains("certificate"))
    if (Issue printed = evaluation::certificate_of(results["certificate"]).issue;
        printed.number == issue.number)
      issue = std::move(printed);
  certificate.output = std::move(row[3]);
  certificate.templates_sha256 = std::move(row[4]);
  certificate.results = std::move(row[5]);
  NONIO_TRY(auto files, files_of(id));
  certificate.files = std::move(files);
  certificate.issued = true;
  return certificate;
}

namespace {

constexpr const char* last_of_campaign =
    "SELECT id, state, number, date, reason FROM certificates WHERE campaign = ? AND issued IS NOT "
    "NULL ORDER BY issued DESC LIMIT 1";

}  // namespace

Expected<std::optional<RegisterEntry>> Register::last_number(const std::string& campaign) {
  auto rows = database_->rows(last_of_campaign, {campaign});
  if (auto well = database_->take_error(); !well) return fail(well.error());
  if (rows.empty()) return std::nullopt;
  storage::Database::Row& row = rows.front();
  RegisterEntry entry;
  entry.campaign = campaign;
  entry.state = std::move(row[1]);
  entry.number = std::move(row[2]);
  entry.date = std::move(row[3]);
  entry.reason = std::move(row[4]);
  return entry;
}

Expected<std::optional<evaluation::Certificate>> Register::last(const std::string& campaign,
                                                                const reading::Inputs& data) {
  const auto rows = database_->rows(last_of_campaign, {campaign});
  if (rows.empty() || rows.front()[1] != "issued") return std::nullopt;
  const std::int64_t id = integer(rows.front()[0]);
  if (inputs_of(id) != data) return std::nullopt;
  NONIO_TRY(auto loaded, load(id));
  return loaded;
}

Expected<std::optional<evaluation::Certificate>> Register::find(const std::string& campaign,
                                                                const reading::Inputs& data) {
  auto found = last(campaign, data);
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return found;
}

Expected<std::string> Register::next_number(const std::string& year) {
  const std::string sequence = config::sequence_of(pattern_, year);
  for (;;) {
    const std::int64_t number =
        integer(database_->first("INSERT INTO counters VALUES(?, 1) ON CONFLICT(sequence) "
                                 "DO UPDATE SET last = counters.last + 1 RETURNING last",
                                 {sequence}));
    auto text = config::number_text(pattern_, year, static_cast<std::uint64_t>(number));
    // The number may have been used with an earlier pattern.
    if (!text || database_->failed() ||
        database_->first("SELECT count(*) FROM certificates WHERE number = ?", {*text}) == "0")
      return text;
  }
}

Expected<evaluation::Certificate> Register::draw(const std::string& campaign,
                                                 const reading::Inputs& data,
                                                 const std::string& today) {
  storage::Database& db = *database_;
  storage::Database::Transaction transaction(db);
  NONIO_TRY(auto issued, last(campaign, data));
  if (issued) {
    if (auto ended = transaction.end(); !ended) return fail(ended.error());
    return std::move(*issued);
  }
  const auto later =
      db.rows("SELECT number, date FROM certificates WHERE issued IS NOT NULL AND date > ? LIMIT 1",
              {today});
  if (!later.empty())
    return fail("today is " + today + ", and " + later.front()[0] + " was issued on " +
                later.front()[1] +
                ": the clock was set back; no number is assigned until it is right");
  evaluation::Certificate drawn;
  const std::string unfinished = "the run of " + today + " ended before it was issued";
  drawn.issue.date = today;
  drawn.issue.number = db.first(
      "UPDATE certificates SET date = ?, reason = ? WHERE campaign = ? AND "
      "state = 'drawn' RETURNING number",
      {today, unfinished, campaign});
  Journal journal(db);
  if (drawn.issue.number.empty()) {
    NONIO_TRY(auto number, next_number(today.substr(0, 4)));
    drawn.issue.number = std::move(number);
    db.rows(
        "INSERT INTO certificates(number, campaign, state, date, reason) "
        "VALUES(?, ?, 'drawn', ?, ?)",
        {drawn.issue.number, campaign, today, unfinished});
    journal.add("drawn", drawn.issue.number, {{"campaign", campaign}});
  }
  if (const auto entry = journal.last_of("drawn", drawn.issue.number)) {
    drawn.issue.register_entry = std::to_string(entry->place);
    drawn.issue.register_sha256 = entry->sha256;
  }
  drawn.issue.register_id = id();
  if (const auto old = db.rows(last_of_campaign, {campaign}); !old.empty()) {
    drawn.issue.replaces = old.front()[2];
    drawn.issue.replaces_date = old.front()[3];
    drawn.issue.changes = differences(inputs_of(integer(old.front()[0])), data);
    if (auto noted = note_replaced(integer(old.front()[0]), drawn.issue); !noted)
      return fail(noted.error());
  }
  if (auto ended = end(transaction); !ended) return fail(ended.error());
  return drawn;
}

namespace {

/// Returns the signer's certificate in the first signed PDF; empty without one. It is recorded
/// because keys are replaced while their signatures remain valid.
storage::Json signer_json(const std::vector<evaluation::IssuedFile>& files) {
  for (const evaluation::IssuedFile& f : files) {
    if (!f.bytes.starts_with("%PDF-")) continue;
    if (const auto signer = sign::unverified_signer(f.bytes))
      return {{"subject", signer->subject},
              {"sha256", signer->sha256},
              {"valid_from", sign::text_of(signer->not_before)},
              {"valid_until", sign::text_of(signer->not_after)}};
  }
  return storage::Json::object();
}

}  // namespace

Expected<evaluation::Certificate> Register::issue(const evaluation::Certificate& certificate,
                                                  const std::string& campaign,
                                                  const reading::Inputs& data,
                                                  const Approved* approved) {
  storage::Database& db = *database_;
  const Issue& issue = certificate.issue;
  storage::Database::Transaction transaction(db);
  const auto found = db.rows("SELECT id, state FROM certificates WHERE number = ? AND campaign = ?",
                             {issue.number, campaign});
  if (found.empty())
    return fail(db.failed() ? transaction.end().error().message
                            : "the register does not know the number " + issue.number);
  const std::int64_t id = integer(found.front()[0]);
  if (approved != nullptr && found.front()[1] == "issued") {
    add_second(issue.number, campaign, approved->by);
    if (auto ended = end(transaction); !ended) return fail(ended.error());
    const auto first = first_of(issue.number);
    return fail(first ? *first : first.error().message);
  }
  if (approved != nullptr)
    if (auto same = check_seen(approved->draft, approved->by); !same) return fail(same.error());
  if (found.front()[1] == "issued" && inputs_of(id) == data) {
    auto first = load(id);
    if (!first) return first;
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
       storage::Database::Blob{certificate.results}, issue.replaces, id});
  std::int64_t place = 0;
  for (const auto& [name, digest] : data)
    db.rows("INSERT INTO inputs VALUES(?, ?, ?, ?)", {id, place++, name, digest});
  for (const evaluation::IssuedFile& f : certificate.files)
    db.rows("INSERT INTO files VALUES(?, ?, ?, ?, ?, ?)",
            {id, place++, f.output, f.name, f.no_time_stamp, storage::Database::Blob{f.bytes}});
  storage::Json says = issued_json(db, id);
  storage::Json released = storage::parse_or_discard(certificate.released);
  if (released.is_object()) says["released"] = std::move(released);
  if (storage::Json signer = signer_json(certificate.files); !signer.empty())
    says["signer"] = std::move(signer);
  Journal(db).add("issued", issue.number, says);
  db.rows("DELETE FROM drafts WHERE campaign = ?", {campaign});
  if (auto ended = end(transaction); !ended) return fail(ended.error());
  evaluation::Certificate done = certificate;
  done.issued = true;
  return done;
}

Expected<void> Register::note_failure(const std::string& campaign, const std::string& why) {
  storage::Database::Transaction transaction(*database_);
  database_->rows("UPDATE certificates SET reason = ? WHERE campaign = ? AND state = 'drawn'",
                  {why, campaign});
  return transaction.end();
}

Expected<void> Register::withdraw(const std::string& number, const std::string& why,
                                  const std::string& by) {
  storage::Database& db = *database_;
  storage::Database::Transaction transaction(db);
  const auto found = db.rows(
      "SELECT c.id, c.state, new.number FROM certificates c LEFT JOIN certificates new "
      "ON new.replaces = c.id AND new.state <> 'drawn' WHERE c.number = ?",
      {number});
  if (auto well = db.take_error(); !well) return well;
  if (found.empty())
    return fail("the register has no number " + number +
                " (`nonio certificate list SITE` lists the numbers)");
  const auto& entry = found.front();
  if (entry[1] == "drawn") return fail(number + " was never issued: there is nothing to withdraw");
  if (entry[1] == "withdrawn") return fail(number + " is withdrawn already");
  if (!entry[2].empty())
    return fail(number + " was replaced by " + entry[2] + ": that is the one to withdraw");
  db.rows("UPDATE certificates SET state = 'withdrawn', reason = ? WHERE id = ?",
          {why, integer(entry[0])});
  storage::Json says = {{"reason", why}};
  if (!by.empty()) says["by"] = by;
  Journal(db).add("withdrawn", number, says);
  return end(transaction);
}

Expected<std::vector<evaluation::IssuedFile>> Register::files(const std::string& number) {
  const auto id =
      integer(database_->first("SELECT id FROM certificates WHERE number = ?", {number}));
  auto files = files_of(id);
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return files;
}

}  // namespace nonio::certificates
