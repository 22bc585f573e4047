// SPDX-License-Identifier: Apache-2.0
#include "certificates/content_check.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include "campaign/config/template_files.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "campaign/reading/campaign_reader.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "certificates/certificates.h"
#include "certificates/numbering.h"
#include "certificates/recomputed.h"
#include "platform/process/child.h"
#include "platform/process/guarded.h"
#include "platform/process/shared_status.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

const pdf::Attachment* find_attachment(const sign::Verified& v, std::string_view name) {
  for (const pdf::Attachment& a : v.attachments)
    if (a.name == name) return &a;
  return nullptr;
}

namespace {

using State = sign::Check::State;

/// Returns an error if the name of an attachment leads out of the folder.
Expected<void> unpack(const sign::Verified& v, const fs::path& folder) {
  for (const pdf::Attachment& a : v.attachments) {
    const fs::path name = fs::path(a.name).lexically_normal();
    if (a.name.find('\0') != std::string::npos || name.is_absolute() || name.empty() ||
        *name.begin() == "..")
      return fail("the attachment \"" + a.name + "\" is not a name below a folder");
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    std::ofstream file(folder / name, std::ios::binary);
    file << a.bytes;
    if (error || !file.flush()) return fail("no room to unpack " + a.name);
  }
  return {};
}

struct Stated {
  std::optional<evaluation::Certificate> certificate;
  std::string nonio;
  /// Files that another campaign had too, each with the id of that campaign.
  std::vector<std::pair<std::string, std::string>> shared;
};

void put_shared(const storage::Json& analyses, Stated& stated) {
  const auto text = [](const storage::Json& of, const char* key) {
    return of.is_object() && of.contains(key) && of[key].is_string() ? of[key].get<std::string>()
                                                                     : std::string();
  };
  for (const storage::Json& analysis : analyses) {
    if (text(analysis, "plugin") != reading::plausibility_name || !analysis.contains("findings"))
      continue;
    for (const storage::Json& f : analysis["findings"])
      if (text(f, "id") == reading::file_of_another_campaign && f.contains("evidence"))
        stated.shared.emplace_back(text(f["evidence"], "file"), text(f["evidence"], "campaign"));
  }
}

Stated stated_in(std::string_view results) {
  const storage::Json json = storage::parse_once(results);
  Stated stated;
  if (!json.is_object()) return stated;
  if (json.contains("nonio") && json["nonio"].is_string())
    stated.nonio = json["nonio"].get<std::string>();
  if (json.contains("certificate") && json["certificate"].is_object())
    stated.certificate = evaluation::certificate_of(json["certificate"]);
  if (json.contains("analyses")) put_shared(json["analyses"], stated);
  return stated;
}

sign::Check not_checked(const char* id, std::string why) {
  return {id, State::not_checked, std::move(why), false};
}

sign::Check answered(const char* id, const Expected<std::string>& answer) {
  return {id, answer ? State::holds : State::fails, answer ? *answer : answer.error().message};
}

struct Content {
  sign::Check values, attachments, templates, words, printed;
};

/// Runs in a process of its own, because plugins read the attachments.
class Again {
 public:
  Again(const sign::Verified& v, std::string_view pdf, const fs::path& folder,
        const reading::Context& shared)
      : v_(v),
        pdf_(pdf),
        folder_(folder),
        installed_(shared),
        context_(shared),
        results_(find_attachment(v, evaluation::results_name)->bytes),
        stated_(stated_in(results_)) {}

  Expected<Content> run() {
    if (const pdf::Attachment* settings = find_attachment(v_, settings_name)) {
      auto site = config::parse_site(settings->bytes, settings_name);
      if (!site) return fail(site.error().front());
      context_.site = std::move(*site);
    }
    context_.machines.clear();
    if (const pdf::Attachment* machine = find_attachment(v_, config::machine_record_name)) {
      NONIO_TRY(auto record, config::unpacked_record(machine->bytes));
      context_.machines.push_back(std::move(record));
    }
    Content content;
    content.templates = take_templates();
    content.words = same_words();
    const std::string why = why_not_drawn(content.templates);
    const auto quiet = [](const std::string&) {};
    reading::ReadCampaign read = reading::read_campaign(folder_, context_, quiet);
    if (!read.manifest) return fail(read.errors.front());
    const std::string id = read.manifest->campaign.id;
    evaluation::AnalysedCampaign analysed =
        evaluation::analyse(std::move(read), id, context_, quiet, shared());
    std::optional<evaluation::AssignedNumber> number;
    if (analysed.number && stated_.certificate && why.empty()) number = stated_number(analysed);
    evaluation::Evaluated again = evaluation::write_documents(
        std::move(analysed), number ? &*number : nullptr, context_, quiet);
    content.attachments = answered("content.attachments", check_names(again));
    evaluation::Evaluated numbers = again;
    numbers.results.outputs.clear();
    content.values = answered(
        "content.values", same_values(results_, evaluation::results_json(numbers, context_, {})));
    content.printed = why.empty() ? answered("content.printed", same_file(again))
                                  : not_checked("content.printed", why);
    return content;
  }

 private:
  reading::Twins shared() const {
    reading::Twins twins;
    for (const auto& [file, campaign] : stated_.shared)
      if (const pdf::Attachment* a = find_attachment(v_, file))
        twins.emplace_back(storage::short_digest(storage::sha256(a->bytes)), campaign);
    return twins;
  }

  /// Incomplete or different templates do not end the other checks.
  sign::Check take_templates() {
    constexpr const char* id = "content.templates";
    if (stated_.nonio != context_.version)
      return not_checked(id, "the file was made by another version");
    const pdf::Attachment* carried = find_attachment(v_, templates_name);
    if (carried == nullptr) return {id, State::fails, "none are attached"};
    auto own = config::templates_from(carried->bytes, installed_.templates,
                                      installed_.template_texts.json);
    if (!own) return {id, State::fails, own.error().message};
    if (stated_.certificate && stated_.certificate->templates_sha256 != own->sha256)
      return {id, State::fails, "the attached ones are not those that results.json names"};
    strange_ = std::move(own->strange);
    missing_ = own->missing;
    if (!missing_.empty()) return not_checked(id, missing_ + " is not installed as it was then");
    context_.templates = std::move(own->templates);
    context_.template_texts.sha256 = own->sha256;
    context_.template_texts.json = carried->bytes;
    return {id, State::holds, "the attached ones are those that results.json names"};
  }

  /// Other words could state the opposite for the same readings and signer.
  sign::Check same_words() const {
    if (!strange_) return not_checked(words_check, "needs the templates of this version");
    if (strange_->empty())
      return {words_check, State::holds, "the words and the layout are those installed"};
    return {words_check, State::fails,
            "the words and the layout are those attached, not those installed: " +
                storage::listed(*strange_)};
  }

  /// Returns an empty text if the file can be made again.
  std::string why_not_drawn(const sign::Check& templates) const {
    if (stated_.nonio != context_.version)
      return "was made by version \"" + stated_.nonio + "\", this is " + context_.version;
    if (templates.state == State::fails || !missing_.empty()) return templates.says;
    return {};
  }

  evaluation::AssignedNumber stated_number(const evaluation::AnalysedCampaign& analysed) {
    evaluation::AssignedNumber number{stated_.certificate, analysed.number->missing, std::nullopt};
    auto readings = files_.readings_sha256(analysed.evaluated.inputs);
    if (readings)
      number.certificate->issue.readings_sha256 = std::move(*readings);
    else
      number.error = readings.error();
    return number;
  }

  /// Accepts only attachments that the manifest, Nonio or results.json requires.
  Expected<std::string> check_names(const evaluation::Evaluated& again) const {
    std::vector<std::string> wanted = {evaluation::results_name};
    const std::string prefix = reading::input_name("");
    for (const auto& [input, digest] : again.inputs)
      if (!input.starts_with(reading::shared_name("")) &&
          !input.starts_with(config::machine_prefix))
        wanted.push_back(input.starts_with(prefix) ? input.substr(prefix.size()) : input);
    for (const char* name : {settings_name, templates_name, config::machine_record_name})
      if (find_attachment(v_, name) != nullptr) wanted.emplace_back(name);
    for (const pdf::Attachment& a : v_.attachments)
      if (is_document(a) && is_listed(a)) wanted.push_back(a.name);
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    for (const pdf::Attachment& a : v_.attachments)
      if (!std::binary_search(wanted.begin(), wanted.end(), a.name))
        return fail("the attachment \"" + a.name + "\" belongs to nothing");
    for (const std::string& name : wanted)
      if (find_attachment(v_, name) == nullptr) return fail(name + " is not attached");
    return std::to_string(wanted.size()) + " files, each with its place in the campaign";
  }

  bool is_listed(const pdf::Attachment& a) const {
    const storage::Json json = storage::parse_once(results_);
    if (!json.is_object() || !json.contains("outputs") || !json["outputs"].is_array()) return false;
    return std::any_of(
        json["outputs"].begin(), json["outputs"].end(), [&](const storage::Json& file) {
          return file.is_object() && file.contains("file") && file["file"] == a.name &&
                 file.contains("sha256") && file["sha256"] == storage::sha256(a.bytes);
        });
  }

  /// Repeats the steps of a run up to the signature, and compares the bytes to be signed.
  Expected<std::string> same_file(evaluation::Evaluated& again) {
    if (again.status == evaluation::Status::failed)
      return fail("the attached readings cannot be evaluated: " +
                  again.results.errors.front().message);
    NONIO_TRY(const auto time, pdf::stated_time(pdf_));
    std::size_t pages = 0;
    std::string difference;
    SignWith how;
    how.sign = [&](const Artifact& a) -> Expected<sign::Signed> {
      if (!a.bytes.starts_with("%PDF-")) return same_dcc(a);
      const auto same = pdf::same_pdf(pdf_, a.bytes);
      if (!same)
        difference += (difference.empty() ? "" : "; ") + a.name +
                      " from the attached readings: " + where_pages_differ(a.bytes) +
                      same.error().message;
      else if (const auto drawn = pdf::page_contents(a.bytes))
        pages = drawn->size();
      return sign::Signed{a.bytes};
    };
    how.results = [&](const std::string& made) -> Expected<std::string> {
      std::vector<std::string> names;
      for (const pdf::Attachment& a : v_.attachments) names.push_back(a.name);
      if (auto same = same_results(results_, made, names); !same) return fail(same.error());
      return results_;
    };
    if (const auto done = sign_artifacts(again, files_, context_, how, time); !done)
      return fail(done.error());
    if (pages != 0)
      return "the attached readings give this file and the same " + std::to_string(pages) +
             (pages == 1 ? " page" : " pages");
    return fail(difference.empty() ? "the attached readings give no document that is signed"
                                   : difference);
  }

  Expected<sign::Signed> same_dcc(const Artifact& made) const {
    const pdf::Attachment* attached = find_attachment(v_, made.name);
    if (attached == nullptr) return fail("it is not attached");
    if (auto same = sign::same_document(attached->bytes, made.bytes); !same)
      return fail(same.error());
    return sign::Signed{attached->bytes};
  }

  std::string where_pages_differ(std::string_view made) const {
    const auto now = pdf::page_contents(made), then = pdf::page_contents(pdf_);
    if (!now || !then) return {};
    const auto differ = std::mismatch(now->begin(), now->end(), then->begin(), then->end());
    if (differ.first == now->end() && differ.second == then->end()) return {};
    return "page " + std::to_string(differ.second - then->begin() + 1) + " is another, ";
  }

  const sign::Verified& v_;
  std::string_view pdf_;
  const fs::path& folder_;
  CampaignFiles files_{folder_};
  const reading::Context& installed_;
  reading::Context context_;
  const std::string& results_;
  Stated stated_;
  /// Attached templates that differ from the installed ones; nullopt if not compared.
  std::optional<std::vector<std::string>> strange_;
  std::string missing_;  ///< name of a missing or different font, or empty
};

constexpr std::array check_ids = {"content.values", "content.attachments", "content.templates",
                                  words_check, "content.printed"};

std::string line_of(const sign::Check& check) {
  constexpr std::size_t most = 900;
  std::string text = check.says.substr(0, most);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return (check.state == State::holds   ? "+"
          : check.state == State::fails ? "-"
                                        : "?") +
         text + "\n";
}

sign::Check check_of(const char* id, std::string& answer) {
  const std::size_t end = answer.find('\n');
  const std::string line = answer.substr(0, end);
  answer.erase(0, end == std::string::npos ? end : end + 1);
  if (line.starts_with('?')) return not_checked(id, line.substr(1));
  return {id, line.starts_with('+') ? State::holds : State::fails,
          line.empty() ? "there is no answer" : line.substr(1)};
}

/// Runs the checks in a confined process. Returns one line for each of `check_ids`.
Expected<std::string> recompute_apart(const sign::Verified& v, std::string_view pdf,
                                      const reading::Context& context) {
  for (const char* name : {config::manifest_name, evaluation::results_name})
    if (find_attachment(v, name) == nullptr)
      return fail(std::string("cannot be recomputed: ") + name + " is not attached");
  const storage::ScratchFolder scratch("verify");
  process::SharedStatus words;
  if (scratch.path().empty()) return fail("no folder for temporary files");
  if (!words.valid()) return fail("no memory");
  if (auto unpacked = unpack(v, scratch.path()); !unpacked) return fail(unpacked.error());
  const config::Limits& limits = context.site.limits;
  auto child = process::Child::start("the evaluation", {.memory_MB = limits.memory_MB}, [&] {
    const auto content = process::guarded(
        "the evaluation", [&] { return Again(v, pdf, scratch.path(), context).run(); });
    words.set(content ? line_of(content->values) + line_of(content->attachments) +
                            line_of(content->templates) + line_of(content->words) +
                            line_of(content->printed)
                      : line_of({check_ids[0], State::fails, content.error().message}) +
                            "?not looked at\n?not looked at\n?not looked at\n?not drawn again\n");
  });
  if (!child) return fail(child.error());
  const process::ChildEnd end = child->wait(limits.seconds);
  if (!end.well) return fail("the evaluation did not come back: " + end.words);
  return words.get();
}

}  // namespace

bool is_document(const pdf::Attachment& a) {
  return a.name.ends_with(".xml") && a.type == "application/xml";
}

std::vector<sign::Check> check_content(const sign::Verified& v, std::string_view pdf,
                                       const reading::Context& context) {
  auto answer = recompute_apart(v, pdf, context);
  if (!answer)
    return {{check_ids[0], State::fails, answer.error().message},
            not_checked(check_ids.back(), "the readings are not evaluated")};
  std::vector<sign::Check> checks;
  for (const char* name : check_ids) checks.push_back(check_of(name, *answer));
  return checks;
}

}  // namespace nonio::certificates
