// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "live/service.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

/// A request with a file: one line of JSON, then the bytes of the file.
struct DroppedFile {
  storage::Json form;
  std::string name, bytes;
};
/// An error is the rejection: invalid JSON, an empty file, or a file name that a campaign must not
/// contain.
tl::expected<DroppedFile, Answer> dropped_file(const std::string& body);

/// Returns --column=... for the member `columns`, and --axis if the member `axis` is valid.
tl::expected<std::vector<std::string>, Answer> file_options(const storage::Json& form);

/// Returns the options of `nonio new campaign`. An error is the rejection of an invalid value.
tl::expected<std::vector<std::string>, Answer> campaign_options(const storage::Json& form);

/// Returns an id from date, machine and axis, which differs from the names of folders of the site.
std::string proposed_id(const storage::Json& form);

}  // namespace nonio::live
