// SPDX-License-Identifier: Apache-2.0
#include "host/certificates/certificates.h"

#include <algorithm>

#include "host/evaluation/results_json.h"
#include "host/storage/digest.h"
#include "host/storage/files.h"
#include "nonio/sdk/format.h"

namespace nonio::host::certificates {
namespace fs = std::filesystem;

namespace {

bool is_pdf(const Artifact& a) { return a.bytes.starts_with("%PDF-"); }

bool is_asked(const Results& results) {
  return std::any_of(results.outputs.begin(), results.outputs.end(), [](const auto& w) {
    return std::any_of(w.result.artifacts.begin(), w.result.artifacts.end(),
                       [](const Artifact& a) { return a.sign; });
  });
}

/// A certificate on its way: out of the list of artifacts while its attachments are made, since
/// results.json cannot name the digest of a file that it is part of.
struct Draft {
  std::size_t output, place;
  Artifact artifact;
};

class Desk {
 public:
  Desk(evaluation::Evaluated& evaluated, const fs::path& folder, const reading::Context& context,
       const SignWith& how, sign::Time now)
      : e_(evaluated), folder_(folder), context_(context), how_(how), now_(now) {}

  Expected<void> run() {
    auto done = sign_all();
    if (!done) return done;
    if (e_.certificate) return keep_for_register();
    for (const evaluation::IssuedFile& file : signed_)
      note_time_stamp(e_, file, context_.templates);
    for (auto& w : outputs())
      for (Artifact& a : w.result.artifacts) a.sign = false;
    return done;
  }

 private:
  Expected<void> sign_all() {
    auto done = sign_documents();
    if (done) done = attach_inputs();
    if (done) done = attach_results();
    for (Draft& d : drafts_) {
      if (done) done = sign_pdf(d);
      auto& artifacts = e_.results.outputs[d.output].result.artifacts;
      artifacts.insert(artifacts.begin() + static_cast<std::ptrdiff_t>(d.place),
                       std::move(d.artifact));
    }
    return done;
  }

  /// All that the numbered output has made, and what of the others is signed with it.
  Expected<void> keep_for_register() {
    evaluation::Certificate& certificate = *e_.certificate;
    const auto is_own = [&](const evaluation::IssuedFile& f) {
      return f.output == certificate.output;
    };
    if (std::none_of(signed_.begin(), signed_.end(), is_own))
      return fail("output " + certificate.output +
                  " makes nothing that is signed, and nothing else is issued under a number");
    for (const auto& w : outputs())
      if (w.plugin == certificate.output)
        for (const Artifact& a : w.result.artifacts)
          certificate.files.push_back({w.plugin, a.name, a.bytes, time_stamp_of(a.name)});
    for (evaluation::IssuedFile& file : signed_)
      if (!is_own(file)) certificate.files.push_back(std::move(file));
    certificate.results = std::move(attachments_.back().bytes);
    return {};
  }

  std::string time_stamp_of(const std::string& name) const {
    for (const evaluation::IssuedFile& file : signed_)
      if (file.name == name) return file.no_time_stamp;
    return {};
  }

  std::vector<Results::Written>& outputs() { return e_.results.outputs; }

  Expected<void> sign(Artifact& a, std::size_t output) {
    auto done = how_.sign(a);
    if (!done) return fail(a.name + " could not be signed: " + done.error().message);
    a.bytes = std::move(done->bytes);
    signed_.push_back({outputs()[output].plugin, a.name, a.bytes, std::move(done->no_time_stamp)});
    return {};
  }

  /// And takes the certificates out.
  Expected<void> sign_documents() {
    for (std::size_t o = 0; o < outputs().size(); ++o) {
      auto& artifacts = outputs()[o].result.artifacts;
      for (std::size_t i = 0; i < artifacts.size(); ++i)
        if (artifacts[i].sign && !is_pdf(artifacts[i])) {
          if (auto done = sign(artifacts[i], o); !done) return done;
          add(artifacts[i].name, artifacts[i].bytes, "application/xml", "Data",
              "digital calibration certificate, with a signature of its own");
        }
      for (std::size_t i = 0, place = 0; i < artifacts.size(); ++place) {
        if (!artifacts[i].sign || !is_pdf(artifacts[i])) {
          ++i;
          continue;
        }
        drafts_.push_back({o, place, std::move(artifacts[i])});
        artifacts.erase(artifacts.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    return {};
  }

  void add(std::string name, std::string bytes, const char* type, const char* relation,
           const char* says) {
    attachments_.push_back({std::move(name), std::move(bytes), type, relation, says});
  }

  void attach_machine() {
    const auto record = config::record_of(context_.machines, e_.campaign.machine);
    if (record && *record != nullptr)
      add(config::machine_record_name, config::packed(**record), "application/json", "Source",
          "what the site knows of the machine");
  }

  /// As they were evaluated, byte by byte.
  Expected<void> attach_inputs() {
    if (drafts_.empty() && !e_.certificate) return {};
    const std::string prefix = reading::input_name("");
    for (const auto& [input, digest] : e_.inputs) {
      if (input.starts_with(reading::shared_name(""))) continue;  // what another campaign has
      if (input.starts_with(config::machine_prefix)) {
        attach_machine();
        continue;
      }
      const bool is_file = input.starts_with(prefix);
      const std::string name = is_file ? input.substr(prefix.size()) : input;
      const auto path = storage::path_inside(folder_, name);
      if (!path) return fail(path.error());
      auto bytes = storage::read_file(*path);
      if (!bytes) return fail(bytes.error());
      if (storage::sha256(*bytes) != digest)
        return fail(name + " was changed while the campaign was evaluated");
      const bool csv = name.ends_with(".csv");
      add(name, std::move(*bytes),
          !is_file ? "application/toml"
          : csv    ? "text/csv"
                   : "application/octet-stream",
          source_relation,
          is_file ? "readings" : "the campaign: what was measured, and how it is evaluated");
    }
    if (!context_.site.settings.empty())
      add(settings_name, context_.site.settings, "application/toml", source_relation,
          "what of the laboratory's settings has a say in the results");
    if (!context_.templates_json.empty())
      add(templates_name, context_.templates_json, "application/json", "Source",
          "words and layout of the documents");
    return {};
  }

  Expected<void> attach_results() {
    if (drafts_.empty() && !e_.certificate) return {};
    std::vector<evaluation::RecordedFile> files;
    for (const auto& w : outputs())
      for (const Artifact& a : w.result.artifacts)
        files.push_back({a.name, a.bytes.size(), storage::sha256(a.bytes)});
    auto text = Expected<std::string>(evaluation::results_json(e_, context_, files));
    if (how_.results) text = how_.results(std::move(*text));
    if (!text) return fail(text.error());
    add(evaluation::results_name, std::move(*text), "application/json", "Data",
        "the results as numbers");
    return {};
  }

  Expected<void> sign_pdf(Draft& d) {
    auto reserved = sign::reserve(d.artifact.bytes, attachments_, now_);
    if (!reserved) return fail(d.artifact.name + " " + reserved.error().message);
    d.artifact.bytes = std::move(*reserved);
    return sign(d.artifact, d.output);
  }

  evaluation::Evaluated& e_;
  const fs::path& folder_;
  const reading::Context& context_;
  const SignWith& how_;
  const sign::Time now_;
  std::vector<Draft> drafts_;
  std::vector<sign::Attachment> attachments_;
  std::vector<evaluation::IssuedFile> signed_;
};

}  // namespace

void remove_unsigned(evaluation::Evaluated& evaluated) {
  auto& certificate = evaluated.certificate;
  const bool draft = certificate && !certificate->issued;
  for (Results::Written& w : evaluated.results.outputs)
    std::erase_if(w.result.artifacts, [&](const Artifact& a) {
      return a.sign || (draft && w.plugin == certificate->output);
    });
  if (draft) certificate.reset();
}

namespace {

/// Of a draft its pages stay, under a name that says so: what is signed comes with the number.
void keep_draft(evaluation::Evaluated& evaluated) {
  for (Results::Written& w : evaluated.results.outputs) {
    auto& artifacts = w.result.artifacts;
    const bool own = w.plugin == evaluated.certificate->output;
    std::erase_if(artifacts, [&](const Artifact& a) { return own ? !is_pdf(a) : a.sign; });
    if (own)
      for (Artifact& a : artifacts) a = {draft_name(a.name), std::move(a.bytes)};
  }
}

}  // namespace

std::string draft_name(const std::string& pdf) {
  const fs::path name = pdf;
  return name.stem().string() + "-draft" + name.extension().string();
}

void note_finding(evaluation::Evaluated& evaluated, const std::string& output, Finding finding,
                  const Templates& templates) {
  finding.advice = finding_text(templates, "en", finding, "advice");
  if (finding.attention) evaluated.status = "attention";
  for (Results::Written& w : evaluated.results.outputs)
    if (w.plugin == output) return w.result.findings.push_back(std::move(finding));
}

void note_time_stamp(evaluation::Evaluated& evaluated, const evaluation::IssuedFile& file,
                     const Templates& templates) {
  if (file.no_time_stamp.empty()) return;
  note_finding(evaluated, file.output,
               {.id = "signature.no-time-stamp",
                .attention = true,
                .texts = {{"file", file.name}, {"why", file.no_time_stamp}}},
               templates);
}

Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, const fs::path& folder,
                              const reading::Context& context, const Signer* signer,
                              sign::Time now) {
  const auto sign = [&](const Artifact& a) -> Expected<sign::Signed> {
    if (signer == nullptr) return fail(no_key);
    return signer->sign(a.bytes);
  };
  const auto& certificate = evaluated.certificate;
  const bool is_wanted =
      certificate ? !certificate->issued && !certificate->draft : is_asked(evaluated.results);
  if (is_wanted && signer == nullptr && evaluated.status != "failed") return fail(no_key);
  return sign_artifacts(evaluated, folder, context, SignWith{sign}, now);
}

Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, const fs::path& folder,
                              const reading::Context& context, const SignWith& how,
                              sign::Time now) {
  if (!evaluated.certificate && !is_asked(evaluated.results)) return {};
  if (evaluated.status == "failed") {
    remove_unsigned(evaluated);
    return {};
  }
  if (evaluated.certificate && evaluated.certificate->issued) return {};
  if (evaluated.certificate && evaluated.certificate->draft) {
    keep_draft(evaluated);
    return {};
  }
  return Desk(evaluated, folder, context, how, now).run();
}

}  // namespace nonio::host::certificates
