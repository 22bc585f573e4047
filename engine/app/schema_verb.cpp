// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "campaign/loader/plugins.h"
#include "campaign/schema/schema.h"
#include "platform/storage/files.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

using Schema = std::string (*)(const loader::Plugins&);

int write_schema(Schema schema, const std::string& out, const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  if (!plugins.conflicts().empty()) return complain(plugins.conflicts().front());
  for (const std::string& note : plugins.refusal_notes())
    complain("its names and options are not in the schema: " + note);
  const std::string text = schema(plugins);
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

Verb schema_of(const std::string& file, Schema schema, Common& common) {
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
      .run = [=, &common] { return write_schema(schema, *out, common); }};
}

}  // namespace

Verb schema_verb(Common& common) {
  return {.name = "schema",
          .summary = "Writes JSON schemas, so that editors complete and check the files of a site",
          .verbs = {schema_of("campaign", schema::campaign_schema, common),
                    schema_of("site", schema::site_schema, common),
                    schema_of("machine", schema::machine_schema, common),
                    schema_of("events", schema::events_schema, common),
                    schema_of("acknowledged", schema::acknowledged_schema, common),
                    schema_of("forgotten", schema::forgotten_schema, common),
                    schema_of("users", schema::users_schema, common)}};
}

}  // namespace nonio::app
