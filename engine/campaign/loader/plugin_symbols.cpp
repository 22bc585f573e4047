// SPDX-License-Identifier: Apache-2.0
#include "campaign/loader/plugin_symbols.h"

#include <elf.h>

#include <boost/core/demangle.hpp>
#include <cstring>

#include "platform/storage/files.h"

namespace nonio::loader {

namespace {

/// Returns no entries if the table would exceed the end of the ELF file.
template <class Entry>
std::vector<Entry> entries(std::string_view bytes, std::uint64_t at, std::uint64_t n) {
  if (at > bytes.size() || n > (bytes.size() - at) / sizeof(Entry)) return {};
  std::vector<Entry> out(n);
  if (n != 0) std::memcpy(out.data(), bytes.data() + at, n * sizeof(Entry));
  return out;
}

bool of_standard_library(const std::string& mangled) {
  const std::string name = boost::core::demangle(mangled.c_str());
  return name.find("std::") != name.npos || name.find("__gnu_cxx::") != name.npos;
}

std::string text_at(std::string_view bytes, std::uint64_t at) {
  return at < bytes.size()
             ? std::string(bytes.data() + at, ::strnlen(bytes.data() + at, bytes.size() - at))
             : std::string();
}

}  // namespace

// boost::dll::library_info reads a table that `strip` removes, and includes weak symbols.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library) {
  NONIO_TRY(const auto file, storage::MappedFile::open(library));
  const std::string_view bytes = file.bytes();
  const auto head = entries<Elf64_Ehdr>(bytes, 0, 1);
  if (head.empty() || std::memcmp(head[0].e_ident, ELFMAG, SELFMAG) != 0 ||
      head[0].e_ident[EI_CLASS] != ELFCLASS64)
    return fail("is not an ELF library of 64 bits");
  const auto sections = entries<Elf64_Shdr>(bytes, head[0].e_shoff, head[0].e_shnum);
  std::vector<std::string> names;
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type != SHT_DYNSYM || section.sh_link >= sections.size()) continue;
    const std::uint64_t texts = sections[section.sh_link].sh_offset;
    for (const auto& symbol :
         entries<Elf64_Sym>(bytes, section.sh_offset, section.sh_size / sizeof(Elf64_Sym))) {
      const auto binding = ELF64_ST_BIND(symbol.st_info);
      const auto visible = ELF64_ST_VISIBILITY(symbol.st_other);
      if (symbol.st_shndx == SHN_UNDEF || binding == STB_LOCAL || visible == STV_HIDDEN) continue;
      const std::string name = text_at(bytes, texts + symbol.st_name);
      if (binding == STB_GLOBAL || !of_standard_library(name)) names.push_back(name);
    }
  }
  if (names.empty()) return fail("has no table of dynamic symbols");
  return names;
}

}  // namespace nonio::loader
