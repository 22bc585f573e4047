// SPDX-License-Identifier: Apache-2.0
#include "store.h"

#include <algorithm>

#include "nonio/host/digest.h"
#include "nonio/host/files.h"
#include "nonio/host/results_json.h"
#include "nonio/sdk/format.h"

namespace nonio::host {
namespace fs = std::filesystem;

std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates) {
  std::vector<KnownFinding> out;
  const auto take = [&](const std::vector<Finding>& findings) {
    for (const Finding& f : findings) {
      KnownFinding known{f.measurement, f.id, finding_text(templates, "en", f, "title"),
                         f.attention};
      const auto same = std::find_if(out.begin(), out.end(),
                                     [&](const KnownFinding& k) { return k.same(known); });
      if (same == out.end())
        out.push_back(std::move(known));
      else
        same->attention |= known.attention;
    }
  };
  for (const auto& a : results.analyses) take(a.evaluation.findings);
  for (const auto& o : results.outputs) take(o.result.findings);
  for (const Conformity& c : results.conformity)
    if (c.decision != Decision::conforms)
      out.push_back({c.measurement, "tolerance." + c.axis + "." + c.name + "." + c.plugin,
                     c.name + " of axis " + c.axis + ": " + to_text(c.decision), true});
  return out;
}

namespace {

RecordedFile recorded(const Artifact& a) { return {a.name, a.bytes.size(), sha256(a.bytes)}; }

}  // namespace

Expected<void> stage(const fs::path& out, const Evaluated& e, const Context& context,
                     const StoreNote& note) {
  const fs::path folder = results_folder(out, e.campaign.id);
  if (std::error_code error; fs::exists(folder / manifest_name, error))
    return fail("the output folder " + folder.string() +
                " is itself a campaign; nothing was written");
  Record record;
  record.folder = path_text(note.folder);
  record.night = note.night;
  record.reason = note.reason;
  record.status = e.status;
  record.retry = note.retry;
  record.inputs = shared_inputs(context);
  record.inputs.insert(record.inputs.end(), e.inputs.begin(), e.inputs.end());
  if (e.certificate) record.certificate = e.certificate->issue.number;
  record.draft = e.certificate && e.certificate->draft;
  record.errors = e.results.errors;
  record.findings = known_findings(e.results, context.templates);

  std::vector<Artifact> files;
  for (const auto& w : e.results.outputs)
    files.insert(files.end(), w.result.artifacts.begin(), w.result.artifacts.end());
  for (const Artifact& a : files) {
    if (a.sign) return fail(a.name + " is not signed; nothing was written");
    record.files.push_back(recorded(a));
  }
  // Last, so that it never speaks of a file that is not there.
  files.push_back({results_name, results_json(e, context, record.files)});
  record.files.push_back(recorded(files.back()));

  if (const auto old = read_record(folder))
    record.previous = old->night < note.night ? old->findings : old->previous;
  files.push_back({record_name, to_json(record)});
  remove_leftovers(folder);
  return write_temporaries(folder, files);
}

namespace {

/// The results of one campaign on their way from temporary names to their own.
struct Move {
  fs::path folder;
  std::vector<std::string> names{};
  bool moved = false;  ///< already
  Expected<void> done{};

  void remove(const std::string& name) {
    if (std::error_code error; done && !fs::remove(folder / name, error) && error)
      done = fail("cannot remove " + (folder / name).string() + ": " + error.message());
  }
  void rename(const std::string& name) {
    std::error_code error;
    if (done) fs::rename(temporary_path(folder, name), folder / name, error);
    if (error) done = fail("cannot write " + (folder / name).string() + ": " + error.message());
  }
  /// The old record, and files of it that the new results do not have.
  void take_old_away() {
    const auto old = read_record(folder);
    remove(record_name);
    if (!old) return;
    for (const RecordedFile& f : old->files)
      if (is_artifact_name(f.name) && !std::binary_search(names.begin(), names.end(), f.name))
        remove(f.name);
  }
  void rename_files() {
    for (const std::string& name : names)
      if (name != record_name) rename(name);
  }
  void rename_record() { rename(record_name); }
};

/// What a commit that was cut short has done already is not staged any more.
Move move_of(const fs::path& folder, std::uint64_t night) {
  Move move{folder, temporaries(folder)};
  const bool staged = std::binary_search(move.names.begin(), move.names.end(), record_name);
  if (!staged) {
    move.names.clear();
    const auto record = read_record(folder);
    move.moved = record && record->night == night;  // an older one would pass for tonight's
    if (!move.moved) move.done = fail("nothing is staged in " + folder.string());
  }
  return move;
}

}  // namespace

std::vector<Expected<void>> commit(const fs::path& out, const std::vector<std::string>& ids,
                                   std::uint64_t night) {
  std::vector<Move> moves;
  for (const std::string& id : ids) moves.push_back(move_of(results_folder(out, id), night));
  const auto flush = [&] {
    const auto flushed = flush_file_system(out);
    for (Move& m : moves)
      if (m.done && !flushed) m.done = flushed;
  };
  const auto each = [&](void (Move::*step)()) {
    for (Move& m : moves)
      if (!m.moved) (m.*step)();
    flush();
  };
  each(&Move::take_old_away);
  each(&Move::rename_files);
  each(&Move::rename_record);
  std::vector<Expected<void>> done;
  for (Move& m : moves) {
    if (!m.done) remove_leftovers(m.folder);
    done.push_back(std::move(m.done));
  }
  return done;
}

Expected<void> store(const fs::path& out, const Evaluated& evaluated, const Context& context,
                     const StoreNote& note) {
  if (auto staged = stage(out, evaluated, context, note); !staged) return staged;
  return commit(out, {evaluated.campaign.id}, note.night).front();
}

}  // namespace nonio::host
