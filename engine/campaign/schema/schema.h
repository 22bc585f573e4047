// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::loader {
class Plugins;
}

namespace nonio::schema {

/// JSON schema (draft-07) of campaign.toml, site.toml, a machine's record,
/// events.toml, acknowledged.toml, forgotten.toml and users.toml, for editors: made from the
/// declarations that check the files, and from names and options of the loaded
/// plugins. It cannot express everything: relations between several keys (a
/// measurement's axis is one of the machine's), that a date has no quotes, and that
/// 3.0 is not an integer.
std::string campaign_schema(const loader::Plugins& plugins);
std::string site_schema(const loader::Plugins& plugins);
std::string machine_schema(const loader::Plugins& plugins);
std::string events_schema(const loader::Plugins& plugins);
std::string acknowledged_schema(const loader::Plugins& plugins);
std::string forgotten_schema(const loader::Plugins& plugins);
std::string users_schema(const loader::Plugins& plugins);

/// What a key of one of these files means, with its unit: "measurement.dwell_s",
/// "environment.warm_up". Of a key that does not exist: empty.
std::string campaign_key_help(std::string_view path);
std::string site_key_help(std::string_view path);

}  // namespace nonio::schema
