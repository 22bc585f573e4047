// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sign/sign.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::certificates {

/// The only process of a run that has the key. Workers send it finished bytes and get them back
/// signed. It is made before plugins are loaded, so that nothing of theirs is in it, and opens the
/// key once; if that does not succeed, each request is answered with the error.
class Signer {
 public:
  /// A disk or share without an answer for `disk_seconds` is none.
  Signer(const config::Signing& signing, std::filesystem::path site, double disk_seconds);
  Signer(const Signer&) = delete;
  Signer& operator=(const Signer&) = delete;

  /// Starts the process; whose key it has, or why it has none.
  Expected<sign::Identity> start();
  /// Starts it again if it has died; requests in the meantime are not lost.
  void revive();
  /// To be called first in a worker: it cannot listen to others.
  void leave_to_worker();
  Expected<sign::Signed> sign(const std::string& bytes) const;

 private:
  Expected<void> fork_process();
  void serve();

  const config::Signing& signing_;
  const std::filesystem::path site_;
  const double disk_seconds_;
  std::string given_up_{};  ///< why signing has ended
  int deaths_ = 0;
  process::Handle to_, from_;  ///< the two ends of the channel on which requests come
  process::Child child_{};
};

}  // namespace nonio::certificates
