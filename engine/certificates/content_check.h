// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Evaluates the attachments of a signed PDF again with the installed plugins. Checks:
/// `content.values`, the readings give the attached results; `content.attachments`, all attachments
/// belong to the certificate; `content.templates`, its templates are those that results.json names;
/// `content.words`, these are the installed ones; `content.printed`, the readings give exactly this
/// file, object by object.
std::vector<sign::Check> check_content(const sign::Verified& verified, std::string_view pdf,
                                       const reading::Context& context);

inline constexpr const char* words_check = "content.words";

/// Whether the attachment is a DCC: an XML file with media type application/xml.
bool is_document(const pdf::Attachment& attachment);
const pdf::Attachment* find_attachment(const sign::Verified& verified, std::string_view name);

}  // namespace nonio::certificates
