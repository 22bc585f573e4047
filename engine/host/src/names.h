// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/host/evaluate.h"

namespace nonio::host {

/// `[options.x]` for an x that no plugin is, which would otherwise be ignored in silence.
std::vector<Error> ownerless_options(const RawOptions& options, const Plugins& plugins);

/// Fills in file and line of an error that says by its key what is to blame: an option of
/// `plugin` or a key of the manifest or, where they do not have it, of site.toml.
void locate(Error& error, const KeyLines& manifest, const KeyLines& site,
            const std::string& plugin = {});

/// Gives an error of a file its line: of the manifest that of the nearest key above the one that is
/// to blame (machine.axes.X for machine.axes.X.slave) or of the first of `others` that is there,
/// else the first line, from which a file as a whole is wrong.
void give_line(Error& error, const KeyLines& manifest, const std::vector<std::string>& others);

}  // namespace nonio::host
