// SPDX-License-Identifier: Apache-2.0
#include "batch/commit/store.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <functional>
#include <set>
#include <utility>

#include "batch/state/run_state.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "laboratory/store/earlier.h"
#include "platform/process/stop.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

evaluation::RecordedFile recorded(const Artifact& a) {
  return {a.name, a.bytes.size(), storage::sha256(a.bytes)};
}

/// Writes the record atomically under a temporary name. Before `commit` renames it, a resumed run
/// reads from it the reason of the evaluation.
Expected<void> write_record(const fs::path& folder, const evaluation::Record& record) {
  const std::string unfinished = std::string(".") + evaluation::record_name;
  const std::string text = evaluation::to_json(record);
  if (auto written = storage::write_temporaries(folder, {{unfinished, text}}); !written)
    return written;
  const fs::path path = storage::temporary_path(folder, evaluation::record_name);
  return storage::rename_file(storage::temporary_path(folder, unfinished), path,
                              [&] { return storage::read_file(path).value_or("") == text; });
}

/// Copies the findings of the previous run and, for a failed campaign, the first run of the
/// failure.
Expected<void> look_back(const fs::path& folder, evaluation::Record& record) {
  NONIO_TRY(const auto last, evaluation::last_record(folder));
  if (record.status == evaluation::Status::failed)
    record.failed_since = evaluation::RunLabel{record.run, record.date};
  if (!last) return {};
  const evaluation::Record& old = last->record;
  record.previous = old.run < record.run ? old.findings : old.previous;
  if (record.status == evaluation::Status::failed && old.status == evaluation::Status::failed)
    record.failed_since = old.failed_since.value_or(evaluation::RunLabel{old.run, old.date});
  return {};
}

}  // namespace

Expected<void> stage(const fs::path& out, const evaluation::Evaluated& e,
                     const reading::Context& context, const StoreNote& note) {
  const fs::path folder = storage::own_folder(out, e.campaign.id);
  if (std::error_code error; fs::exists(folder / config::manifest_name, error))
    return fail("the output folder " + folder.string() +
                " is itself a campaign; nothing was written");
  if (auto taken = evaluation::take_in(out, e.campaign.id); !taken) return taken;
  evaluation::Record record;
  record.folder = storage::path_text(note.folder);
  record.run = note.run.number;
  record.date = note.run.date;
  record.reason = note.reason;
  record.status = e.status;
  record.retry = note.retry;
  record.inputs = reading::shared_inputs(context);
  record.inputs.insert(record.inputs.end(), e.inputs.begin(), e.inputs.end());
  if (e.certificate) record.certificate = e.certificate->issue.number;
  record.draft = e.certificate && e.certificate->draft;
  record.history = e.history;
  record.errors = e.results.errors;
  const std::string& language = context.site.language;
  if (language != "en") {
    record.language = language;
    record.notes = evaluation::notes_in(language, e.results, context.templates);
  }
  record.findings = evaluation::known_findings(e.results, context.templates, language);

  std::vector<Artifact> files;
  for (const auto& w : e.results.outputs)
    files.insert(files.end(), w.result.artifacts.begin(), w.result.artifacts.end());
  for (const Artifact& a : files) {
    if (a.sign) return fail(a.name + " is not signed; nothing was written");
    record.files.push_back(recorded(a));
  }
  std::string results = evaluation::results_json(e, context, record.files);
  NONIO_TRY(auto carried, store::carry_over(folder, record, results, e.campaign.id));
  record.indexed = carried.indexed;
  if (!carried.earlier.empty()) {
    files.push_back({store::earlier_name, std::move(carried.earlier)});
    record.files.push_back(recorded(files.back()));
  }
  // results.json is written last, so that it never names a missing file.
  files.push_back({evaluation::results_name, std::move(results)});
  record.files.push_back(recorded(files.back()));

  if (auto looked = look_back(folder, record); !looked) return looked;
  if (auto written = write_record(folder, record); !written) return written;
  NONIO_TRY(const auto left, storage::temporaries(folder));
  for (const std::string& name : left)
    if (std::error_code ignored; name != evaluation::record_name)
      fs::remove(storage::temporary_path(folder, name), ignored);
  return storage::write_temporaries(folder, files);
}

namespace {

class Move {
 public:
  /// Another process or an interrupted commit may have renamed the results already.
  Move(fs::path to, std::uint64_t run, const Expected<void>& sound) : folder_(std::move(to)) {
    auto staged = evaluation::staged_record(folder_);
    if (storage::has_own_names() && is_stored(run)) {
      leave_to_other();
    } else if (!staged) {
      done_ = fail(staged.error());
    } else if (*staged && (*staged)->run == run) {
      record_ = std::move(**staged);
      for (const evaluation::RecordedFile& f : record_.files) names_.insert(f.name);
      done_ = sound;
    } else {
      const auto record = evaluation::read_record(folder_);
      // The record of an older run must not be taken for that of this run.
      moved_ = record && record->run == run;
      if (!moved_) done_ = fail("nothing is staged in " + folder_.string());
    }
  }

  void read_back() {
    for (const evaluation::RecordedFile& f : record_.files) {
      const fs::path temporary = storage::temporary_path(folder_, f.name);
      // An interrupted commit may have renamed the file already.
      const auto waits = storage::is_there(temporary);
      const auto same = storage::disk_gives_back(waits && !*waits ? folder_ / f.name : temporary,
                                                 f.size, f.sha256);
      if (!same || !*same)
        return give_up("the disk does not give back what was written to it: " +
                       (folder_ / f.name).string() + (same ? "" : ": " + same.error().message));
    }
    storage::drop_cached(storage::temporary_path(folder_, evaluation::record_name));
    const auto record = evaluation::staged_record(folder_);
    if (!record || !*record || evaluation::to_json(**record) != evaluation::to_json(record_))
      give_up("the disk does not give back what was written to it: " +
              (folder_ / evaluation::record_name).string());
  }

  /// Removes old files that the new results do not contain. If the new results are a temporary
  /// failure, good old results are moved into `last-good`.
  void put_old_aside() {
    std::error_code error;
    const bool there = fs::exists(fs::symlink_status(folder_ / evaluation::record_name, error));
    if (there) rename(folder_ / evaluation::record_name, folder_ / evaluation::record_before_name);
    if (there && done_ && storage::has_own_names()) {
      const auto moved = evaluation::last_record(folder_);
      if (moved && *moved && (*moved)->record.run >= record_.run) {
        // Another process has stored the results in the meantime.
        rename(folder_ / evaluation::record_before_name, folder_ / evaluation::record_name);
        return leave_to_other();
      }
    }
    const auto old = evaluation::last_record(folder_);
    if (!old) return give_up(old.error().message);
    const bool may_pass = record_.status == evaluation::Status::failed && record_.retry;
    const bool was_good = *old && (*old)->record.status != evaluation::Status::failed;
    if (may_pass && was_good) keep((*old)->record);
    if (!may_pass) remove_all(folder_ / evaluation::last_good_name);
    if (!*old) return;
    for (const evaluation::RecordedFile& f : (*old)->record.files)
      if (is_result(f.name) && !names_.contains(f.name)) remove(folder_ / f.name);
  }
  void rename_files() {
    for (const evaluation::RecordedFile& f : record_.files)
      rename(storage::temporary_path(folder_, f.name), folder_ / f.name,
             [&] { return storage::sha256_of_file(folder_ / f.name).value_or("") == f.sha256; });
  }
  void rename_record() {
    // The survey regards files that are newer than the record as changed, so the record gets the
    // latest time.
    ::utimensat(AT_FDCWD, storage::temporary_path(folder_, evaluation::record_name).c_str(),
                nullptr, 0);
    rename(storage::temporary_path(folder_, evaluation::record_name),
           folder_ / evaluation::record_name, [&] {
             const auto now = evaluation::read_record(folder_);
             return now && evaluation::to_json(*now) == evaluation::to_json(record_);
           });
    if (!done_) return;
    // The new results are complete, so remaining old files do no harm.
    [[maybe_unused]] const auto gone = put_away_record_before(folder_);
  }

  static Expected<void> put_away_record_before(const fs::path& folder) {
    std::error_code error;
    const fs::path before = folder / evaluation::record_before_name;
    const fs::path last_good = folder / evaluation::last_good_name;
    const auto aside = storage::is_there(before), kept = storage::is_there(last_good),
               whole = storage::is_there(last_good / evaluation::record_name);
    for (const auto* looked : {&aside, &kept, &whole})
      if (!*looked) return fail(looked->error());
    if (!*aside) return {};
    if (*kept && !*whole) return storage::rename_file(before, last_good / evaluation::record_name);
    fs::remove(before, error);
    if (error) return fail("cannot remove " + before.string() + ": " + error.message());
    return {};
  }

  bool moved() const { return moved_; }
  const Expected<void>& done() const { return done_; }
  void give_up(const std::string& why) {
    if (done_) done_ = fail(why);
  }
  void remove_staged() const { storage::remove_leftovers(folder_); }

 private:
  static bool is_result(const std::string& name) {
    return storage::is_artifact_name(name) || name == evaluation::results_name ||
           name == store::earlier_name;
  }
  bool is_stored(std::uint64_t run) const {
    const auto record = evaluation::read_record(folder_);
    return record && record->run >= run;
  }
  /// Another process that runs the same shard has stored the same bytes.
  void leave_to_other() {
    storage::remove_leftovers(folder_);
    moved_ = true;
  }
  void remove(const fs::path& path) {
    if (std::error_code error; done_ && !fs::remove(path, error) && error)
      give_up("cannot remove " + path.string() + ": " + error.message());
  }
  void remove_all(const fs::path& path) {
    std::error_code error;
    if (done_) fs::remove_all(path, error);
    if (error) give_up("cannot remove " + path.string() + ": " + error.message());
  }
  void rename(const fs::path& from, const fs::path& to, const std::function<bool()>& is_ours = {}) {
    if (!done_) return;
    if (const auto renamed = storage::rename_file(from, to, is_ours); !renamed)
      give_up(renamed.error().message);
  }
  /// Files that an interrupted attempt has moved already are kept. If a file is missing or
  /// modified, `last-good` is removed.
  void keep(const evaluation::Record& old) {
    if (!done_) return;
    const fs::path to = folder_ / evaluation::last_good_name;
    std::error_code error;
    fs::create_directory(to, error);
    if (error) return give_up("cannot make the folder " + to.string() + ": " + error.message());
    for (const evaluation::RecordedFile& f : old.files) {
      if (!is_result(f.name) || storage::sha256_of_file(to / f.name).value_or("") == f.sha256)
        continue;
      if (storage::sha256_of_file(folder_ / f.name).value_or("") != f.sha256) return remove_all(to);
      rename(folder_ / f.name, to / f.name,
             [&] { return storage::sha256_of_file(to / f.name).value_or("") == f.sha256; });
    }
  }

  fs::path folder_;
  evaluation::Record record_{};
  std::set<std::string> names_{};
  bool moved_ = false;
  Expected<void> done_{};
};

}  // namespace

std::vector<Expected<void>> commit(const fs::path& out, const std::vector<Staged>& campaigns,
                                   std::uint64_t run, const storage::Disk& disk) {
  std::vector<Move> moves;
  const auto sound = [&](const Staged& c) -> Expected<void> {
    if (c.losses == disk.losses()) return {};
    return fail("the disk lost writes while the results were written");
  };
  const auto flush = [&] {
    if (const auto flushed = disk.flush(); !flushed)
      for (Move& m : moves) m.give_up(flushed.error().message);
  };
  const auto each = [&](void (Move::*step)()) {
    for (Move& m : moves)
      if (!m.moved() && m.done()) (m.*step)();
  };
  for (const Staged& c : campaigns)
    moves.emplace_back(storage::own_folder(out, c.id), run, sound(c));
  flush();
  each(&Move::read_back);
  each(&Move::put_old_aside);
  flush();
  each(&Move::rename_files);
  flush();
  each(&Move::rename_record);
  flush();
  std::vector<Expected<void>> done;
  for (const Move& m : moves) {
    if (!m.done()) m.remove_staged();
    done.push_back(m.done());
  }
  return done;
}

Expected<void> store(const fs::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note,
                     const storage::Disk& disk) {
  const std::uint32_t losses = disk.losses();
  if (auto staged = stage(out, evaluated, context, note); !staged) return staged;
  return commit(out, {{evaluated.campaign.id, losses}}, note.run.number, disk).front();
}

Expected<void> tidy(const fs::path& folder) {
  constexpr int tries = 3;  // errors of a file system may be transient
  auto left = storage::temporaries(folder);
  for (int i = 0; i < tries && (!left || !left->empty()); ++i, left = storage::temporaries(folder))
    storage::remove_leftovers(folder);
  if (!left) return fail(left.error());
  if (!left->empty())
    return fail("cannot remove " + storage::temporary_path(folder, left->front()).string());
  NONIO_TRY(const auto complete, storage::is_there(folder / evaluation::record_name));
  if (!complete) return {};
  return Move::put_away_record_before(folder);
}

namespace fs = std::filesystem;

namespace {

Expected<void> tidy_below(const fs::path& out, bool hashed) {
  std::error_code error;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (process::is_stop_requested()) return fail("interrupted");
    std::error_code ignored;
    if (!it->is_directory(ignored) || it->is_symlink(ignored)) continue;
    if (hashed && it->path().filename().string().size() != 2) continue;
    if (auto tidied = hashed ? tidy_below(it->path(), false) : tidy(it->path()); !tidied)
      return tidied;
  }
  if (error) return fail("cannot read the output folder " + out.string() + ": " + error.message());
  return {};
}

}  // namespace

void tidy_root(const fs::path& out) {
  storage::remove_leftovers(out);
  storage::remove_leftovers(out / state_folder);
}

Expected<void> tidy_all(const RunResult& run, const fs::path& out, bool resumed) {
  tidy_root(out);
  if (resumed) return tidy_below(out, storage::own_folder(out, "a") != out / "a");
  for (const CampaignState& c : run.campaigns) {
    if (process::is_stop_requested()) return fail("interrupted");
    if (c.action != CampaignState::Action::done || !c.is_campaign) continue;
    const fs::path folder = storage::own_folder(out, c.id);
    if (storage::results_folder(out, c.id) != folder) continue;
    if (auto tidied = tidy(folder); !tidied) return tidied;
  }
  return {};
}

}  // namespace nonio::batch
