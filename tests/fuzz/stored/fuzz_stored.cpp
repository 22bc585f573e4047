// SPDX-License-Identifier: Apache-2.0
// Any bytes as a file that Nonio has stored: an archive of `nonio backup`, a pack, run.json or results.json. The reader
// is the one whose corpus is given.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>

#include "campaign/evaluation/record.h"
#include "laboratory/assessment/targets.h"
#include "laboratory/store/entry.h"
#include "platform/storage/backup.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"
#include "platform/storage/tar.h"

namespace {

using namespace nonio;
namespace fs = std::filesystem;

void must(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << std::endl;
  std::abort();
}

const fs::path& scratch() {
  static const storage::ScratchFolder folder("fuzz",
                                             fs::is_directory("/dev/shm") ? "/dev/shm" : "");
  return folder.path();
}

fs::path written(const fs::path& name, std::string_view bytes) {
  const fs::path path = scratch() / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// Headers get the sum of their bytes, because nearly no other mutation would be read.
std::string with_sums(std::string_view bytes) {
  std::string out(bytes);
  for (std::size_t at = 0; at + 512 <= out.size(); at += 512) {
    if (out.compare(at + 257, 5, "ustar") != 0) continue;
    std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(at) + 148, 8, ' ');
    unsigned sum = 0;
    for (std::size_t i = at; i < at + 512; ++i) sum += static_cast<unsigned char>(out[i]);
    char text[8];
    std::snprintf(text, sizeof text, "%06o", sum);
    out.replace(at + 148, 7, text, 7);
  }
  return out;
}

void read_backup(std::string_view bytes) {
  const fs::path file = written("backup.tar", with_sums(bytes));
  std::uint64_t left = 0, all = 0;
  const auto read = storage::read_tar(file, {[&](const storage::TarEntry& entry) -> Expected<void> {
                                               must(left == 0, "a content is complete");
                                               left = entry.size;
                                               return {};
                                             },
                                             [&](std::string_view part) -> Expected<void> {
                                               must(part.size() <= left, "of the stated size");
                                               left -= part.size(), all += part.size();
                                               return {};
                                             }});
  must(!read || left == 0, "the last content is complete");
  must(all <= bytes.size(), "no content that is not in the file");
  const fs::path into = scratch() / "in" / "restored";
  const auto restored = storage::restore_backup(file, into);
  std::uint64_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(scratch() / "in")) {
    const std::string path = entry.path().string();
    must(restored && (entry.path() == into || path.starts_with(into.string() + "/")),
         "nothing is written elsewhere, and nothing of a damaged archive");
    if (entry.symlink_status().type() == fs::file_type::regular) ++files;
  }
  must(!restored || files == restored->files, "every file is restored");
  fs::remove_all(into);
}

void read_pack(std::string_view bytes) {
  storage::close_packs();
  const fs::path pack = written(fs::path(storage::packs_folder) / "p.sqlar", bytes);
  const bool sound = storage::check_pack(pack).has_value();
  for (const char* campaign : {"a", "b", "c"}) {
    const auto names = storage::names_packed({pack, campaign});
    must(names.has_value() || !sound, "a sound pack has names");
    if (!names) continue;
    must(!sound || std::is_sorted(names->begin(), names->end()), "sorted names");
    for (const std::string& name : *names) {
      const storage::PackAddress at{pack, std::string(campaign) + "/" + name};
      const auto read = storage::read_packed(at);
      const auto size = storage::size_packed(at);
      must(read.has_value() || !sound, "a sound pack is readable");
      if (!read || !*read) continue;
      must(size && *size && **size == (*read)->size(), "one size");
    }
  }
}

void read_record(std::string_view bytes) {
  const auto record_in = [](std::string_view text) {
    written("c/run.json", text);
    return evaluation::last_record(scratch() / "c");
  };
  const auto read = record_in(bytes);
  if (!read || !*read) return;
  const std::string text = evaluation::to_json((*read)->record);
  const auto again = record_in(text);
  must(again && *again && evaluation::to_json((*again)->record) == text,
       "what is read can be written and read");
}

void read_results(std::string_view bytes) {
  for (const char* id : {"a", "09-tolerances"}) {
    const auto entry = store::entry_of(bytes, {{"campaign.toml", std::string(64, '0')}}, id);
    if (!entry) {
      must(!entry.error().message.empty(), "an error has words");
      continue;
    }
    must(entry->campaign == id, "the results of this campaign");
    must(store::digest_of(*entry).size() == 64, "a digest");
    for (const store::ResultRow& row : entry->results) must(std::isfinite(row.value), "a number");
    std::vector<std::string> targets;
    for (const store::CovarianceRow& c : entry->covariance) {
      must(c.first + c.count <= entry->results.size(), "a covariance of results");
      targets.push_back(c.other_targets);
    }
    must(assessment::read_targets(targets).size() == targets.size(), "an answer for each");
    if (entry->certificate)
      for (const std::string& text :
           {entry->certificate->number, entry->certificate->day, entry->certificate->replaces})
        must(text.find('\0') == text.npos, "a text that a database can store");
  }
}

void (*chosen)(std::string_view) = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  const std::map<std::string, void (*)(std::string_view)> readers{{"backup", read_backup},
                                                                  {"pack", read_pack},
                                                                  {"record", read_record},
                                                                  {"results", read_results}};
  for (int i = 1; i < *count; ++i)
    if (const auto found = readers.find(fs::path((*arguments)[i]).filename().string());
        found != readers.end())
      chosen = found->second;
  must(chosen != nullptr, "an argument is the corpus of a reader");
  fs::create_directories(scratch() / "in");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen({reinterpret_cast<const char*>(data), size});
  return 0;
}
