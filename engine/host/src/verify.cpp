// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/verify.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "certificates.h"
#include "child.h"
#include "context.h"
#include "guarded.h"
#include "nonio/host/files.h"
#include "nonio/host/results_json.h"
#include "recomputed.h"
#include "worker.h"

namespace nonio::host {
namespace fs = std::filesystem;

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

const sign::Attachment* find(const sign::Verified& v, std::string_view name) {
  for (const sign::Attachment& a : v.attachments)
    if (a.name == name) return &a;
  return nullptr;
}

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

/// In a process of its own: plugins read what is attached.
Expected<std::string> recompute(const sign::Verified& v, const fs::path& folder,
                                const Context& shared) {
  Context context = shared;
  if (const sign::Attachment* settings = find(v, settings_name)) {
    auto site = parse_site(settings->bytes, settings_name);
    if (!site) return fail(site.error().front());
    context.site = std::move(*site);
  }
  auto manifest = parse_manifest(find(v, manifest_name)->bytes, manifest_name);
  if (!manifest) return fail(manifest.error().front());
  Evaluated again = evaluate(folder, manifest->campaign.id, context, [](const std::string&) {});
  again.results.outputs.clear();
  return same_values(find(v, results_name)->bytes, results_json(again, context, {}));
}

sign::Check check_values(const sign::Verified& v, const Context& context) {
  sign::Check check{"content.values", State::fails, {}};
  for (const char* name : {manifest_name, results_name})
    if (find(v, name) == nullptr) {
      check.says = std::string("cannot be recomputed: ") + name + " is not attached";
      return check;
    }
  const ScratchFolder scratch;
  SharedWords words;
  const auto unpacked = scratch.path().empty()
                            ? Expected<void>(fail("no folder for temporary files"))
                            : unpack(v, scratch.path());
  if (!unpacked || !words.valid()) {
    check.says = unpacked ? "no memory" : unpacked.error().message;
    return check;
  }
  const pid_t child = ::fork();
  if (child == 0) {
    settle_child();
    limit_memory(context.site.limits.memory_MB);
    const auto same =
        guarded("the evaluation", [&] { return recompute(v, scratch.path(), context); });
    words.set(same ? "+" + *same : same.error().message);
    ::_exit(0);
  }
  const ChildEnd end = child < 0 ? ChildEnd{false, "no process"}
                                 : wait_for_child(child, context.site.limits.seconds);
  check.says = end.well ? words.get() : "the evaluation did not come back: " + end.words;
  if (end.well && check.says.starts_with('+')) {
    check.state = State::holds;
    check.says.erase(0, 1);
  }
  return check;
}

void check_documents(sign::Verified& v, const sign::Verifier& verifier) {
  bool any = false;
  for (const sign::Attachment& a : v.attachments) {
    if (!a.name.ends_with(".xml") || a.type != "application/xml") continue;
    any = true;
    for (sign::Check& c : sign::verify_xml(a.bytes, verifier, v.certificate).checks) {
      c.id = "dcc." + c.id.substr(c.id.find('.') + 1);
      c.says = a.name + ": " + c.says;
      v.checks.push_back(std::move(c));
    }
    v.checks.push_back(check_dcc(a, find(v, results_name)));
  }
  if (!any) v.checks.push_back({"dcc", State::not_checked, "none is attached", false});
}

sign::Verified refused(const std::string& why) {
  sign::Verified v;
  v.checks.push_back({"file.structure", State::fails, why});
  return v;
}

Expected<std::string> text_at(const fs::path& path) {
  if (path.empty()) return std::string();
  return read_file(path);
}

}  // namespace

Checked<sign::Verifier> verifier_of(const VerifyOptions& options) {
  VerifyOptions o = options;
  if (!o.site.empty()) {
    std::string digest;
    const auto site = read_site(o.site, digest);
    if (!site) return tl::unexpected(site.error());
    if (const auto& s = site->signing) {
      if (o.trust.empty() && !s->trust.empty()) o.trust = o.site / s->trust;
      if (o.revocation.empty() && !s->revocation.empty()) o.revocation = o.site / s->revocation;
      if (o.signer.empty()) o.signer = s->signer;
    }
  }
  auto trust = text_at(o.trust), revocation = text_at(o.revocation);
  for (const auto* text : {&trust, &revocation})
    if (!*text) return tl::unexpected(std::vector<Error>{text->error()});
  return sign::Verifier{std::move(*trust), std::move(*revocation), o.signer, std::time(nullptr)};
}

Expected<std::unique_ptr<Workplace>> open_to_verify(const std::vector<fs::path>& plugin_folders,
                                                    const std::vector<fs::path>& template_folders,
                                                    const std::string& version) {
  auto place = std::make_unique<Workplace>();
  Context& context = place->context;
  context.version = version;
  auto templates = read_templates(template_folders, context.templates_sha256);
  if (!templates) return fail(templates.error());
  context.templates = std::move(*templates);
  place->plugins.load(plugin_folders);
  if (!place->plugins.conflicts().empty()) return fail(place->plugins.conflicts().front());
  context.plugins = &place->plugins;
  return place;
}

sign::Verified verify_file(const fs::path& path, const sign::Verifier& verifier,
                           const Context& context) {
  const auto bytes = read_file(path);
  if (!bytes) return refused(bytes.error().message);
  if (bytes->starts_with("<?xml")) {
    sign::Verified v = sign::verify_xml(*bytes, verifier);
    if (v.holds())
      v.checks.push_back(check_dcc({path.filename().string(), *bytes, {}, {}, {}}, nullptr));
    return v;
  }
  sign::Verified v = sign::verify_pdf(*bytes, verifier);
  const bool is_signed = std::none_of(v.checks.begin(), v.checks.end(),
                                      [](const sign::Check& c) { return c.state == State::fails; });
  // What nobody signed is not given to plugins.
  if (!is_signed) {
    v.checks.push_back({"content.values", State::not_checked, "the signature does not hold"});
    return v;
  }
  check_documents(v, verifier);
  v.checks.push_back(check_values(v, context));
  return v;
}

}  // namespace nonio::host
