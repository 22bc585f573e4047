// SPDX-License-Identifier: Apache-2.0
#include "certificates/certificates.h"

#include <algorithm>

#include "campaign/evaluation/results_json.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

bool is_pdf(const Artifact& a) { return a.bytes.starts_with("%PDF-"); }

bool is_asked(const Results& results) {
  return std::any_of(results.outputs.begin(), results.outputs.end(), [](const auto& w) {
    return std::any_of(w.result.artifacts.begin(), w.result.artifacts.end(),
                       [](const Artifact& a) { return a.sign; });
  });
}

/// A PDF to be signed. It is removed from the artifacts while its attachments are made, because
/// results.json cannot state the digest of a file that contains it.
struct Draft {
  std::size_t output, place;
  Artifact artifact;
};

using Attachments = std::vector<pdf::Attachment>;

Expected<evaluation::IssuedFile> signed_by(const SignWith& how, Artifact& a,
                                           const std::string& output) {
  auto done = how.sign(a);
  if (!done) return fail(a.name + " could not be signed: " + done.error().message);
  a.bytes = std::move(done->bytes);
  return evaluation::IssuedFile{output, a.name, a.bytes, std::move(done->no_time_stamp)};
}

Expected<void> sign_documents(evaluation::Evaluated& evaluated, const SignWith& how,
                              std::vector<evaluation::IssuedFile>& done, Attachments& attachments) {
  for (Results::Written& w : evaluated.results.outputs)
    for (Artifact& a : w.result.artifacts) {
      if (!a.sign || is_pdf(a)) continue;
      NONIO_TRY(auto file, signed_by(how, a, w.plugin));
      done.push_back(std::move(file));
      attachments.push_back({a.name, a.bytes, "application/xml", "Data",
                             "digital calibration certificate, with a signature of its own"});
    }
  return {};
}

std::vector<Draft> take_drafts(evaluation::Evaluated& evaluated) {
  std::vector<Draft> drafts;
  auto& outputs = evaluated.results.outputs;
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    auto& artifacts = outputs[o].result.artifacts;
    for (std::size_t i = 0, place = 0; i < artifacts.size(); ++place) {
      if (!artifacts[i].sign || !is_pdf(artifacts[i])) {
        ++i;
        continue;
      }
      drafts.push_back({o, place, std::move(artifacts[i])});
      artifacts.erase(artifacts.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return drafts;
}

void put_back(evaluation::Evaluated& evaluated, std::vector<Draft>& drafts) {
  for (Draft& d : drafts) {
    auto& artifacts = evaluated.results.outputs[d.output].result.artifacts;
    artifacts.insert(artifacts.begin() + static_cast<std::ptrdiff_t>(d.place),
                     std::move(d.artifact));
  }
}

Expected<pdf::Attachment> attached_input(const std::string& input, const std::string& digest,
                                         CampaignFiles& files) {
  const bool is_manifest = input == config::manifest_name;
  const std::string name = file_of_input(input);
  NONIO_TRY(const auto bytes, files.bytes(name, digest));
  const bool csv = name.ends_with(".csv");
  return pdf::Attachment{
      name, std::string(bytes),
      is_manifest ? "application/toml"
      : csv       ? "text/csv"
                  : "application/octet-stream",
      source_relation,
      is_manifest ? "the campaign: what was measured, and how it is evaluated" : "readings"};
}

Expected<void> attach_sources(const evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, Attachments& to) {
  for (const auto& [input, digest] : evaluated.inputs) {
    if (input.starts_with(reading::shared_name(""))) continue;  // a file of another campaign
    if (input.starts_with(config::machine_prefix)) {
      const auto record = config::record_of(context.machines, evaluated.campaign.machine);
      if (record && *record != nullptr)
        to.push_back({config::machine_record_name, config::packed(**record), "application/json",
                      "Source", "the site's data of the machine"});
      continue;
    }
    NONIO_TRY(auto one, attached_input(input, digest, files));
    to.push_back(std::move(one));
  }
  if (!context.site.settings.empty())
    to.push_back({settings_name, context.site.settings, "application/toml", source_relation,
                  "what of the laboratory's settings has an effect in the results"});
  if (!context.template_texts.json.empty())
    to.push_back({templates_name, context.template_texts.json, "application/json", "Source",
                  "words and layout of the documents"});
  return {};
}

Expected<void> attach_results(const evaluation::Evaluated& evaluated,
                              const reading::Context& context, const SignWith& how,
                              Attachments& to) {
  std::vector<evaluation::RecordedFile> files;
  for (const auto& w : evaluated.results.outputs)
    for (const Artifact& a : w.result.artifacts)
      files.push_back({a.name, a.bytes.size(), storage::sha256(a.bytes)});
  auto text = Expected<std::string>(evaluation::results_json(evaluated, context, files));
  if (how.results) text = how.results(std::move(*text));
  if (!text) return fail(text.error());
  to.push_back({evaluation::results_name, std::move(*text), "application/json", "Data",
                "the results as numbers"});
  return {};
}

/// The last attachment is results.json.
Expected<void> attach_all(const evaluation::Evaluated& evaluated, CampaignFiles& files,
                          const reading::Context& context, const SignWith& how, Attachments& to) {
  if (auto done = attach_sources(evaluated, files, context, to); !done) return done;
  return attach_results(evaluated, context, how, to);
}

Expected<void> sign_drafts(std::vector<Draft>& drafts, const evaluation::Evaluated& evaluated,
                           const SignWith& how, sign::Time now, const Attachments& attachments,
                           std::vector<evaluation::IssuedFile>& done) {
  for (Draft& d : drafts) {
    auto reserved = pdf::reserve(d.artifact.bytes, attachments, now);
    if (!reserved) return fail(d.artifact.name + " " + reserved.error().message);
    d.artifact.bytes = std::move(*reserved);
    NONIO_TRY(auto file, signed_by(how, d.artifact, evaluated.results.outputs[d.output].plugin));
    done.push_back(std::move(file));
  }
  return {};
}

/// Keeps all files of the numbered output, and those of other outputs that were signed.
Expected<void> keep_for_register(const evaluation::Evaluated& evaluated,
                                 std::vector<evaluation::IssuedFile> done, std::string results,
                                 evaluation::Certificate& certificate) {
  const auto is_own = [&](const evaluation::IssuedFile& f) {
    return f.output == certificate.output;
  };
  if (std::none_of(done.begin(), done.end(), is_own))
    return fail("output " + certificate.output +
                " makes nothing that is signed, and nothing else is issued under a number");
  const auto time_stamp_of = [&](const std::string& name) {
    const auto file =
        std::find_if(done.begin(), done.end(), [&](const auto& f) { return f.name == name; });
    return file == done.end() ? std::string() : file->no_time_stamp;
  };
  for (const auto& w : evaluated.results.outputs)
    if (w.plugin == certificate.output)
      for (const Artifact& a : w.result.artifacts)
        certificate.files.push_back({w.plugin, a.name, a.bytes, time_stamp_of(a.name)});
  for (evaluation::IssuedFile& file : done)
    if (!is_own(file)) certificate.files.push_back(std::move(file));
  certificate.results = std::move(results);
  return {};
}

/// DCCs are signed before the PDFs, because the PDFs contain them as attachments.
Expected<void> sign_all(evaluation::Evaluated& evaluated, CampaignFiles& files,
                        const reading::Context& context, const SignWith& how, sign::Time now) {
  std::vector<evaluation::IssuedFile> signed_files;
  Attachments attachments;
  auto done = sign_documents(evaluated, how, signed_files, attachments);
  if (!done) return done;
  std::vector<Draft> drafts = take_drafts(evaluated);
  if (!drafts.empty() || evaluated.certificate)
    done = attach_all(evaluated, files, context, how, attachments);
  if (done) done = sign_drafts(drafts, evaluated, how, now, attachments, signed_files);
  put_back(evaluated, drafts);
  if (!done) return done;
  if (evaluated.certificate)
    return keep_for_register(evaluated, std::move(signed_files),
                             std::move(attachments.back().bytes), *evaluated.certificate);
  for (const evaluation::IssuedFile& file : signed_files) note_time_stamp(evaluated, file);
  for (auto& w : evaluated.results.outputs)
    for (Artifact& a : w.result.artifacts) a.sign = false;
  return done;
}

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

/// Keeps only the PDFs of the certificate's output, with names that mark drafts.
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

void note_finding(evaluation::Evaluated& evaluated, const std::string& output, Finding finding) {
  if (finding.attention) evaluated.status = evaluation::Status::attention;
  for (Results::Written& w : evaluated.results.outputs)
    if (w.plugin == output) return w.result.findings.push_back(std::move(finding));
}

void note_time_stamp(evaluation::Evaluated& evaluated, const evaluation::IssuedFile& file) {
  if (file.no_time_stamp.empty()) return;
  note_finding(evaluated, file.output,
               {.id = "signature.no-time-stamp",
                .attention = true,
                .texts = {{"file", file.name}, {"why", file.no_time_stamp}}});
}

Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const Signer* signer,
                              sign::Time now) {
  const auto sign = [&](const Artifact& a) -> Expected<sign::Signed> {
    if (signer == nullptr) return fail(no_key);
    return signer->sign(a.bytes);
  };
  const auto& certificate = evaluated.certificate;
  const bool is_wanted =
      certificate ? !certificate->issued && !certificate->draft : is_asked(evaluated.results);
  if (is_wanted && signer == nullptr && evaluated.status != evaluation::Status::failed)
    return fail(no_key);
  return sign_artifacts(evaluated, files, context, SignWith{sign}, now);
}

Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const SignWith& how,
                              sign::Time now) {
  if (!evaluated.certificate && !is_asked(evaluated.results)) return {};
  if (evaluated.status == evaluation::Status::failed) {
    remove_unsigned(evaluated);
    return {};
  }
  if (evaluated.certificate && evaluated.certificate->issued) return {};
  if (evaluated.certificate && evaluated.certificate->draft) {
    keep_draft(evaluated);
    return {};
  }
  return sign_all(evaluated, files, context, how, now);
}

}  // namespace nonio::certificates
