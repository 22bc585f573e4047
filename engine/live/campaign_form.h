// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "live/service.h"
#include "platform/storage/json_values.h"

/// Converts the form of a new campaign on the page into options of `nonio new campaign`.
namespace nonio::live {

/// A request with a file: one line of JSON, followed by the bytes of the file.
struct DroppedFile {
  storage::Json form;
  std::string name, bytes;
};
/// Parses the body of a request with a file. An error is the refusal: no valid form, an empty file,
/// or a file name that a campaign must not contain.
tl::expected<DroppedFile, Answer> dropped_file(const std::string& body);

/// Returns the options --column=... for the member `columns`, and --axis if the member `axis` is
/// the name of an axis.
tl::expected<std::vector<std::string>, Answer> file_options(const storage::Json& form);

/// Returns the form as options. An error is the refusal of a value that does not have the form its
/// key requires.
tl::expected<std::vector<std::string>, Answer> campaign_options(const storage::Json& form);

/// Makes an id from day, machine and axis of the form; it differs from the names of the site's own
/// folders.
std::string proposed_id(const storage::Json& form);

}  // namespace nonio::live
