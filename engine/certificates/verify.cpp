// SPDX-License-Identifier: Apache-2.0
#include "certificates/verify.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/evaluation/record.h"
#include "certificates/content_check.h"
#include "certificates/recomputed.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

using State = sign::Check::State;

void check_documents(sign::Verified& v, const sign::Verifier& verifier) {
  bool any = false;
  sign::Verifier inside = verifier;
  inside.existed = v.existed;
  for (const pdf::Attachment& a : v.attachments) {
    if (!is_document(a)) continue;
    any = true;
    for (sign::Check& c : sign::verify_xml(a.bytes, inside, v.certificate).checks) {
      c.id = "dcc." + c.id.substr(c.id.find('.') + 1);
      c.says = a.name + ": " + c.says;
      v.checks.push_back(std::move(c));
    }
    v.checks.push_back(check_dcc(a, find_attachment(v, evaluation::results_name)));
  }
  if (!any) v.checks.push_back({"dcc", State::not_checked, "none is attached", false});
}

constexpr std::string_view file_check = "file.readable", certificate_check = "file.certificate";

sign::Verified refused(std::string_view check, const std::string& why) {
  sign::Verified v;
  v.checks.push_back({std::string(check), State::fails, why});
  return v;
}

/// Returns nullopt if the signature has to be checked.
std::optional<std::string> why_no_certificate(std::string_view bytes) {
  const auto has = [&](std::string_view text) { return bytes.find(text) != bytes.npos; };
  if (bytes.starts_with("%PDF-")) {
    if (!has("/ByteRange"))
      return "is a PDF without a signature: as it is printed, joined or converted by another "
             "program; request the file as it was issued";
    if (!has("ETSI.CAdES.detached") || !has(evaluation::results_name))
      return "is a PDF that another program signed";
    return std::nullopt;
  }
  if (!bytes.starts_with("<?xml")) return "is neither a PDF nor an XML document";
  if (!has("http://www.w3.org/2000/09/xmldsig#")) return "is an XML document without a signature";
  if (!has("Nonio")) return "is an XML document that another program signed";
  return std::nullopt;
}

Expected<void> add_register_state(sign::Verified& v, std::string_view bytes,
                                  const RegisterRows& rows) {
  NONIO_TRY(auto state, check_register(v, bytes, rows));
  if (state) v.checks.push_back(std::move(*state));
  return {};
}

}  // namespace

Expected<std::unique_ptr<reading::Workplace>> open_to_verify(
    const std::vector<fs::path>& plugin_folders, std::vector<fs::path> template_folders,
    const fs::path& site, const std::string& version) {
  if (std::error_code error; !site.empty() && fs::is_directory(site / "templates", error))
    template_folders.push_back(site / "templates");
  auto place = std::make_unique<reading::Workplace>();
  reading::Context& context = place->context;
  context.version = version;
  NONIO_TRY(context.templates,
            config::read_templates(template_folders, {}, {}, &context.template_texts, true));
  place->plugins.load(plugin_folders);
  if (!place->plugins.conflicts().empty()) return fail(place->plugins.conflicts().front());
  context.plugins = &place->plugins;
  return place;
}

Expected<std::string> read_bounded(const fs::path& path) {
  const auto refuse = [&](const std::string& size) {
    return fail("is larger than " + std::to_string(sign::max_bytes / 1'000'000) + " MB" + size +
                ": no certificate of Nonio is");
  };
  std::error_code error;
  if (fs::is_directory(path, error)) return fail(path.string() + " is a folder, expected a file");
  // A pipe could block forever.
  if (const auto kind = fs::status(path, error).type();
      kind != fs::file_type::regular && kind != fs::file_type::not_found)
    return fail(path.string() + " is not a regular file");
  if (const auto size = fs::file_size(path, error); !error && size > sign::max_bytes)
    return refuse(" (" + std::to_string(size) + " bytes)");
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail("cannot read " + path.string());
  std::string bytes;
  if (const auto size = fs::file_size(path, error); !error) bytes.reserve(size + 1);
  std::vector<char> part(std::size_t{1} << 16);
  do {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    bytes.append(part.data(), static_cast<std::size_t>(file.gcount()));
    if (bytes.size() > sign::max_bytes) return refuse("");
  } while (file);
  if (file.bad()) return fail("cannot read " + path.string());
  return bytes;
}

Expected<sign::Verified> verify_file(const fs::path& path, const sign::Verifier& whom,
                                     const OpenContext& open, const RegisterRows& rows) {
  const auto bytes = read_bounded(path);
  if (!bytes) return refused(file_check, bytes.error().message);
  if (const auto why = why_no_certificate(*bytes)) return refused(certificate_check, *why);
  sign::Verifier verifier = whom;
  verifier.issued_by = issued_by(rows, *bytes);
  const bool is_xml = bytes->starts_with("<?xml");
  sign::Verified v =
      is_xml ? sign::verify_xml(*bytes, verifier) : sign::verify_pdf(*bytes, verifier);
  // The register may state that the file was issued with an earlier signer.
  if (verdict_of(v) == Verdict::untrusted && !rows.no_answer.empty())
    return fail(no_verdict(rows, path.string()));
  if (is_xml) {
    if (!v.holds()) return v;
    v.checks.push_back(check_dcc({path.filename().string(), *bytes, {}, {}, {}}, nullptr));
    if (auto added = add_register_state(v, *bytes, rows); !added) return fail(added.error());
    return v;
  }
  // Plugins must not read unsigned bytes.
  if (!v.holds()) {
    for (const char* check : {"content.values", "content.printed"})
      v.checks.push_back({check, State::not_checked,
                          verdict_of(v) == Verdict::untrusted ? "the signer is not trusted"
                                                              : "the signature is not valid"});
    return v;
  }
  // `verify_pdf` has checked what was added later; the other checks are about the issued part.
  const std::string_view issued = std::string_view(*bytes).substr(0, v.issued);
  if (auto added = add_register_state(v, issued, rows); !added) return fail(added.error());
  check_documents(v, verifier);
  NONIO_TRY(const auto context, open());
  for (sign::Check& c : check_content(v, issued, *context)) v.checks.push_back(std::move(c));
  return v;
}

Verdict verdict_of(const sign::Verified& v) {
  const auto any = [&](const auto& matches) {
    return std::any_of(v.checks.begin(), v.checks.end(), [&](const sign::Check& c) {
      return c.state == State::fails && matches(std::string_view(c.id));
    });
  };
  const auto of_signer = [](std::string_view id) {
    return id.starts_with("certificate.") || id.starts_with("signer.");
  };
  const auto of_register = [](std::string_view id) { return id == "register.state"; };
  const auto of_words = [](std::string_view id) { return id == words_check; };
  if (any([](std::string_view id) { return id == file_check; })) return Verdict::no_file;
  if (any([](std::string_view id) { return id == certificate_check; }))
    return Verdict::no_certificate;
  if (any([&](std::string_view id) { return !of_signer(id) && !of_register(id) && !of_words(id); }))
    return Verdict::altered;
  if (any(of_signer)) return Verdict::untrusted;
  if (any(of_register)) return Verdict::not_in_force;
  if (any(of_words)) return Verdict::other_words;
  if (!v.holds()) {  // an essential check was not made: no trusted roots were given, or no register
    const bool no_register = std::any_of(v.checks.begin(), v.checks.end(), [&](const auto& c) {
      return of_register(c.id) && c.state == State::not_checked && c.essential;
    });
    return no_register ? Verdict::not_in_force : Verdict::untrusted;
  }
  return not_made(v).empty() ? Verdict::valid : Verdict::incomplete;
}

std::string id_of(Verdict verdict) {
  constexpr std::array ids{"valid",       "incomplete", "untrusted",      "not-in-force",
                           "other-words", "altered",    "no-certificate", "no-file"};
  return ids[static_cast<std::size_t>(verdict)];
}

std::string text_of(Verdict verdict) {
  constexpr std::array texts{"VALID",
                             "VALID, but not every check was made",
                             "SIGNER NOT TRUSTED BY YOU",
                             "NOT IN FORCE",
                             "OTHER WORDS THAN INSTALLED",
                             "ALTERED OR BROKEN",
                             "NOT A CERTIFICATE",
                             "NO SUCH FILE"};
  return texts[static_cast<std::size_t>(verdict)];
}

std::vector<std::string> not_made(const sign::Verified& v) {
  std::vector<std::string> ids;
  for (const sign::Check& c : v.checks)
    if (c.state == State::not_checked && c.id != "dcc") ids.push_back(c.id);  // no DCC is attached
  return ids;
}

}  // namespace nonio::certificates
