// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "campaign/config/keys.h"
#include "campaign/loader/plugins.h"
#include "campaign/schema/schema.h"
#include "certificates/users.h"
#include "platform/storage/files.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

using File = const config::Key& (*)();

/// A null `file` selects campaign.toml, whose schema depends on the plugins.
int write_schema(File file, const std::string& out, const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  if (!plugins.conflicts().empty()) return complain(plugins.conflicts().front());
  for (const std::string& note : plugins.refusal_notes())
    complain("its names and options are not in the schema: " + note);
  const std::string text =
      file == nullptr ? schema::campaign_schema(plugins) : schema::file_schema(file(), plugins);
  if (out.empty()) {
    std::cout << text;
    return exit_done;
  }
  const fs::path path = fs::absolute(out);
  if (!path.has_filename() || fs::is_directory(path))
    return complain(out + " is a folder; expected a file");
  const auto written = storage::publish(path.parent_path(), {{path.filename().string(), text}});
  return written ? exit_done : complain(text_of(written.error()), exit_failed);
}

Verb schema_of(const std::string& file, File declaration, Common& common) {
  auto out = std::make_shared<std::string>();
  return {
      .name = file,
      .summary = "JSON schema of " + file + ".toml",
      .arguments = joined({takes(Argument::Takes::file,
                                 {"--out", out.get(), "File for the schema (default: stdout)"})},
                          common_arguments(common)),
      .footer = "An editor finds the schema by the first line of " + file +
                ".toml, with the path from there:\n\n    #:schema ../" + file + ".schema.json",
      .examples = {"nonio schema " + file + " --out site/" + file + ".schema.json"},
      .run = [=, &common] { return write_schema(declaration, *out, common); }};
}

}  // namespace

Verb schema_verb(Common& common) {
  return {.name = "schema",
          .summary = "Writes JSON schemas, so that editors complete and check the files of a site",
          .verbs = {schema_of("campaign", nullptr, common),
                    schema_of("site", config::site_file, common),
                    schema_of("machine", config::machine_file, common),
                    schema_of("events", config::events_file, common),
                    schema_of("acknowledged", config::acknowledged_file, common),
                    schema_of("forgotten", config::forgotten_file, common),
                    schema_of("users", certificates::users_file, common)}};
}

}  // namespace nonio::app
