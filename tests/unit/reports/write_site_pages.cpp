// SPDX-License-Identifier: Apache-2.0
//
// write_site_pages FOLDER: pages of a made laboratory in each language, for tests with a browser.
#include <iostream>

#include "fixtures.h"
#include "site_fixture.h"

int main(int argc, char** argv) {
  using namespace nonio;
  if (argc != 2) return std::cerr << "usage: write_site_pages FOLDER\n", 2;
  const Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
  for (const char* language : {"en", "it", "de"}) {
    const auto pages = reports::site_pages(fixtures::made_site(), templates, language);
    if (!pages) return std::cerr << pages.error().message << '\n', 1;
    for (const Artifact& a : *pages) {
      const auto path = std::filesystem::path(argv[1]) / language / a.name;
      std::filesystem::create_directories(path.parent_path());
      std::ofstream(path, std::ios::binary) << a.bytes;
    }
  }
}
