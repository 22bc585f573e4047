// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/site_walk.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <optional>

#include "campaign/config/manifest.h"
#include "platform/process/watched.h"
#include "platform/storage/files.h"
#include "platform/storage/serialise.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

enum class Seen : std::uint64_t { campaign, unlisted, note, all };

constexpr std::size_t most_remarks = 100;
/// Number of folders without a response at which the site itself is regarded as not responding.
constexpr std::size_t most_hung = 64;
/// Number of folders without a response after which the waiting time is one second.
constexpr std::size_t patient_for = 8;

// Paths without a response, with the message for each.
using Passed = std::map<std::string, std::string>;

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// Whether the file was probably meant as a manifest, such as `Campaign.toml` or
/// `campaign.toml.txt`.
bool is_nearly_manifest(const std::string& name) {
  const std::string word = lower(name), wanted = config::manifest_name;
  return word == wanted || word.starts_with(wanted + ".");
}

struct FolderNames {
  std::deque<std::string> folders;  // a deque, because there may be millions of folders
  std::vector<std::string> links, nearly;
  bool has_manifest = false;
};

class Walker {
 public:
  Walker(fs::path root, const fs::path& out, const Passed& passed, process::SignsOfLife& signs,
         const process::Watched::Send& send)
      : root_(std::move(root)), passed_(passed), signs_(signs), send_(send) {
    struct stat info {};
    if (::stat(out.c_str(), &info) == 0) out_ = std::pair(info.st_dev, info.st_ino);
  }

  void run() {
    std::deque<std::string> todo{"."};
    while (!todo.empty()) {
      const std::string folder = todo.back();
      todo.pop_back();
      if (!may(folder)) continue;
      FolderNames names = list(folder);
      for (; !names.folders.empty(); names.folders.pop_front())
        todo.push_back(folder == "." ? names.folders.front()
                                     : below(folder, names.folders.front()));
      tell(folder, names);
    }
    if (remarks_ > most_remarks)
      tell(Seen::note, "and " + std::to_string(remarks_ - most_remarks) + " more such remarks");
    tell(Seen::all);
  }

 private:
  static std::string below(const std::string& folder, const std::string& name) {
    return folder == "." ? name : folder + "/" + name;
  }
  fs::path path_of(const std::string& folder) const {
    return folder == "." ? root_ : root_ / folder;
  }

  void tell(Seen what, std::string_view folder = {}, std::string_view why = {}) {
    send_(storage::pack(what, folder, why));
  }
  void unlisted(const std::string& folder, int code) {
    tell(Seen::unlisted, folder,
         code == ENOENT ? "it went away while the site was listed" : std::strerror(code));
  }
  void remark(const std::string& text) {
    if (++remarks_ <= most_remarks) tell(Seen::note, text);
  }

  /// Returns false, after reporting the reason, if an earlier attempt hung or crashed at this path.
  bool may(const std::string& place) {
    signs_.reading(place);
    const auto hung = passed_.find(place);
    if (hung == passed_.end()) return true;
    tell(Seen::unlisted, place, hung->second);
    return false;
  }

  /// Returns no names for the output folder and, after a report, for a folder that cannot be read.
  /// No descriptor remains open.
  FolderNames list(const std::string& folder) {
    FolderNames names;
    const int fd = ::open(path_of(folder).c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR* open = fd < 0 ? nullptr : ::fdopendir(fd);
    if (open == nullptr) {
      unlisted(folder, errno);
      if (fd >= 0) ::close(fd);
      return names;
    }
    struct stat info {};
    if (::fstat(fd, &info) != 0)
      unlisted(folder, errno);
    else if (!out_ || std::pair(info.st_dev, info.st_ino) != *out_)
      read_names(open, folder, names);
    ::closedir(open);
    return names;
  }

  void read_names(DIR* open, const std::string& folder, FolderNames& names) {
    for (;;) {
      errno = 0;
      const dirent* entry = ::readdir(open);
      if (entry == nullptr) break;
      signs_.beat();
      const std::string name = entry->d_name;
      if (name == "." || name == "..") continue;
      sort_in(name, kind_of(::dirfd(open), *entry, below(folder, name)), names);
    }
    if (errno != 0) unlisted(folder, errno);
  }

  unsigned char kind_of(int folder, const dirent& entry, const std::string& place) {
    if (entry.d_type != DT_UNKNOWN) return entry.d_type;
    struct stat info {};
    if (::fstatat(folder, entry.d_name, &info, AT_SYMLINK_NOFOLLOW) != 0) {
      unlisted(place, errno);
      return DT_UNKNOWN;
    }
    return S_ISDIR(info.st_mode) ? DT_DIR : S_ISLNK(info.st_mode) ? DT_LNK : DT_REG;
  }

  static void sort_in(const std::string& name, unsigned char kind, FolderNames& names) {
    if (kind == DT_DIR) {
      if (!name.starts_with('.')) names.folders.emplace_back(name);
      if (is_nearly_manifest(name)) names.nearly.push_back(name);
    } else if (name == config::manifest_name) {
      names.has_manifest = true;
    } else if (is_nearly_manifest(name)) {
      names.nearly.push_back(name);
    } else if (kind == DT_LNK && !name.starts_with('.')) {
      names.links.push_back(name);
    }
  }

  void tell(const std::string& folder, const FolderNames& names) {
    if (names.has_manifest) tell(Seen::campaign, folder);
    for (const std::string& name : names.links)
      if (const std::string link = below(folder, name); link != "templates" && may(link))
        look_at_link(link, names.has_manifest);
    if (names.has_manifest) return;
    for (const std::string& name : names.nearly)
      remark(storage::path_text(below(folder, name)) + " is not read: expected a file called " +
             config::manifest_name);
  }

  /// Notes links that are broken or lead to a folder. In the folder of a campaign, only links to
  /// campaigns are noted.
  void look_at_link(const std::string& link, bool in_campaign) {
    struct stat info {};
    if (::stat(path_of(link).c_str(), &info) != 0) {
      if (!in_campaign)
        remark("the link " + storage::path_text(link) + " leads nowhere: " + std::strerror(errno));
      return;
    }
    if (!S_ISDIR(info.st_mode)) return;
    const std::string tail =
        " is a link and is not followed: a campaign must be stored in the site itself";
    if (::stat((path_of(link) / config::manifest_name).c_str(), &info) == 0)
      remark("the campaign " + storage::path_text(link) + tail);
    else if (!in_campaign)
      remark("the folder " + storage::path_text(link) + tail);
  }

  fs::path root_;
  std::optional<std::pair<dev_t, ino_t>> out_;
  const Passed& passed_;
  process::SignsOfLife& signs_;
  const process::Watched::Send& send_;
  std::size_t remarks_ = 0;
};

bool take_over(const std::vector<std::string>& pieces, SiteWalk& walk) {
  for (const std::string& piece : pieces) {
    Seen what{};
    std::string folder, why;
    if (!storage::unpack(piece, what, folder, why)) continue;
    switch (what) {
      case Seen::campaign:
        walk.campaigns.emplace_back(folder);
        break;
      case Seen::unlisted:
        walk.unlisted.push_back({std::move(folder), std::move(why)});
        break;
      case Seen::note:
        walk.notes.push_back(std::move(folder));
        break;
      case Seen::all:
        return true;
    }
  }
  return false;
}

/// Returns std::nullopt if the child process ended or did not respond, and adds the path to
/// `passed`, so that the next attempt skips this path. If `stopped` returns true, the result is
/// incomplete.
Expected<std::optional<SiteWalk>> try_walk(const fs::path& site, const fs::path& out,
                                           double seconds, bool (*stopped)(), Passed& passed) {
  auto child =
      process::Watched::start([&](process::SignsOfLife& signs, const process::Watched::Send& send) {
        std::error_code error;
        signs.reading(".");
        const fs::path root = fs::canonical(site, error);
        Walker(error ? site : root, out, passed, signs, send).run();
      });
  if (!child) return fail(child.error());
  std::vector<process::Watched> children;
  children.push_back(std::move(*child));
  process::Watched& walker = children.front();
  SiteWalk walk;
  while (!stopped()) {
    process::wait_for_any(children);
    if (take_over(walker.take(), walk)) return walk;
    const std::string place = walker.signs().reads_from();
    if (walker.ended())
      passed[place] = "the process that lists it ended: " + walker.end().words;
    else if (walker.is_silent(seconds))
      passed[place] = process::no_answer(seconds);
    else
      continue;
    return std::optional<SiteWalk>();
  }
  return walk;
}

}  // namespace

Expected<SiteWalk> walk_site(const fs::path& site, const fs::path& out, double seconds,
                             bool (*stopped)()) {
  Passed passed;
  while (passed.size() < most_hung) {
    const double patience = passed.size() < patient_for ? seconds : std::min(seconds, 1.0);
    NONIO_TRY(auto walk, try_walk(site, out, patience, stopped, passed));
    if (!walk) continue;
    const auto root = std::find_if(walk->unlisted.begin(), walk->unlisted.end(),
                                   [](const auto& u) { return u.folder == "."; });
    if (root != walk->unlisted.end())
      return fail("cannot read the site " + site.string() + ": " + root->why);
    std::sort(walk->campaigns.begin(), walk->campaigns.end());
    std::sort(walk->unlisted.begin(), walk->unlisted.end(),
              [](const auto& a, const auto& b) { return a.folder < b.folder; });
    const auto same =
        std::unique(walk->unlisted.begin(), walk->unlisted.end(),
                    [](const auto& a, const auto& b) { return a.folder == b.folder; });
    walk->unlisted.erase(same, walk->unlisted.end());
    return std::move(*walk);
  }
  return fail("cannot read the site " + site.string() + ": " + std::to_string(most_hung) +
              " of its folders give no answer");
}

}  // namespace nonio::batch
