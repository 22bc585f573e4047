// SPDX-License-Identifier: Apache-2.0
#include "archive.h"

#include <Poco/Exception.h>
#include <Poco/MemoryStream.h>
#include <Poco/Zip/ZipArchive.h>
#include <Poco/Zip/ZipStream.h>

#include <algorithm>
#include <cstdint>

namespace nonio::spreadsheet {

namespace {

/// Whether a Zip64 record at the end of the archive states that it is longer than the archive. Poco
/// would allocate this length.
bool has_impossible_end(std::string_view archive) {
  constexpr std::string_view signature("PK\6\6", 4);
  constexpr std::size_t most_at_end = 70000;  // a comment of 65,535 bytes and the records
  const std::size_t from = archive.size() - std::min(archive.size(), most_at_end);
  for (std::size_t at = archive.find(signature, from); at != std::string_view::npos;
       at = archive.find(signature, at + 1)) {
    std::uint64_t length = 0;
    for (std::size_t k = 12; k-- > 4;)
      length = length << 8 |
               (at + k < archive.size() ? static_cast<unsigned char>(archive[at + k]) : 0xffU);
    if (length > archive.size()) return true;
  }
  return false;
}

}  // namespace

Expected<std::optional<std::string>> member(std::string_view archive, const std::string& name) {
  if (has_impossible_end(archive))
    return fail("the file is no spreadsheet that can be opened (its end is damaged)");
  try {
    Poco::MemoryInputStream all(archive.data(), static_cast<std::streamsize>(archive.size()));
    const Poco::Zip::ZipArchive zip(all);
    std::size_t members = 0;
    for (auto it = zip.headerBegin(); it != zip.headerEnd(); ++it)
      if (++members > most_members) return fail("expected up to 10,000 files in the spreadsheet");
    const auto found = zip.findHeader(name);
    if (found == zip.headerEnd()) return std::nullopt;
    if (found->second.isEncrypted())
      return fail("the spreadsheet is encrypted; save it without a password");
    Poco::MemoryInputStream again(archive.data(), static_cast<std::streamsize>(archive.size()));
    Poco::Zip::ZipInputStream in(again, found->second);
    std::string out;
    char buffer[65536];
    while (in.read(buffer, sizeof buffer) || in.gcount() > 0) {
      out.append(buffer, static_cast<std::size_t>(in.gcount()));
      if (out.size() > most_bytes) return fail(name + " unpacks to more than 256 MB");
    }
    if (!in.crcValid()) return fail(name + " is damaged: its check sum is another one");
    return out;
  } catch (const Poco::Exception& e) {
    return fail("the file is no spreadsheet that can be opened (" + e.displayText() + ")");
  } catch (const std::exception& e) {
    return fail("the file is no spreadsheet that can be opened (" + std::string(e.what()) + ")");
  }
}

}  // namespace nonio::spreadsheet
