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

Expected<void> store(const fs::path& out, const Evaluated& e, const Context& context,
                     const StoreNote& note) {
  const fs::path folder = out / e.campaign.id;
  if (std::error_code error; fs::exists(folder / manifest_name, error))
    return fail("the output folder " + folder.string() +
                " is itself a campaign; nothing was written");
  Record record;
  record.folder = note.folder;
  record.night = note.night;
  record.reason = note.reason;
  record.status = e.status;
  record.retry = note.retry;
  record.inputs = shared_inputs(context);
  record.inputs.insert(record.inputs.end(), e.inputs.begin(), e.inputs.end());
  record.errors = e.results.errors;
  record.findings = known_findings(e.results, context.templates);

  std::vector<Artifact> files;
  for (const auto& w : e.results.outputs)
    files.insert(files.end(), w.result.artifacts.begin(), w.result.artifacts.end());
  for (const Artifact& a : files) record.files.push_back(recorded(a));
  // Last, so that it never speaks of a file that is not there.
  files.push_back({results_name, results_json(e, context, record.files)});
  record.files.push_back(recorded(files.back()));

  std::vector<std::string> stale;
  if (const auto old = read_record(folder)) {
    record.previous = old->night < note.night ? old->findings : old->previous;
    for (const RecordedFile& f : old->files)
      if (std::none_of(record.files.begin(), record.files.end(),
                       [&](const RecordedFile& now) { return now.name == f.name; }) &&
          is_artifact_name(f.name))
        stale.push_back(f.name);
  }
  files.push_back({record_name, to_json(record)});
  remove_leftovers(folder);
  stale.insert(stale.begin(), record_name);
  if (auto done = remove_files(folder, stale); !done) return done;
  return publish(folder, files);
}

}  // namespace nonio::host
