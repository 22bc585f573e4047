// SPDX-License-Identifier: Apache-2.0
#include "content_check.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "certificates.h"
#include "child.h"
#include "guarded.h"
#include "json_values.h"
#include "nonio/host/files.h"
#include "nonio/host/record.h"
#include "nonio/host/results_json.h"
#include "numbering.h"
#include "recomputed.h"
#include "worker.h"

namespace nonio::host {
namespace fs = std::filesystem;

const sign::Attachment* find_attachment(const sign::Verified& v, std::string_view name) {
  for (const sign::Attachment& a : v.attachments)
    if (a.name == name) return &a;
  return nullptr;
}

namespace {

using State = sign::Check::State;

/// A folder that goes away with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string path = (fs::temp_directory_path(error_) / "nonio-verify-XXXXXX").string();
    if (::mkdtemp(path.data()) != nullptr) path_ = path;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    if (!path_.empty()) fs::remove_all(path_, error_);
  }
  const fs::path& path() const { return path_; }

 private:
  std::error_code error_;
  fs::path path_;
};

/// The campaign's folder as it was, from what is attached.
Expected<void> unpack(const sign::Verified& v, const fs::path& folder) {
  for (const sign::Attachment& a : v.attachments) {
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

/// What an attached results.json says of the number that was issued, and by which version.
struct Stated {
  Certificate certificate;
  std::string nonio;
};

/// None if there is no number.
std::optional<Stated> stated_in(std::string_view results) {
  const Json json = Json::parse(results, nullptr, false);
  if (!json.is_object() || !json.contains("certificate") || !json["certificate"].is_object())
    return std::nullopt;
  const Json& c = json["certificate"];
  const auto text = [](const Json& object, const char* key) {
    return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
  };
  Stated stated;
  stated.nonio = text(json, "nonio");
  stated.certificate.output = text(c, "plugin");
  stated.certificate.templates_sha256 = text(c, "templates_sha256");
  Issue& issue = stated.certificate.issue;
  issue.number = text(c, "number");
  issue.date = text(c, "date");
  issue.replaces = text(c, "replaces");
  issue.replaces_date = text(c, "replaces_date");
  if (c.contains("changes") && c["changes"].is_array())
    for (const Json& file : c["changes"])
      if (file.is_string()) issue.changes.push_back(file.get<std::string>());
  return stated;
}

/// Why the pages cannot be drawn as they were; empty if they can.
std::string why_not_drawn(const std::optional<Stated>& stated, const Context& context) {
  if (!stated) return "has no number: only certificates are drawn again";
  if (stated->nonio != context.version)
    return "was issued by version " + stated->nonio + ", this is " + context.version;
  if (stated->certificate.templates_sha256 != context.templates_sha256)
    return "was issued with other templates than are given here (--site, --templates)";
  return {};
}

sign::Check check_pages(const Evaluated& again, const std::string& output, std::string_view pdf) {
  sign::Check check{"content.printed", State::fails, {}};
  const Artifact* drawn = nullptr;
  for (const Results::Written& w : again.results.outputs)
    for (const Artifact& a : w.result.artifacts)
      if (w.plugin == output && a.bytes.starts_with("%PDF-")) drawn = &a;
  if (drawn == nullptr) {
    check.says = "the output " + output + " does not draw it again" +
                 (again.results.errors.empty() ? "" : ": " + again.results.errors.front().message);
    return check;
  }
  const auto now = sign::page_contents(drawn->bytes), then = sign::page_contents(pdf);
  if (!now || !then) {
    check.says = now ? then.error().message : now.error().message;
    return check;
  }
  const auto differ = std::mismatch(now->begin(), now->end(), then->begin(), then->end());
  if (differ.first == now->end() && differ.second == then->end()) {
    check.state = State::holds;
    check.says = "the attached readings give the same " + std::to_string(then->size()) +
                 (then->size() == 1 ? " page" : " pages");
  } else {
    check.says = "page " + std::to_string(differ.second - then->begin() + 1) +
                 " is not what the attached readings give";
  }
  return check;
}

struct Content {
  sign::Check values, printed;
};

/// In a process of its own: plugins read what is attached.
Expected<Content> recompute(const sign::Verified& v, std::string_view pdf, const fs::path& folder,
                            const Context& shared) {
  Context context = shared;
  if (const sign::Attachment* settings = find_attachment(v, settings_name)) {
    auto site = parse_site(settings->bytes, settings_name);
    if (!site) return fail(site.error().front());
    context.site = std::move(*site);
  }
  auto manifest = parse_manifest(find_attachment(v, manifest_name)->bytes, manifest_name);
  if (!manifest) return fail(manifest.error().front());
  const std::string& attached = find_attachment(v, results_name)->bytes;
  const auto stated = stated_in(attached);
  Content content{{"content.values", State::fails, {}},
                  {"content.printed", State::not_checked, why_not_drawn(stated, context), false}};
  const bool draws = content.printed.says.empty();
  const auto draw = [&](const Evaluated& e, std::vector<std::string>&) -> Expected<Certificate> {
    Certificate certificate = stated->certificate;
    const auto readings = readings_digest(e.inputs, folder);
    if (!readings) return fail(readings.error());
    certificate.issue.readings_sha256 = *readings;
    return certificate;
  };
  Evaluated again = evaluate(
      folder, manifest->campaign.id, context, [](const std::string&) {},
      draws ? Draw(draw) : Draw());
  if (draws) content.printed = check_pages(again, stated->certificate.output, pdf);
  again.results.outputs.clear();
  const auto same = same_values(attached, results_json(again, context, {}));
  content.values.state = same ? State::holds : State::fails;
  content.values.says = same ? *same : same.error().message;
  return content;
}

/// A line of a process that ends for the one that waits for it.
std::string line_of(const sign::Check& check) {
  constexpr std::size_t most = 1500;
  std::string text = check.says.substr(0, most);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return (check.state == State::holds ? "+" : check.state == State::fails ? "-" : "?") + text;
}

sign::Check check_of(const char* id, const std::string& line) {
  sign::Check check{id, State::fails, line.empty() ? "there is no answer" : line.substr(1)};
  if (line.starts_with('+')) check.state = State::holds;
  if (line.starts_with('?')) {
    check.state = State::not_checked;
    check.essential = false;
  }
  return check;
}

/// Two lines: values and pages.
Expected<std::string> recompute_apart(const sign::Verified& v, std::string_view pdf,
                                      const Context& context) {
  for (const char* name : {manifest_name, results_name})
    if (find_attachment(v, name) == nullptr)
      return fail(std::string("cannot be recomputed: ") + name + " is not attached");
  const ScratchFolder scratch;
  SharedWords words;
  if (scratch.path().empty()) return fail("no folder for temporary files");
  if (!words.valid()) return fail("no memory");
  if (auto unpacked = unpack(v, scratch.path()); !unpacked) return fail(unpacked.error());
  const pid_t child = ::fork();
  if (child == 0) {
    settle_child();
    limit_memory(context.site.limits.memory_MB);
    const auto content =
        guarded("the evaluation", [&] { return recompute(v, pdf, scratch.path(), context); });
    words.set(content ? line_of(content->values) + "\n" + line_of(content->printed)
                      : "-" + content.error().message.substr(0, 1500) + "\n?not drawn again");
    ::_exit(0);
  }
  const ChildEnd end = child < 0 ? ChildEnd{false, "no process"}
                                 : wait_for_child(child, context.site.limits.seconds);
  if (!end.well) return fail("the evaluation did not come back: " + end.words);
  return words.get();
}

}  // namespace

std::vector<sign::Check> check_content(const sign::Verified& v, std::string_view pdf,
                                       const Context& context) {
  const auto lines = recompute_apart(v, pdf, context);
  if (!lines)
    return {{"content.values", State::fails, lines.error().message},
            {"content.printed", State::not_checked, "the readings are not evaluated", false}};
  const std::size_t end = lines->find('\n');
  return {check_of("content.values", lines->substr(0, end)),
          check_of("content.printed", end == std::string::npos ? "" : lines->substr(end + 1))};
}

}  // namespace nonio::host
