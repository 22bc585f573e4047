// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "live/service.h"
#include "platform/storage/json_values.h"

/// The form of a new campaign: what a page may state, and the options of `nonio new campaign` that
/// state it.
namespace nonio::live {

/// A request with a file: one line of JSON, then the bytes of the file as they were dropped.
struct DroppedFile {
  storage::Json form;
  std::string name, bytes;
};
/// An error is the refusal: no form, or a name that no file of a campaign may have.
tl::expected<DroppedFile, Answer> dropped_file(const std::string& body);

/// --column=... of the form's member `columns`, and --axis of `axis`.
tl::expected<std::vector<std::string>, Answer> file_options(const storage::Json& form);

/// What the form states, as options; an error is the refusal of a value that has another form than
/// its key requires.
tl::expected<std::vector<std::string>, Answer> campaign_options(const storage::Json& form);

/// Day, machine and axis of the form as an id, which no folder of a site has for another purpose.
std::string proposed_id(const storage::Json& form);

}  // namespace nonio::live
