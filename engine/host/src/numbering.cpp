// SPDX-License-Identifier: Apache-2.0
#include "numbering.h"

#include <algorithm>
#include <utility>

#include "certificates.h"
#include "nonio/host/digest.h"
#include "nonio/host/files.h"
#include "nonio/host/register.h"
#include "nonio/host/results_json.h"
#include "recomputed.h"
#include "traceability.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

/// What a certificate is made from: the campaign's own files, and what of site.toml has a say in
/// the results.
Inputs data_of(const Evaluated& evaluated, const Context& context) {
  Inputs data = evaluated.inputs;
  data.emplace_back(site_name, sha256(context.site.evaluation));
  return data;
}

/// The register's files in place of what has been made now.
void take_issued(Evaluated& evaluated) {
  for (Results::Written& w : evaluated.results.outputs)
    for (const IssuedFile& f : evaluated.certificate->files) {
      auto& artifacts = w.result.artifacts;
      const auto same = std::find_if(artifacts.begin(), artifacts.end(),
                                     [&](const Artifact& a) { return a.name == f.name; });
      if (w.plugin == f.output && same != artifacts.end()) *same = {f.name, f.bytes};
    }
  remove_unsigned(evaluated);
}

}  // namespace

Expected<std::string> readings_digest(const Inputs& inputs, const fs::path& folder) {
  std::string all;
  const std::string prefix = input_name("");
  for (const auto& [input, digest] : inputs) {
    if (!input.starts_with(prefix)) continue;
    const auto path = path_inside(folder, input.substr(prefix.size()));
    if (!path) return fail(path.error());
    const auto bytes = read_file(*path);
    if (!bytes) return fail(bytes.error());
    if (sha256(*bytes) != digest)
      return fail(path->filename().string() + " was changed while the campaign was evaluated");
    all += *bytes;
  }
  return sha256(all);
}

bool Numbers::has_register() const {
  const auto path = register_path(site_, context_.site.numbering);
  std::error_code error;
  return path && fs::exists(*path, error);
}

Expected<Certificate> Numbers::draw(const Evaluated& evaluated, const fs::path& folder,
                                    std::vector<std::string>& missing) const {
  for (std::string& key : days_to_come(evaluated.campaign, today_))
    missing.push_back(std::move(key));
  const bool complete = missing.empty();
  if (!complete && !has_register()) return Certificate{};
  auto opened = Register::open(site_, context_.site.numbering);
  if (!opened) return fail(opened.error());
  const std::string& campaign = evaluated.campaign.id;
  const Inputs data = data_of(evaluated, context_);
  auto found = opened->find(campaign, data);
  if (!found) return fail(found.error());
  if (*found) return std::move(**found);
  if (!complete) return Certificate{};
  if (!can_sign_) return fail(no_key);
  const auto readings = readings_digest(evaluated.inputs, folder);
  if (!readings) return fail(readings.error());
  auto drawn = opened->draw(campaign, data, today_);
  if (!drawn || drawn->issued) return drawn;
  drawn->issue.readings_sha256 = *readings;
  drawn->templates_sha256 = context_.templates_sha256;
  return drawn;
}

Expected<void> Numbers::issue(Evaluated& evaluated) const {
  if (!evaluated.certificate || evaluated.status == "failed") return {};
  if (evaluated.certificate->issued) {
    take_issued(evaluated);
    note_differences(evaluated);
  } else {
    auto opened = Register::open(site_, context_.site.numbering);
    if (!opened) return fail(opened.error());
    auto issued =
        opened->issue(*evaluated.certificate, evaluated.campaign.id, data_of(evaluated, context_));
    if (!issued) return fail(issued.error());
    evaluated.certificate = std::move(*issued);
    take_issued(evaluated);
  }
  for (const IssuedFile& file : evaluated.certificate->files)
    note_time_stamp(evaluated, file, context_.templates);
  return {};
}

/// A certificate does not change; that another version would print other numbers is said.
void Numbers::note_differences(Evaluated& evaluated) const {
  auto outputs = std::exchange(evaluated.results.outputs, {});
  const auto same =
      same_values(evaluated.certificate->results, results_json(evaluated, context_, {}));
  evaluated.results.outputs = std::move(outputs);
  if (same) return;
  note_finding(
      evaluated, evaluated.certificate->output,
      {.id = "certificate.differs",
       .attention = true,
       .texts = {{"number", evaluated.certificate->issue.number}, {"why", same.error().message}}},
      context_.templates);
}

void Numbers::note_failure(const std::string& campaign, const std::string& why) const {
  if (!has_register()) return;
  auto opened = Register::open(site_, context_.site.numbering);
  if (!opened) return;
  [[maybe_unused]] const auto noted = opened->note_failure(campaign, why);
}

}  // namespace nonio::host
