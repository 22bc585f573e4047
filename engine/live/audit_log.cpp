// SPDX-License-Identifier: Apache-2.0
#include "live/audit_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "certificates/journal.h"
#include "platform/process/channel.h"
#include "platform/storage/files.h"

namespace nonio::live {

Expected<void> AuditLog::write(storage::Json entry) {
  storage::Json line = {{"at", certificates::utc_now()}};
  line.update(entry);
  const std::string text = storage::dump_line(line) + "\n";
  const std::lock_guard lock(mutex_);
  const process::Handle file(
      ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640));
  if (!file || ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::fdatasync(file.get()) != 0)
    return fail(file_.string() + ": " + std::strerror(errno));
  return {};
}

Expected<std::string> AuditLog::text() const {
  NONIO_TRY(const auto there, storage::is_there(file_));
  return there ? storage::read_file(file_) : std::string();
}

}  // namespace nonio::live
