// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/config/manifest.h"
#include "nonio/sign/sign.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::certificates {

/// Controls the only process of a run that has the key. Workers send it finished bytes and receive
/// them signed. It is started before plugins are loaded, so that it contains none of their code. If
/// the key cannot be opened, each request is answered with the error.
class Signer {
 public:
  /// `disk_seconds`: time limit in s for a disk or share that does not answer.
  Signer(const config::Signing& signing, std::filesystem::path site, double disk_seconds);
  Signer(const Signer&) = delete;
  Signer& operator=(const Signer&) = delete;

  /// Returns the identity of the key, or an error if the key cannot be opened.
  Expected<sign::Identity> start();
  /// Starts the process again if it has died; requests made in the meantime are not lost.
  void revive();
  /// Must be called first in a worker, so that it cannot receive the requests of other workers.
  void leave_to_worker();
  Expected<sign::Signed> sign(const std::string& bytes) const;

 private:
  Expected<void> fork_process();
  void serve();

  const config::Signing& signing_;
  const std::filesystem::path site_;
  const double disk_seconds_;
  std::string given_up_{};  ///< why the key is not opened again; otherwise empty
  int deaths_ = 0;
  process::Handle to_, from_;  ///< both ends of the channel for requests
  process::Child child_{};
};

}  // namespace nonio::certificates
