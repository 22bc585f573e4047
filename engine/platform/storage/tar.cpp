// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/tar.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>

namespace nonio::storage {

namespace {

constexpr std::size_t block = 512;
constexpr std::uint64_t most_octal = 077777777777;  // largest size in 11 octal digits
constexpr std::uint64_t most_pax = 1U << 20U, most_part = 1U << 20U;
using Block = std::array<char, block>;

struct TarField {
  std::size_t at, length;
};
constexpr TarField name_field{0, 100}, mode_field{100, 8}, owner_field{108, 8}, group_field{116, 8},
    size_field{124, 12}, time_field{136, 12}, sum_field{148, 8}, type_field{156, 1},
    target_field{157, 100}, magic_field{257, 8}, prefix_field{345, 155};

void put(Block& header, TarField field, std::string_view text) {
  std::copy_n(text.data(), std::min(text.size(), field.length), header.data() + field.at);
}

void put_octal(Block& header, TarField field, std::uint64_t value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%0*llo", static_cast<int>(field.length - 1),
                static_cast<unsigned long long>(value));
  put(header, field, text.data());
}

std::string_view text_in(const Block& header, TarField field) {
  const std::string_view text(header.data() + field.at, field.length);
  return text.substr(0, text.find('\0'));
}

Expected<std::uint64_t> octal_in(const Block& header, TarField field) {
  std::string_view text = text_in(header, field);
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  std::uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value, 8);
  if (!text.empty() && (read.ec != std::errc() || read.ptr != text.data() + text.size()))
    return fail("expected a number of octal digits in a header");
  return value;
}

/// The field of the checksum counts as blanks.
std::uint64_t sum_of(Block header) {
  std::fill_n(header.data() + sum_field.at, sum_field.length, ' ');
  std::uint64_t sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  return sum;
}

/// Returns a line such as "27 path=...\n"; the number is the length of the whole line.
std::string pax_line(const std::string& key, const std::string& value) {
  const std::string rest = " " + key + "=" + value + "\n";
  std::size_t length = rest.size() + 1;
  while (std::to_string(length).size() + rest.size() != length) ++length;
  return std::to_string(length) + rest;
}

Expected<std::map<std::string, std::string>> pax_in(std::string_view text) {
  std::map<std::string, std::string> values;
  while (!text.empty()) {
    std::size_t length = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), length);
    const auto blank = static_cast<std::size_t>(read.ptr - text.data());
    if (read.ec != std::errc() || length > text.size() || length < blank + 3 ||
        text[blank] != ' ' || text[length - 1] != '\n')
      return fail("expected lines of a pax header");
    const std::string_view line = text.substr(blank + 1, length - blank - 2);
    const std::size_t equals = line.find('=');
    if (equals == line.npos) return fail("expected lines of a pax header");
    values[std::string(line.substr(0, equals))] = line.substr(equals + 1);
    text.remove_prefix(length);
  }
  return values;
}

std::uint64_t padding_of(std::uint64_t size) { return (block - size % block) % block; }

}  // namespace

Expected<TarWriter> TarWriter::create(const std::filesystem::path& path) {
  ::unlink(path.c_str());  // The file may belong to another user, so it is not overwritten.
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return fail(Error{std::strerror(errno), path.string()});
  return TarWriter(fd, path.string());
}

TarWriter::TarWriter(TarWriter&& other) noexcept : fd_(other.fd_), name_(std::move(other.name_)) {
  other.fd_ = -1;
}

TarWriter::~TarWriter() {
  if (fd_ >= 0) ::close(fd_);
}

Expected<void> TarWriter::write(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return fail(Error{std::strerror(errno), name_});
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Expected<void> TarWriter::header(const TarEntry& entry, char type, const std::string& name) const {
  Block header{};
  put(header, name_field, name);
  put_octal(header, mode_field, entry.mode);
  put_octal(header, owner_field, 0);
  put_octal(header, group_field, 0);
  put_octal(header, size_field, std::min(entry.size, most_octal));
  put_octal(header, time_field,
            static_cast<std::uint64_t>(std::max<std::int64_t>(0, entry.changed)));
  put(header, type_field, std::string_view(&type, 1));
  put(header, target_field, entry.target);
  put(header, magic_field, std::string_view("ustar\00000", 8));
  std::array<char, 8> sum{};
  std::snprintf(sum.data(), sum.size(), "%06llo", static_cast<unsigned long long>(sum_of(header)));
  put(header, {sum_field.at, 7}, std::string_view(sum.data(), 7));
  header[sum_field.at + 7] = ' ';
  return write({header.data(), header.size()});
}

Expected<void> TarWriter::add(const TarEntry& entry, const Parts& bytes) {
  const std::string name = entry.name + (entry.kind == TarEntry::Kind::folder ? "/" : "");
  std::string pax;
  if (name.size() > name_field.length) pax += pax_line("path", name);
  if (entry.target.size() > target_field.length) pax += pax_line("linkpath", entry.target);
  if (entry.size > most_octal) pax += pax_line("size", std::to_string(entry.size));
  const auto padded = [&](std::uint64_t size) {
    return write(std::string(padding_of(size), '\0'));
  };
  if (!pax.empty()) {
    const TarEntry of_pax{.name = {}, .mode = 0644, .size = pax.size()};
    if (auto done = header(of_pax, 'x', "pax"); !done) return done;
    if (auto done = write(pax); !done) return done;
    if (auto done = padded(pax.size()); !done) return done;
  }
  if (auto done = header(entry, static_cast<char>(entry.kind), name); !done || !bytes) return done;
  std::uint64_t size = 0;
  Expected<void> written;
  auto read = bytes([&](std::string_view part) {
    size += part.size();
    if (written) written = write(part);
  });
  if (!read) return read;
  if (!written) return written;
  if (size != entry.size) return fail(Error{"the file has changed while it was read", entry.name});
  return padded(size);
}

std::int64_t TarWriter::position() const { return ::lseek(fd_, 0, SEEK_CUR); }

Expected<void> TarWriter::back_to(std::int64_t position) {
  if (::lseek(fd_, position, SEEK_SET) < 0 || ::ftruncate(fd_, position) != 0)
    return fail(Error{std::strerror(errno), name_});
  return {};
}

Expected<void> TarWriter::end() {
  if (auto done = write(std::string(2 * block, '\0')); !done) return done;
  if (::fsync(fd_) != 0) return fail(Error{std::strerror(errno), name_});
  return {};
}

Expected<void> read_tar(const std::filesystem::path& path, const TarReads& reads) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(Error{std::strerror(errno), path.string()});
  const auto wrong = [&](const std::string& why) {
    return fail(Error{"is no archive that can be read: " + why, path.string()});
  };
  const auto cut = [&] { return wrong("it is cut short"); };
  const auto skip = [&](std::uint64_t size) {
    Block rest{};
    return size == 0 || in.read(rest.data(), static_cast<std::streamsize>(size));
  };
  std::map<std::string, std::string> pax;
  std::string part;
  for (Block header{};;) {
    if (!in.read(header.data(), block)) return cut();
    if (std::all_of(header.begin(), header.end(), [](char c) { return c == '\0'; })) return {};
    const auto sum = octal_in(header, sum_field), mode = octal_in(header, mode_field),
               time = octal_in(header, time_field), size = octal_in(header, size_field);
    for (const auto* number : {&sum, &mode, &time, &size})
      if (!*number) return wrong(number->error().message);
    if (*sum != sum_of(header)) return wrong("the sum of a header is another one");
    const char type = header[type_field.at];
    if (type == 'x') {
      if (*size > most_pax) return wrong("a pax header is larger than 1 MB");
      std::string text(*size, '\0');
      if (!in.read(text.data(), static_cast<std::streamsize>(text.size())) ||
          !skip(padding_of(*size)))
        return cut();
      auto values = pax_in(text);
      if (!values) return wrong(values.error().message);
      pax = std::move(*values);
      continue;
    }
    TarEntry entry{.name = std::string(text_in(header, name_field)),
                   .mode = static_cast<unsigned>(*mode & 07777U),
                   .size = *size,
                   .changed = static_cast<std::int64_t>(*time),
                   .target = std::string(text_in(header, target_field))};
    if (const auto prefix = text_in(header, prefix_field); !prefix.empty())
      entry.name = std::string(prefix) + "/" + entry.name;
    if (pax.contains("path")) entry.name = pax["path"];
    if (pax.contains("linkpath")) entry.target = pax["linkpath"];
    if (pax.contains("size")) entry.size = std::strtoull(pax["size"].c_str(), nullptr, 10);
    pax.clear();
    if (type != '0' && type != '\0' && type != '2' && type != '5')
      return wrong("it contains something else than files, folders and links: " + entry.name);
    entry.kind = type == '\0' ? TarEntry::Kind::file : static_cast<TarEntry::Kind>(type);
    while (entry.name.ends_with('/')) entry.name.pop_back();
    if (auto done = reads.begin(entry); !done) return done;
    part.resize(std::min<std::uint64_t>(entry.size, most_part));
    for (std::uint64_t left = entry.size; left > 0;) {
      const std::size_t now = std::min<std::uint64_t>(left, part.size());
      if (!in.read(part.data(), static_cast<std::streamsize>(now))) return cut();
      if (auto done = reads.take(std::string_view(part).substr(0, now)); !done) return done;
      left -= now;
    }
    if (!skip(padding_of(entry.size))) return cut();
  }
}

}  // namespace nonio::storage
