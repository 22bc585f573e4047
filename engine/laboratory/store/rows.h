// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/config/site_logs.h"
#include "laboratory/store/earlier.h"
#include "platform/storage/database.h"

namespace nonio::store {

/// The evaluation of a campaign that the next one supersedes.
struct Before {
  std::int64_t evaluation = 0;  ///< 0: there is none
  std::string campaign_sha256, version;
};

/// Appends one evaluation with all that belongs to it under this sequence number.
void insert(storage::Database& database, std::int64_t number, const Known& known,
            const Before& before);
void insert(storage::Database& database, const std::string& campaign,
            const std::vector<CertificateRow>& certificates);

/// What people say, as the site's files have it now, in place of what they had.
void replace_logs(storage::Database& database, const config::SiteLogs& logs,
                  const std::vector<config::Alias>& aliases,
                  const std::vector<config::Event>& of_records,
                  const std::vector<config::DueRule>& due);

}  // namespace nonio::store
