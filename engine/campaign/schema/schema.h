// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::config {
struct Key;
}
namespace nonio::loader {
class Plugins;
}

namespace nonio::schema {

/// Return JSON schemas (draft-07) for editors: of campaign.toml, and of another file by its
/// declaration. They are made from the declarations that check the files, and from names and options
/// of the loaded plugins. They cannot express relations between keys (the axis of a measurement must be one of the machine's), that a
/// date has no quotes, and that 3.0 is not an integer.
std::string campaign_schema(const loader::Plugins& plugins);
std::string file_schema(const config::Key& file, const loader::Plugins& plugins);

/// Returns the meaning and unit of a key of campaign.toml or site.toml, such as
/// "measurement.dwell_s"; empty if the key does not exist.
std::string campaign_key_help(std::string_view path);
std::string site_key_help(std::string_view path);

}  // namespace nonio::schema
