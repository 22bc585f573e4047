// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::loader {
class Plugins;
}

namespace nonio::schema {

/// JSON schema (draft-07) of campaign.toml, site.toml, a machine's record, events.toml,
/// acknowledged.toml and forgotten.toml, for editors:
/// from the same declarations that the files are checked with, and what the loaded plugins are
/// called and take as options. It cannot say everything: what stands in several keys at once (a
/// measurement's axis among those of the machine), that a date has no quotes, and that 3.0 is no
/// whole number.
std::string campaign_schema(const loader::Plugins& plugins);
std::string site_schema(const loader::Plugins& plugins);
std::string machine_schema(const loader::Plugins& plugins);
std::string events_schema(const loader::Plugins& plugins);
std::string acknowledged_schema(const loader::Plugins& plugins);
std::string forgotten_schema(const loader::Plugins& plugins);

/// What a key of one of these files means, with its unit: "measurement.dwell_s",
/// "environment.warm_up". Of a key that does not exist: empty.
std::string campaign_key_help(std::string_view path);
std::string site_key_help(std::string_view path);
std::string machine_key_help(std::string_view path);

}  // namespace nonio::schema
