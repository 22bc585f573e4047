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

/// Return JSON schemas (draft-07) for editors. The schemas cannot express relations between keys,
/// that a date has no quotes, and that 3.0 is not an integer.
std::string campaign_schema(const loader::Plugins& plugins);
std::string file_schema(const config::Key& file, const loader::Plugins& plugins);

/// Returns meaning and unit of a key such as "measurement.dwell_s"; "" for unknown keys.
std::string campaign_key_help(std::string_view path);
std::string site_key_help(std::string_view path);

}  // namespace nonio::schema
