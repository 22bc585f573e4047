// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/reading/context.h"

namespace nonio::reading {

inline constexpr const char* model_fit_name = "model-fit";

/// Returns an error for each `[options.x]` whose x is not a plugin.
std::vector<Error> ownerless_options(const config::RawOptions& options,
                                     const loader::Plugins& plugins);

std::vector<Error> site_mistakes(const Context& context);

/// Sets file and line of an error about an option of `plugin` or a key of the manifest or
/// site.toml.
void locate(Error& error, const config::KeyLines& manifest, const config::KeyLines& site,
            const std::string& plugin = {});

/// Sets a missing line: in the manifest, the line of the nearest existing key above the faulty key,
/// otherwise of the first existing key of `others`; otherwise, and in other files, line 1.
void give_line(Error& error, const config::KeyLines& manifest,
               const std::vector<std::string>& others);

}  // namespace nonio::reading
