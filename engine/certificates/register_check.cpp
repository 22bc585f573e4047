// SPDX-License-Identifier: Apache-2.0
#include "certificates/register_check.h"

#include <algorithm>

#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "certificates/certificate_list.h"
#include "certificates/content_check.h"
#include "certificates/register_place.h"
#include "platform/storage/digest.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

using State = sign::Check::State;

struct StatedNumber {
  std::string number, register_id;
  bool by_register = true;  ///< false if the number may come from another source
};

/// Returns an empty number if the DCC has no identifier. Only the output `certificate` takes it
/// from a register.
StatedNumber stated_in_dcc(std::string_view xml) {
  constexpr std::string_view open = "<dcc:uniqueIdentifier>", close = "</dcc:uniqueIdentifier>";
  const std::size_t begin = xml.find(open);
  const std::size_t end = xml.find(close);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return {};
  constexpr std::string_view numbered = ">Nonio certificate<";
  return {std::string(xml.substr(begin + open.size(), end - begin - open.size())),
          {},
          xml.find(numbered) != std::string_view::npos};
}

StatedNumber stated_in_pdf(const sign::Verified& v) {
  const pdf::Attachment* results = find_attachment(v, evaluation::results_name);
  if (results == nullptr) return {};
  const storage::Json json = storage::parse_once(results->bytes);
  if (!json.is_object() || !json.contains("certificate")) return {};
  const Issue issue = evaluation::certificate_of(json["certificate"]).issue;
  return {issue.number, issue.register_id, true};
}

std::string words_of(const RegisterEntry& e) {
  if (e.state == "withdrawn")
    return e.number + " was withdrawn: " + e.reason +
           (e.replaced_by.empty() ? "" : "; " + e.replaced_by + " replaces it");
  if (e.state == "amended") return e.number + " was replaced by " + e.replaced_by;
  if (e.state == "drawn") return e.number + " was drawn and never issued";
  return e.number + " of " + e.date + " is in force, and this is the file that was issued";
}

}  // namespace

std::string no_verdict(const RegisterRows& rows, const std::string& what) {
  return "no verdict on " + what + ", because the register cannot be read: " + rows.no_answer;
}

RegisterRows register_rows(const fs::path& site) {
  RegisterRows rows;
  if (site.empty()) return rows;
  rows.asked = true;
  const auto read = [&]() -> Expected<void> {
    NONIO_TRY(const auto numbering, numbering_of(site));
    NONIO_TRY(const auto place, register_place(site, numbering));
    NONIO_TRY(const auto there, has_register(place, storage::Database::usual_patience));
    rows.exists = there;
    if (!rows.exists) return {};
    NONIO_TRY(auto opened, Register::open_to_read(site, numbering));
    NONIO_TRY(auto entries, opened.all());
    NONIO_TRY(auto issued, opened.issued_digests());
    rows.entries = std::move(entries);
    rows.issued = std::move(issued);
    rows.id = opened.id();
    return {};
  };
  if (const auto done = read(); !done) rows.no_answer = done.error().message;
  return rows;
}

std::string issued_by(const RegisterRows& rows, std::string_view bytes) {
  if (rows.issued.empty()) return {};
  const auto found = rows.issued.find(storage::sha256(sign::issued_part(bytes)));
  return found == rows.issued.end()
             ? ""
             : "the register " + rows.id + " issued this file as " + found->second;
}

Expected<std::optional<sign::Check>> check_register(const sign::Verified& verified,
                                                    std::string_view bytes,
                                                    const RegisterRows& rows) {
  StatedNumber stated = bytes.starts_with("%PDF-") ? stated_in_pdf(verified) : stated_in_dcc(bytes);
  if (stated.number.empty()) return std::nullopt;
  sign::Check check{"register.state", State::fails, {}};
  const auto says = [&](State state, std::string words) {
    check.state = state;
    check.says = std::move(words);
    return check;
  };
  if (!rows.asked) {
    check.essential = false;
    return says(State::not_checked,
                "whether " + stated.number +
                    " was withdrawn or replaced: requires the register of its site (--site)");
  }
  if (!rows.no_answer.empty()) return fail(no_verdict(rows, stated.number));
  if (!rows.exists) {
    check.essential = stated.by_register;
    return says(State::not_checked, "the site has no register that states this " + stated.number);
  }
  const auto issued = rows.issued.find(storage::sha256(bytes));
  if (issued != rows.issued.end()) stated.number = issued->second;
  if (!stated.register_id.empty() && !rows.id.empty() && stated.register_id != rows.id)
    return says(State::fails, stated.number + " was issued by the register " + stated.register_id +
                                  "; that of this site is " + rows.id);
  const auto entry =
      std::find_if(rows.entries.begin(), rows.entries.end(),
                   [&](const RegisterEntry& e) { return e.number == stated.number; });
  if (entry == rows.entries.end()) {
    if (stated.by_register)
      return says(State::fails, "the register of this site never issued " + stated.number +
                                    ": was the site copied, or the register replaced?");
    check.essential = false;
    return says(State::not_checked, stated.number + " is not a number of this site's register");
  }
  if (issued == rows.issued.end())
    return says(State::fails, "the register of this site has issued another certificate as " +
                                  stated.number + ": was the site copied?");
  return says(entry->in_force() ? State::holds : State::fails, words_of(*entry));
}

}  // namespace nonio::certificates
