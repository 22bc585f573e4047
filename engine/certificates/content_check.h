// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Evaluates the attachments of a signed PDF again with the installed plugins. Checks:
/// `content.values`, whether the readings give the attached results; `content.attachments`, whether
/// all attachments belong to the certificate; `content.templates`, whether its templates are those
/// that results.json names; `content.words`, whether these are the installed ones;
/// `content.printed`, whether the readings give exactly this file, object by object, when it is
/// made again as in the run.
std::vector<sign::Check> check_content(const sign::Verified& verified, std::string_view pdf,
                                       const reading::Context& context);

inline constexpr const char* words_check = "content.words";

/// Whether an attachment is a DCC, according to its name (*.xml) and its media type.
bool is_document(const pdf::Attachment& attachment);
const pdf::Attachment* find_attachment(const sign::Verified& verified, std::string_view name);

}  // namespace nonio::certificates
