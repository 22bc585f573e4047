// SPDX-License-Identifier: Apache-2.0
//
// The model of each part of the machine as a page for a browser, in one file that needs nothing
// else. What it says is in templates/words/<language>/pictures.toml.
#include "nonio/sdk/plugin.h"

#include <algorithm>

#include "page.h"

namespace nonio::model_html {
namespace {

bool applies(const Campaign& campaign) { return !campaign.model.empty(); }

/// The part's name as a plain file name.
std::string file_name(const std::string& part) {
  std::string name = "model-" + part + ".html";
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_';
    if (!plain) c = '_';
  }
  return name;
}

Expected<OutputResult> write(const OutputInput& in) {
  const reports::Wording words(in.templates, in.options.text("language", "en"), {"pictures"});
  OutputResult result;
  for (const ModelFit& fit : in.results.models) {
    auto bytes = page_of({in, fit, words, reports::picture_words(fit, words)});
    if (!bytes) return fail(bytes.error());
    result.artifacts.push_back({file_name(fit.part), std::move(*bytes)});
  }
  if (const auto complete = words.complete(); !complete) return fail(complete.error());
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.role = Output::Role::model_page;
  output.info = {
      "model-html",
      "1.0.0",
      "The error model as an interactive page for a browser, in one file.",
      {{"language", std::string("en"), "", "Language of the page.", {"de", "en", "it"}}}};
  output.applies = applies;
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::model_html
