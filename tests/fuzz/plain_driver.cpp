// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without libFuzzer: every file of a corpus as it is, then mutations of them
// from a seed. Usage: fuzz_NAME CORPUS [MUTATIONS [SEED]]
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" [[gnu::weak]] int LLVMFuzzerInitialize(int* count, char*** arguments);

namespace {

using Random = std::mt19937_64;

/// A copy of exactly its size, so that memory checkers see a read behind its end.
void run(const std::string& text) {
  const auto copy = std::make_unique<std::uint8_t[]>(text.size());
  std::memcpy(copy.get(), text.data(), text.size());
  LLVMFuzzerTestOneInput(copy.get(), text.size());
}

std::size_t place(const std::string& text, Random& random) { return random() % (text.size() + 1); }

void mutate(std::string& text, const std::vector<std::string>& corpus, Random& random) {
  static const std::string alphabet =
      "0123456789+-.,;\t\"#\r\n eEnaif/\\x\x80\xFF_" + std::string(1, '\0');
  const std::size_t at = place(text, random);
  const std::size_t length = std::min<std::size_t>(random() % 12, text.size() - at);
  const char c =
      random() % 8 == 0 ? static_cast<char>(random()) : alphabet[random() % alphabet.size()];
  switch (random() % 6) {
    case 0:
      text.insert(at, 1, c);
      break;
    case 1:
      if (at < text.size()) text[at] = c;
      break;
    case 2:
      text.erase(at, length);
      break;
    case 3:
      text.insert(place(text, random), text.substr(at, length));
      break;
    case 4: {
      const std::string& other = corpus[random() % corpus.size()];
      const std::size_t from = place(other, random);
      text.insert(at, other.substr(from, random() % 40));
      break;
    }
    default:
      text.resize(at);
  }
}

std::vector<std::string> read_corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file()) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());  // the same order everywhere
  std::vector<std::string> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

std::uint64_t number(const char* text) {
  std::uint64_t value = 0;
  std::from_chars(text, text + std::strlen(text), value);
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: " << argv[0] << " CORPUS [MUTATIONS [SEED]]\n";
    return 2;
  }
  if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
  const std::vector<std::string> corpus = read_corpus(argv[1]);
  if (corpus.empty()) {
    std::cerr << "no files in " << argv[1] << "\n";
    return 2;
  }
  for (const std::string& text : corpus) run(text);
  const std::uint64_t mutations = argc > 2 ? number(argv[2]) : 0;
  const std::uint64_t seed = argc > 3 ? number(argv[3]) : 1;
  std::cout << corpus.size() << " files, " << mutations << " mutations, seed " << seed << std::endl;
  Random random(seed);
  for (std::uint64_t i = 0; i < mutations; ++i) {
    std::string text = corpus[random() % corpus.size()];
    for (std::uint64_t k = 1 + random() % 6; k > 0; --k) mutate(text, corpus, random);
    run(text);
  }
  return 0;
}
