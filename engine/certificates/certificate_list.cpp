// SPDX-License-Identifier: Apache-2.0
#include "certificates/certificate_list.h"

#include <algorithm>

#include "campaign/config/site_files.h"
#include "certificates/register_place.h"
#include "certificates/users.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

Expected<config::Numbering> numbering_of(const fs::path& site) {
  std::string digest;
  auto read = config::read_site(site, digest);
  if (!read) return fail(read.error().front());
  return std::move(read->numbering);
}

Expected<std::set<std::string>> waiting_campaigns(const fs::path& site) {
  NONIO_TRY(const auto numbering, numbering_of(site));
  NONIO_TRY(const auto drafts, Register::drafts(site, numbering));
  std::set<std::string> campaigns;
  for (const WaitingDraft& draft : drafts) campaigns.insert(draft.campaign);
  return campaigns;
}

Expected<std::set<std::string>> out_of_force(const fs::path& site) {
  NONIO_TRY(const auto numbering, numbering_of(site));
  NONIO_TRY(const auto entries, Register::entries(site, numbering));
  std::set<std::string> numbers;
  for (const RegisterEntry& e : entries)
    if (!e.in_force()) numbers.insert(e.number);
  return numbers;
}

Expected<void> not_out_of_force(const fs::path& site, const std::string& sha256) {
  NONIO_TRY(const auto numbering, numbering_of(site));
  NONIO_TRY(const auto entries, Register::entries(site, numbering));
  if (entries.empty()) return {};
  NONIO_TRY(auto opened, Register::open_to_read(site, numbering));
  NONIO_TRY(const auto issued, opened.issued_digests());
  const auto found = issued.find(sha256);
  if (found == issued.end()) return {};
  for (const RegisterEntry& e : entries)
    if (e.number == found->second && !e.in_force())
      return fail("certificate " + e.number + " is not in force" +
                  (e.replaced_by.empty() ? "" : "; it was replaced by " + e.replaced_by) +
                  (e.reason.empty() ? "" : ": " + e.reason) + "; it is not sent");
  return {};
}

Expected<std::vector<RegisterEntry>> certificates_of(const fs::path& site,
                                                     const config::Numbering& numbering) {
  auto entries = Register::entries(site, numbering);
  if (!entries || entries->empty()) return entries;
  NONIO_TRY(auto opened, Register::open(site, numbering));
  if (auto noted = opened.note_persons(*entries); !noted) return fail(noted.error());
  return entries;
}

Expected<void> withdraw(const fs::path& site, const config::Numbering& numbering,
                        const std::string& number, const std::string& why, const std::string& by) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  if (!by.empty())
    if (const std::string mistake = mistake_in_name(by); !mistake.empty()) return fail(mistake);
  if (!has_content(why)) return fail("the reason is empty; expected why it is withdrawn");
  if (std::any_of(why.begin(), why.end(), control))
    return fail("the reason has a control character; expected one line of text");
  NONIO_TRY(const auto entries, Register::entries(site, numbering));
  if (entries.empty())
    return fail("the register has no number " + number +
                " (`nonio certificate list SITE` lists the numbers)");
  NONIO_TRY(auto opened, Register::open(site, numbering));
  return opened.withdraw(number, why, by);
}

Expected<Audit> audit(const fs::path& site, const config::Numbering& numbering) {
  NONIO_TRY(const auto place, register_place(site, numbering));
  NONIO_TRY(const auto there, has_register(place, storage::Database::usual_patience));
  if (!there)
    return fail("there is no register " + place.name + ": nothing was issued or drafted yet");
  NONIO_TRY(auto opened, Register::open_to_audit(site, numbering));
  return opened.audit();
}

namespace {

std::string export_name(const std::string& number, const evaluation::IssuedFile& file,
                        const std::string& own) {
  if (file.output == own && file.name.ends_with(".pdf")) return number + ".pdf";
  if (file.output == own && file.name.ends_with(".xml")) return number + "-dcc.xml";
  return number + "-" + file.output + "-" + file.name;
}

}  // namespace

Expected<void> export_certificates(const fs::path& site, const config::Numbering& numbering,
                                   const fs::path& folder) {
  NONIO_TRY(const auto entries, Register::entries(site, numbering));
  if (entries.empty()) return {};
  NONIO_TRY(auto opened, Register::open(site, numbering));
  for (const RegisterEntry& e : entries) {
    if (e.order == 0) continue;
    NONIO_TRY(const auto files, opened.files(e.number));
    std::vector<Artifact> out;
    for (const evaluation::IssuedFile& f : files)
      out.push_back({export_name(e.number, f, files.front().output), f.bytes});
    if (auto written = storage::publish(folder, out); !written) return written;
  }
  return {};
}

}  // namespace nonio::certificates
