// SPDX-License-Identifier: Apache-2.0
// Something that is issued under a number, as small as it can be: a PDF of one page that prints the
// number and a result. It lacks the customer if the campaign has none.
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

std::string pdf_of(const std::string& text) {
  const std::string page = "BT /F1 12 Tf 50 800 Td (" + text + ") Tj ET";
  const std::array<std::string, 5> objects = {
      "<<\n/Type /Catalog\n/Pages 2 0 R\n>>", "<<\n/Type /Pages\n/Kids [ 4 0 R ]\n/Count 1\n>>",
      "<<\n/Title (Numbered)\n>>",
      "<<\n/Type /Page\n/Parent 2 0 R\n/MediaBox [ 0 0 595.28 841.89 ]\n/Contents 5 0 R\n"
      "/Resources << /Font << /F1 << /Type /Font /Subtype /Type1 /BaseFont /Helvetica >> >> >>\n>>",
      "<<\n/Length " + std::to_string(page.size()) + "\n>>\nstream\r\n" + page + "\nendstream"};
  std::string out = "%PDF-1.7\n%\xB7\xBE\xAD\xAA\n", table = "0000000000 65535 f\r\n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::array<char, 32> entry{};
    std::snprintf(entry.data(), entry.size(), "%010zu 00000 n\r\n", out.size());
    table += entry.data();
    out += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t at = out.size();
  return out + "xref\n0 6\n" + table +
         "trailer\n<<\n/Root 1 0 R\n/Info 3 0 R\n/Size 6\n>>\nstartxref\n" + std::to_string(at) +
         "\n%%EOF\n";
}

/// How it misbehaves, if at all, is no business of the campaign's data.
bool asked_to(const char* what) {
  const char* how = std::getenv("NONIO_TEST_NUMBERED");
  return how != nullptr && std::string(how) == what;
}

Expected<OutputResult> write(const OutputInput& in) {
  if (in.issue == nullptr) return fail("there is no number");
  if (asked_to("crash")) std::raise(SIGSEGV);
  if (asked_to("fail")) return fail("an error on purpose");
  const Issue& i = *in.issue;
  std::string text = i.is_draft() ? "DRAFT" : "number " + i.number + " of " + i.date;
  text += " replaces " + i.replaces + " of " + i.replaces_date + " by " + i.released_by +
          " author " + i.author + " why " + i.why + " changes";
  for (const FileChange& file : i.changes) {
    text += " " + file.file;
    for (const Change& c : file.changes)
      text += " [" + c.key + std::to_string(c.line) + ": " + c.before.value_or("-") + " > " +
              c.after.value_or("-") + "]";
  }
  text += " readings " + i.readings_sha256;
  for (const auto& a : in.results.analyses)
    if (!a.evaluation.values.empty())
      text += " value " + std::to_string(a.evaluation.values.front().value * 1e6);
  if (asked_to("lie")) text += " or so";
  OutputResult result;
  result.artifacts.push_back({"numbered.pdf", pdf_of(text), !asked_to("leave unsigned")});
  return result;
}

std::vector<std::string> lacks(const OutputInput& in) {
  std::vector<std::string> missing;
  if (in.campaign.customer.empty()) missing.emplace_back("campaign.customer");
  if (in.campaign.machine.serial.empty()) missing.emplace_back("machine.serial");
  if (asked_to("want more")) missing.emplace_back("what nobody has");
  return missing;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"numbered", "1", "Issued under a number", {}, true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  output.certificate = {.missing_requirements = lacks};
  registry.add(output);
  output.info.name = "numbered-too";
  registry.add(std::move(output));
}
